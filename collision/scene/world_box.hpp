#pragma once
#include "core/box.hpp"

// Helpers for the boxes of scenes.
namespace peerd::collision {

// Whether two boxes overlap, or are no farther apart than `gap_m` along each axis.
[[nodiscard]] inline bool overlap(const WorldBox& a, const WorldBox& b, double gap_m = 0.0) {
  for (int i = 0; i < 3; ++i) {
    if (!(a.lo[i] - gap_m <= b.hi[i] && b.lo[i] - gap_m <= a.hi[i])) return false;
  }
  return true;
}

}  // namespace peerd::collision
