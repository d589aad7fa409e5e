#pragma once
#include <array>
#include <cstdint>

#include "collision/query/wide_motion.hpp"

namespace peerd::collision {

// How material points move at an instant, relative to the trees' origins: base + turn x place, each in its tree's own
// frame [m/s, rad/s].
struct WideSpeeds {
  std::array<float, 3> linear_velocity_a, angular_velocity_a, linear_velocity_b, angular_velocity_b;
  float rate_a, rate_b;  // of turning, at least |turn| [rad/s]
  float slack_m_s;       // what the velocities of points may change by, on average, until the end, and all rounding
};

using MeetTimes =
    std::array<std::array<float, WideTree::kWidth>, WideTree::kWidth>;  // [s], by B's triangle, A's triangle

// Which children's boxes may meet within that time; which triangles may, and of those: not before which time.
void nodes_may_meet(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion,
                    const WideSpeeds& speeds, float within_s, Masks& masks);
void leaves_may_meet(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion,
                     const WideSpeeds& speeds, float within_s, Masks& masks, MeetTimes& times);

}  // namespace peerd::collision
