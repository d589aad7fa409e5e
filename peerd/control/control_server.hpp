#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "peerd/control/event_kind.hpp"
#include "peerd/input/input_error.hpp"

namespace boost::asio {
class io_context;
}

namespace peerd::api {

// Serves a Unix stream socket that only this user may open: one line in, one line out, and events to clients that have
// subscribed. It runs in the io_context's one
// thread and never blocks it: a client that does not read its reply is dropped, and a client that sends too long a line
// gets an error and is dropped.
class ControlServer {
 public:
  static constexpr std::size_t kClientsMax = 16;
  static constexpr std::chrono::seconds kReplyWithin{2};  // the time for a client to read its reply
  // So many events wait for a client at most. Further ones are dropped, and a line says how many.
  static constexpr std::size_t kEventsMax = 1024, kEventsMax_bytes = std::size_t{1} << 20;

  // Converts one request to one reply, both without line ends; an empty reply is not sent. It must not destroy the
  // server.
  using Answer = std::function<std::string(std::string_view line)>;

  // Listens at `path`, whose folder must exist. A stale socket, on which no process listens, is replaced; anything else
  // at `path` is left alone and is an error. PATH.lock beside it is created and remains.
  [[nodiscard]] static Result<std::unique_ptr<ControlServer>> open(boost::asio::io_context& io,
                                                                   const std::filesystem::path& path, Answer answer);
  ~ControlServer();  // removes the socket

  // The client whose request is being answered gets events of these kinds from now on, and no others.
  void subscribe(EventKinds kinds);
  // The kinds that some client wants.
  [[nodiscard]] EventKinds wanted() const;
  // Gives an event, a line without its end, to all clients that want the kind. Never waits for one.
  void publish(EventKind kind, const std::string& line);

  struct Counters {
    std::uint64_t clients = 0, refused = 0, requests = 0, too_long = 0, too_slow = 0, events_dropped = 0;
  };
  [[nodiscard]] const Counters& counters() const;

 private:
  class Impl;
  explicit ControlServer(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace peerd::api
