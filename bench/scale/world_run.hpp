#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "bench/scale/moving_bodies.hpp"
#include "core/time.hpp"

// This header holds the ways to find the contacts of moving bodies, 60 times a second, which the benchmark compares.
namespace peerd::bench {

enum class Method : std::uint8_t {
  kMotionWorld,  // what peers have: pairs wait until they need a check
  kBroadPhase,   // boxes of each tick's way, collision's broad phase, searches of what it finds
  kBoxes,        // the same boxes, all pairs of them compared in each tick
  kSearches,     // no boxes: each tick searches all pairs
};
[[nodiscard]] const char* name_of(Method method);

// A contact of a pair of the model, when it begins.
struct FoundContact {
  std::uint32_t pair = 0;
  SimTime at;
};

struct WorldCost {
  double updates_s = 0.0, ticks_s = 0.0;  // of the thread's time, in all
  double simulated_s = 0.0;
  std::vector<double> shares;                           // of a core, second by second
  std::uint64_t updates = 0, checks = 0, searches = 0;  // checks: comparisons of two bounds
  std::vector<FoundContact> contacts;                   // by pair and time
};

// Runs all bodies from time 0 for `warm`, and measures what follows until `until`. A leg is known at the first tick
// after it begins, as from an update.
[[nodiscard]] WorldCost run_world(const MovingBodies& bodies, Method method, Duration warm, Duration until);

// Contacts that only one of the two has found: of the same pair, no farther apart than a millisecond. Left out are
// those before which the two have parted for less than kTouchCheck, which nobody promises to see.
[[nodiscard]] std::vector<std::string> differences(const MovingBodies& bodies, const std::vector<FoundContact>& a,
                                                   const std::vector<FoundContact>& b);

}  // namespace peerd::bench
