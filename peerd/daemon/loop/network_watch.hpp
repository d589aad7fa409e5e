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
    JoinService* join_service;     // null: there is none
    std::string provider;          // that gave the world by TCP, so that others are here; empty: nobody has
    replication::AuthorId author;  // of this peer's edits
    std::function<std::vector<PeerId>()> deaf_peers;  // as the seal finds them (Sealer::deaf_peers)
    // This peer's next life begins another log; called once, when the stamps of this one's are ahead of session time.
    std::function<void()> begin_log;
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
  OneWayLinks one_way_links_;
  SaidTroubles said_;
  std::vector<std::string> troubles_;
  bool has_begun_log_ = false;
  HostTime opened_at_, followed_at_;
};

}  // namespace peerd
