#pragma once
#include <cstddef>
#include <map>
#include <vector>

#include "peerd/node/peer_node.hpp"

namespace peerd::sim {

// Sees the session time of all peers at one true instant, which none of them can: how far each is from the one that it
// follows, and whether it says so.
class ClockOracle {
 public:
  struct WatchedPeer {
    const PeerNode* node;
    Duration clock_offset;
  };
  explicit ClockOracle(std::vector<WatchedPeer> peers) : peers_(std::move(peers)), seen_(peers_.size()) {}

  // After each tick of that peer. `now` is true time, which all hosts' clocks differ from by their offset.
  void take_sample(HostTime now, std::size_t peer);
  // Of the peer; none: it led all the time.
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
