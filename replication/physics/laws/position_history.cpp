#include "replication/physics/laws/position_history.hpp"

#include <algorithm>
#include <cassert>

#include "core/atan2.hpp"

namespace peerd::replication {

PositionHistory position_history(const Vec3& x0, const Vec3& x1, const Vec3& x2, double d1_s, double d2_s) {
  assert(d1_s > 0.0 && d2_s > 0.0);
  PositionHistory h;
  if ((x0 - x1).dot(x1 - x2) < 0.0) {
    h.sharp_turn = true;
    h.velocity = (x0 - x1) / d1_s;
    return h;
  }
  const double sum = d1_s + d2_s;
  const Vec3 back1 = x1 - x0, back2 = x2 - x0;  // the factors of x0, x1 and x2 add up to zero
  h.velocity = d1_s / (sum * d2_s) * back2 - (1.0 / d1_s + 1.0 / d2_s) * back1;
  h.acceleration = 2.0 / (sum * d2_s) * back2 - 2.0 / (d1_s * d2_s) * back1;
  return h;
}

Vec3 spin_between(const Quat& from, const Quat& to, double dt_s) {
  assert(dt_s > 0.0);
  const Quat d = from.conjugate() * to;
  const double sign = d.w() < 0.0 ? -1.0 : 1.0, s = d.vec().norm();
  const double angle_over_s = s < 1e-9 ? 2.0 : 2.0 * peerd::atan2(s, sign * d.w()) / s;
  return (sign * angle_over_s / dt_s) * d.vec();
}

KinematicState PoseHistory::derive(SimTime t, const Pose& pose) {
  KinematicState state = at_rest(pose);
  if (seen_ > 0) {
    const double d1 = to_seconds(t - last_[0].at);
    assert(d1 > 0.0);
    state.angular_velocity_body = spin_between(last_[0].pose.orientation, pose.orientation, d1);
    state.velocity = (pose.position - last_[0].pose.position) / d1;
  }
  if (seen_ > 1) {
    const PositionHistory h = position_history(pose.position, last_[0].pose.position, last_[1].pose.position,
                                               to_seconds(t - last_[0].at), to_seconds(last_[0].at - last_[1].at));
    state.velocity = h.velocity;
    state.acceleration = h.acceleration;
  }
  last_[1] = last_[0];
  last_[0] = {t, pose};
  seen_ = std::min<std::size_t>(seen_ + 1, 2);
  return state;
}

}  // namespace peerd::replication
