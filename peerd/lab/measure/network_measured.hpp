#pragma once
#include <cstdint>
#include <vector>

#include "core/ids.hpp"

namespace peerd::measure {

// Measurements of a real network in one direction between two peers.
struct LinkMeasured {
  PeerId from, to;
  std::uint32_t probes_sent = 0, probes_lost = 0, probes_duplicated = 0;
  std::vector<double> delay_ms;    // one for each probe that arrived, in order of arrival
  std::uint64_t packets = 0;       // packets that netem let through while the peers ran
  std::uint64_t packets_lost = 0;  // packets that netem dropped while the peers ran
};

// Measurements of all links, and of how well the computer kept time: how much longer than asked for a timer took [ms].
struct NetworkMeasured {
  std::vector<LinkMeasured> links;
  std::vector<double> oversleep_before_ms, oversleep_during_ms;
};

// Whether the computer kept time well enough for the run to count: before it, 99 of 100 timers were at most 10 ms late,
// and while the peers ran at most 50 ms, which is three of their ticks. A run on a computer that stands still says more
// about the computer than about the network.
[[nodiscard]] bool kept_time(const NetworkMeasured& network);

}  // namespace peerd::measure
