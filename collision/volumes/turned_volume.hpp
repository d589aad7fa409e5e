#pragma once
#include <array>
#include <cstdint>
#include <numbers>
#include <span>

#include "collision/tree/kdop_volume.hpp"
#include "core/math.hpp"

namespace peerd::collision {

// The k-DOP around points that a rotation has turned.
template <int K>
[[nodiscard]] WideKdop<K> kdop_around(std::span<const Vec3> points, const Mat3& rotation = Mat3::Identity()) {
  auto out = WideKdop<K>::empty();
  for (const Vec3& p : points) {
    const Vec3 turned = rotation * p;
    for (std::size_t i = 0; i < out.kSlabs; ++i) {
      const double at = along(out.kDirections[i], turned);
      out.lo[i] = std::min(out.lo[i], at);
      out.hi[i] = std::max(out.hi[i], at);
    }
  }
  return out;
}

// The rotations of the thesis's section 3.1.1: a full turn of `steps` equal steps around x, y, z, xy, xz, yz and xyz,
// one after the other. It has 1,000 steps, 7,000 rotations.
inline constexpr std::array<std::array<int, 3>, 7> kTurnAxes = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}};

[[nodiscard]] inline Mat3 thesis_rotation(std::uint32_t i, std::uint32_t steps) {
  const auto& axis = kTurnAxes.at(i / steps);
  const double angle_rad = 2.0 * std::numbers::pi * (i % steps) / steps;
  return quat_exp(Vec3(angle_rad * Vec3(axis[0], axis[1], axis[2]).normalized())).toRotationMatrix();
}

}  // namespace peerd::collision
