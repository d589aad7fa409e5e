#include "core/kinematics.hpp"

#include "core/rotate_body.hpp"

namespace peerd {

KinematicState advance(const KinematicState& base, double dt_s) {
  KinematicState s = base;
  s.position = base.position + dt_s * (base.velocity + (0.5 * dt_s) * base.acceleration);
  s.velocity = base.velocity + dt_s * base.acceleration;
  if (!base.angular_velocity_body.isZero(0.0)) {
    s.orientation = rotated_in_body_frame(base.orientation, dt_s * base.angular_velocity_body);
  }
  return s;
}

KinematicState at_rest(const Pose& pose) {
  KinematicState s;
  s.position = pose.position;
  s.orientation = pose.orientation;
  return s;
}

}  // namespace peerd
