#pragma once
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "core/kinematics.hpp"
#include "core/time.hpp"

namespace peerd::replication {

// The limits of any value from the network; receivers refuse other values.

// Farther or faster than this is not a world of metres and seconds but a damaged datagram; squares of it stay finite.
inline constexpr double kMagnitudeMax = 1e12;
// The fastest spin: 1,600 turns a second. Faster ones only make contact searches long, whose steps are as short as the
// spin is fast.
inline constexpr double kSpinMax = 1e4;  // [rad/s]
// A peer does not send a vector that is this far off unit length.
inline constexpr double kUnitSlack = 1e-6;
// A year on either side of any epoch a clock counts from would do; this keeps differences of two stamps within int64.
inline constexpr std::int64_t kTimeMax_ns = std::int64_t{1} << 62;
// An update from before the reach of timelines comes from a broken clock or a forger, as does one from so far ahead.
inline constexpr Duration kUpdateAgeMax = std::chrono::seconds(4), kUpdateAheadMax = std::chrono::seconds(1);

// Whether a value is within the limits; false for NaN and infinities.
inline bool acceptable(const Vec3& v) {
  return std::abs(v.x()) <= kMagnitudeMax && std::abs(v.y()) <= kMagnitudeMax && std::abs(v.z()) <= kMagnitudeMax;
}
inline bool acceptable(const Quat& q) { return std::abs(q.norm() - 1.0) <= kUnitSlack; }
inline bool acceptable(const KinematicState& s) {
  return acceptable(s.position) && acceptable(s.velocity) && acceptable(s.acceleration) && acceptable(s.orientation) &&
         acceptable(s.angular_velocity_body) && s.angular_velocity_body.norm() <= kSpinMax;
}
// The state that is sent in place of one that is not acceptable: at rest, at the nearest place that is acceptable. A
// coordinate that is not a number counts as 0, such an orientation as the identity.
inline KinematicState at_rest_within_limits(const KinematicState& s) {
  Pose inside;
  for (int axis = 0; axis < 3; ++axis) {
    const double p = s.position[axis];
    inside.position[axis] = std::isfinite(p) ? std::clamp(p, -kMagnitudeMax, kMagnitudeMax) : 0.0;
  }
  if (acceptable(s.orientation)) inside.orientation = s.orientation;
  const KinematicState out = at_rest(inside);
  assert(acceptable(out));
  return out;
}
inline bool in_range(std::int64_t ns) { return ns >= -kTimeMax_ns && ns <= kTimeMax_ns; }

}  // namespace peerd::replication
