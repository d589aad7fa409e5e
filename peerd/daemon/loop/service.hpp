#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "peerd/net/os/service_manager.hpp"
#include "peerd/peer/node/log_line.hpp"

namespace peerd {

// Keeps the service manager informed about a peer: that it has begun, that it is alive, what it does, that it leaves.
// It runs in the peer's own loop, once a second or as often as the manager wants.
class Service {
 public:
  struct Peer {
    std::function<std::string()> status;   // one line for people
    std::function<std::uint64_t()> ticks;  // a number that grows while the peer does its work
    std::function<void()> every_second{};  // other work of that period; empty: none
  };

  // `io` outlives it.
  Service(boost::asio::io_context& io, net::ServiceManager manager, Peer peer, std::function<void(const LogLine&)> log);

  [[nodiscard]] const net::ServiceManager& manager() const { return manager_; }
  void begin();
  void leave();
  // Runs `work` while the manager knows that the configuration is read again.
  void reload(const std::function<void()>& work);

 private:
  void wake();
  // The error is logged once.
  void check(const Result<void>& done);

  boost::asio::steady_timer timer_;
  net::ServiceManager manager_;
  Peer peer_;
  std::function<void(const LogLine&)> log_;
  boost::asio::steady_timer::duration period_;
  std::uint64_t ticks_ = 0;  // when it said last that the peer is alive
  std::string status_;       // that the manager knows
  bool has_failed_ = false;
};

}  // namespace peerd
