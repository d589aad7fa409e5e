#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "peerd/input/input_error.hpp"

namespace boost::asio {
class io_context;
}

namespace peerd::api {

// A Unix stream socket that only this user may open: one line in, one line out. Runs in the io_context's one thread and
// never blocks it: a client that does not read its reply is dropped, one that sends too much is told so and dropped.
class ControlServer {
 public:
  static constexpr std::size_t kClientsMax = 16;
  static constexpr std::chrono::seconds kReplyWithin{2};  // a client must take its reply in

  // One request without its end to one reply without its end, empty for none. Must not destroy the server.
  using Answer = std::function<std::string(std::string_view line)>;

  // Listens at `path` from now on. A socket that nobody listens on any more is replaced; anything else that stands
  // there is left alone and is an error. The folder must exist. PATH.lock beside it is made and stays.
  [[nodiscard]] static Result<std::unique_ptr<ControlServer>> open(boost::asio::io_context& io,
                                                                           const std::filesystem::path& path,
                                                                           Answer answer);
  ~ControlServer();  // the socket is removed

  struct Counters {
    std::uint64_t clients = 0, refused = 0, requests = 0, too_long = 0, too_slow = 0;
  };
  [[nodiscard]] const Counters& counters() const;

 private:
  class Impl;
  explicit ControlServer(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace peerd::api
