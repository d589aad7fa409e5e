#pragma once
#include <functional>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "peerd/daemon/loop/join_service.hpp"
#include "peerd/daemon/loop/troubles.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/transport/transport.hpp"
#include "peerd/peer/node/describe.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd {

// Watches the network of a peer, beside its daemon and in the same loop: says what keeps the peer from the others, and
// has its JoinService follow where addresses and interfaces change.
class NetworkWatch {
 public:
  struct Parts {
    const net::HostClock& clock;
    const PeerNode& node;
    const net::Transport& transport;
    JoinService* join_service;  // null: there is none
    std::string provider;       // that gave the world by TCP, so that others are here; empty: nobody has
    std::function<void(const LogLine&)> log;
  };
  // Watches from now on. The objects that `parts` refers to outlive it.
  NetworkWatch(boost::asio::io_context& io, Parts parts);

  // The reasons, in words, why others are out of reach now.
  [[nodiscard]] const std::vector<std::string>& troubles() const { return troubles_; }

 private:
  void look();
  void find_troubles(HostTime now);

  Parts parts_;
  boost::asio::steady_timer timer_;
  SaidTroubles said_;
  std::vector<std::string> troubles_;
  HostTime opened_at_, followed_at_;
};

}  // namespace peerd
