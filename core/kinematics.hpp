#pragma once
#include "core/math.hpp"

namespace peerd {

// A KinematicState describes how a rigid body moves from one instant on, as far as dead reckoning models it: world
// frame, SI units. It takes 128 bytes, since the members that need 16-byte alignment come first.
struct KinematicState {
  Quat orientation = Quat::Identity();        // unit, body to world
  Vec3 position = Vec3::Zero();               // [m]
  Vec3 velocity = Vec3::Zero();               // [m/s]
  Vec3 acceleration = Vec3::Zero();           // [m/s^2]; zero in a first-order model
  Vec3 angular_velocity_body = Vec3::Zero();  // [rad/s], body frame, constant

  [[nodiscard]] Pose pose() const { return {position, orientation}; }
  // Whether all numbers are the same.
  friend bool operator==(const KinematicState& a, const KinematicState& b) {
    return a.orientation.coeffs() == b.orientation.coeffs() && a.position == b.position && a.velocity == b.velocity &&
           a.acceleration == b.acceleration && a.angular_velocity_body == b.angular_velocity_body;
  }
};

// Returns the state dt_s [s] later (or earlier): equations 4.1 and 4.2 of the thesis with q(t) = q0 * exp(w t). It is
// computed from the base state, never accumulated; the quaternion is normalised at each evaluation.
[[nodiscard]] KinematicState advance(const KinematicState& base, double dt_s);

// Returns a body at rest at that pose.
[[nodiscard]] KinematicState at_rest(const Pose& pose);

}  // namespace peerd
