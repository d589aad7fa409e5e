#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "core/math.hpp"

namespace peerd::replication {

// An orientation as three whole numbers: of the unit quaternion's components (w, x, y, z) all but the largest, which is
// made positive and follows from the others. A step is 1 / (sqrt(2) kMost): no component but the largest can pass
// 1 / sqrt(2).
struct SmallestThree {
  static constexpr int kMagnitude_bits = 12;
  static constexpr std::int32_t kMost = (1 << kMagnitude_bits) - 1;

  int largest = 0;                      // which is left out
  std::array<std::int32_t, 3> steps{};  // of the others, in order; within +-kMost
  friend bool operator==(const SmallestThree&, const SmallestThree&) = default;
};

// The orientation that they stand for, unit within 1e-15: a product each, and a square root of a whole number, so that
// all peers have the same bits. None: the three are more than a unit.
[[nodiscard]] std::optional<Quat> to_orientation(const SmallestThree& three);

// The nearest; of what to_orientation() gave, those that give it again.
[[nodiscard]] SmallestThree smallest_three(const Quat& q);

}  // namespace peerd::replication
