#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/kinematics.hpp"
#include "core/time.hpp"

namespace peerd::replication {

// What any value from the network must keep; receivers refuse the rest.

// Farther or faster than this is not a world of metres and seconds but a damaged datagram; squares of it stay finite.
inline constexpr double kMagnitudeMax = 1e12;
// 1,600 turns a second. Faster ones only make contact searches long: their steps are as short as the spin is fast.
inline constexpr double kSpinMax = 1e4;  // [rad/s]
// What is this far off unit length was not sent by us.
inline constexpr double kUnitSlack = 1e-6;
// A year on either side of any epoch a clock counts from would do; this keeps differences of two stamps within int64.
inline constexpr std::int64_t kTimeMax_ns = std::int64_t{1} << 62;
// An update of farther back than timelines reach comes from a broken clock or a forger, as does one from so far ahead.
inline constexpr Duration kUpdateAgeMax = std::chrono::seconds(4), kUpdateAheadMax = std::chrono::seconds(1);

// False for NaN and infinities too.
inline bool acceptable(const Vec3& v) {
  return std::abs(v.x()) <= kMagnitudeMax && std::abs(v.y()) <= kMagnitudeMax && std::abs(v.z()) <= kMagnitudeMax;
}
inline bool acceptable(const Quat& q) { return std::abs(q.norm() - 1.0) <= kUnitSlack; }
inline bool acceptable(const KinematicState& s) {
  return acceptable(s.position) && acceptable(s.velocity) && acceptable(s.acceleration) && acceptable(s.orientation) &&
         acceptable(s.angular_velocity_body) && s.angular_velocity_body.norm() <= kSpinMax;
}
// What may be said of a state that is not acceptable: it stands, at the nearest place that is. What is no number counts
// as 0, and as the identity.
inline KinematicState at_rest_within_limits(const KinematicState& s) {
  Pose inside;
  for (int axis = 0; axis < 3; ++axis) {
    const double p = s.position[axis];
    inside.position[axis] = std::isfinite(p) ? std::clamp(p, -kMagnitudeMax, kMagnitudeMax) : 0.0;
  }
  if (acceptable(s.orientation)) inside.orientation = s.orientation;
  return at_rest(inside);
}
inline bool in_range(std::int64_t ns) { return ns >= -kTimeMax_ns && ns <= kTimeMax_ns; }

}  // namespace peerd::replication
