#pragma once
#include <span>

#include "core/math.hpp"

namespace peerd::collision {

struct EnclosingBall {
  Vec3 center = Vec3::Zero();
  double radius_m = 0.0;  // the distance of the farthest point
};

// The smallest ball that holds the points, but for rounding (Welzl, "Smallest enclosing disks (balls and ellipsoids)",
// LNCS 555, 1991, with his move to the front). At least one point. Time is linear in practice.
[[nodiscard]] EnclosingBall smallest_ball(std::span<const Vec3> points);

[[nodiscard]] double volume(const EnclosingBall& ball);  // [m^3]

}  // namespace peerd::collision
