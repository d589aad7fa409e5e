#pragma once
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "peerd/net/transport/transport.hpp"

namespace peerd::nats {

// The words of the C library's threads about a connection. Any thread may call anything here.
class ConnectionState {
 public:
  // The connection is up or down; a sentence for the log, which is said once in a row.
  void on_up(const std::string& sentence);
  void on_down(const std::string& sentence);
  // The connection is at its end: the library does not try again by itself.
  void on_closed(const std::string& sentence);
  // Something for the log that does not change the connection.
  void warn(const std::string& sentence);
  // A new connection is going to be made.
  void begin();

  [[nodiscard]] bool is_up() const;
  [[nodiscard]] bool is_closed() const;
  // The oldest sentence that has not been taken. At most kSentencesMax wait; further ones are left out.
  [[nodiscard]] std::optional<net::InterfaceChange> take_change();

 private:
  static constexpr std::size_t kSentencesMax = 16;
  void say(bool is_back, const std::string& sentence);  // with mutex_ held

  mutable std::mutex mutex_;
  bool up_ = false, closed_ = false;
  std::optional<std::string> said_down_;  // the last sentence since it has been down; none: it is up
  std::deque<net::InterfaceChange> changes_;
};

}  // namespace peerd::nats
