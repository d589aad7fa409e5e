#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "core/math.hpp"

namespace peerd::replication {

// An orientation as three whole numbers: the components (w, x, y, z) of the unit quaternion without the largest, which
// is made positive and follows from the others. A step is 1 / (sqrt(2) kMost): no component but the largest can exceed
// 1 / sqrt(2).
struct SmallestThree {
  static constexpr int kMagnitude_bits = 12;
  static constexpr std::int32_t kMost = (1 << kMagnitude_bits) - 1;

  int largest = 0;                      // the index of the component that is left out
  std::array<std::int32_t, 3> steps{};  // the other components, in order, within +-kMost
  friend bool operator==(const SmallestThree&, const SmallestThree&) = default;
};

// The orientation that the numbers stand for, of unit length within 1e-15: one product for each, and the square root
// of a whole number, so that all peers have the same bits. None where the three are longer than a unit.
[[nodiscard]] std::optional<Quat> to_orientation(const SmallestThree& three);

// The nearest numbers; for an orientation that to_orientation() returned, numbers that give the same bits again.
[[nodiscard]] SmallestThree smallest_three(const Quat& q);

}  // namespace peerd::replication
