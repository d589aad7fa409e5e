#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "peerd/input/input_error.hpp"
#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/control/event_kind.hpp"
#include "peerd/peer/control/event_sink.hpp"

namespace boost::asio {
class io_context;
}

namespace peerd::control {

// Serves a Unix stream socket that only this user may open, whatever becomes of its file: one line in, one line out,
// and events to clients that have subscribed. It runs in the io_context's one thread and never blocks it: a client that
// does not read its reply is dropped, and a client that sends too long a line gets an error and is dropped.
class ControlServer : public EventSink {
 public:
  static constexpr std::size_t kClientsMax = 16;
  static constexpr std::chrono::seconds kReplyWithin{2};  // the time for a client to read its reply

  // Answers one request, without its line end; an empty reply is not sent. It must not destroy the server.
  using Answerer = std::function<Answer(std::string_view line)>;

  // Listens at `path`, whose folder must exist. A stale socket, on which no process listens, is replaced; anything else
  // at `path` is left alone and is an error. PATH.lock beside it is created and remains.
  [[nodiscard]] static Result<std::unique_ptr<ControlServer>> open(boost::asio::io_context& io,
                                                                   const std::filesystem::path& path, Answerer answer);
  ~ControlServer() override;  // removes the socket

  [[nodiscard]] EventKinds wanted() const override;
  void publish(EventKind kind, const std::string& line) override;

  struct Counters {
    std::uint64_t clients = 0, strangers = 0, refused = 0, requests = 0, too_long = 0, too_slow = 0, events_dropped = 0;
  };
  [[nodiscard]] const Counters& counters() const;

 private:
  class Impl;
  explicit ControlServer(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace peerd::control
