#pragma once
#include <cstddef>
#include <map>
#include <vector>

#include "peerd/peer/node/peer_node.hpp"

namespace peerd::sim {

// Sees the session time of all peers at one true instant, which no peer can. It measures how far each peer is from the
// one that it follows, and whether the bound that the peer publishes holds.
class ClockOracle {
 public:
  struct WatchedPeer {
    const PeerNode* node;
    Duration clock_offset;
  };
  explicit ClockOracle(std::vector<WatchedPeer> peers) : peers_(std::move(peers)), seen_(peers_.size()) {}

  // Takes a sample after each tick of that peer. `now` is true time, from which each host's clock differs by its
  // offset.
  void take_sample(HostTime now, std::size_t peer);
  // The errors of the peer; none where it has led all the time.
  [[nodiscard]] std::optional<PeerLog::ClockError> error_of(std::size_t peer) const;

 private:
  struct Seen {
    std::vector<Duration> errors, bounds;
    std::uint64_t beyond = 0;
  };
  std::vector<WatchedPeer> peers_;
  std::vector<Seen> seen_;
};

}  // namespace peerd::sim
