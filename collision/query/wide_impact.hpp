#pragma once
#include <array>
#include <cstdint>

#include "collision/query/wide_motion.hpp"

namespace peerd::collision {

// The velocities of material points at an instant, relative to the trees' origins: linear + angular x place, each in
// its tree's own frame [m/s, rad/s].
struct WideSpeeds {
  std::array<float, 3> linear_velocity_a, angular_velocity_a, linear_velocity_b, angular_velocity_b;
  float rate_a, rate_b;  // at least the lengths of the angular velocities [rad/s]
  float slack_m_s;       // a bound of the mean change of points' velocities until the end, and of all rounding
};

using MeetTimes =
    std::array<std::array<float, WideTree::kWidth>, WideTree::kWidth>;  // [s], by B's triangle, A's triangle

// Finds which children's boxes may meet within that time [s]; and which triangles may, and a time before which each
// pair of those certainly doesn't.
void nodes_may_meet(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion,
                    const WideSpeeds& speeds, float within_s, Masks& masks);
void leaves_may_meet(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion,
                     const WideSpeeds& speeds, float within_s, Masks& masks, MeetTimes& times);

}  // namespace peerd::collision
