#pragma once
#include <cstddef>

#include "core/kinematics.hpp"
#include "core/time.hpp"

namespace peerd::replication {

// Position history after Singhal and Cheriton: velocity and acceleration at x0 of the parabola through three positions,
// x1 d1_s before it and x2 d1_s + d2_s before it (the seed's 4.3 to 4.5, mended: DESIGN, section 8). At a sharp turn,
// an angle of less than 90 degrees at x1, the two newest alone count and there is no acceleration.
struct PositionHistory {
  Vec3 velocity = Vec3::Zero(), acceleration = Vec3::Zero();
  bool sharp_turn = false;
};
[[nodiscard]] PositionHistory position_history(const Vec3& x0, const Vec3& x1, const Vec3& x2, double d1_s,
                                               double d2_s);

// The constant spin [rad/s, body frame] that turns one orientation into the other by the shorter way.
[[nodiscard]] Vec3 spin_between(const Quat& from, const Quat& to, double dt_s);

// Finds the derivatives of a source that knows poses alone: velocity and acceleration by position_history() of the last
// three, spin by the last two orientations (at most half a turn from one to the next).
class PoseHistory {
 public:
  // `t` is later than all before.
  [[nodiscard]] KinematicState derive(SimTime t, const Pose& pose);

 private:
  struct Seen {
    SimTime at;
    Pose pose;
  };
  Seen last_[2];  // the newer first
  std::size_t seen_ = 0;
};

}  // namespace peerd::replication
