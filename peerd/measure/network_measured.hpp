#pragma once
#include <cstdint>
#include <vector>

#include "core/ids.hpp"

namespace peerd::report {

// What a real network was found to do in one direction between two peers.
struct LinkMeasured {
  PeerId from, to;
  std::uint32_t probes_sent = 0, probes_lost = 0, probes_duplicated = 0;
  std::vector<double> delay_ms;    // of each probe that came, in order of arrival
  std::uint64_t packets = 0;       // that the network let through while the peers ran
  std::uint64_t packets_lost = 0;  // .. and that it took away
};

// .. and how well the computer kept time meanwhile: how much longer than it should a timer took to go off.
struct NetworkMeasured {
  std::vector<LinkMeasured> links;
  std::vector<double> oversleep_before_ms, oversleep_during_ms;
};

// Whether that is good enough for the run to count: before it, 99 of 100 timers were at most 10 ms late, and while the
// peers ran at most 50 ms, three of their ticks. What a run of a computer that stands still says is said of that
// computer.
[[nodiscard]] bool kept_time(const NetworkMeasured& network);

}  // namespace peerd::report
