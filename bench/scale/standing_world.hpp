#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

// This header holds a peer in a world of which nearly all stands, as the benchmark of growth measures it.
namespace peerd::bench {

enum class Named : std::uint8_t {
  kFew,  // each of the bodies that move has an interest in ten nodes that stand
  kAll,  // one body that moves has an interest in each node that stands
};

struct StandingCost {
  double read_s = 0.0, model_s = 0.0, enter_s = 0.0;            // of the thread's time
  double memory_mb = 0.0;                                       // the most that the process had in memory at once
  double tick_s = 0.0;                                          // the median of all ticks
  std::uint64_t checks = 0, searches = 0, objects_checked = 0;  // of all ticks
};

// A peer drives 100 bodies, or none, among so many nodes, in a process of its own, for so many ticks. The bodies and
// the nodes within their reach are the same whatever the number of nodes. With `ticks` 0 the peer is only made.
[[nodiscard]] StandingCost measure_standing(std::size_t nodes, Named named, bool moves, std::size_t ticks);

}  // namespace peerd::bench
