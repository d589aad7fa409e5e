#pragma once
#include <cstddef>

#include "core/kinematics.hpp"
#include "core/time.hpp"

namespace peerd::replication {

// Position history after Singhal and Cheriton: velocity and acceleration at x0 of the parabola through three
// positions, of which x1 lies d1_s before x0 and x2 lies d1_s + d2_s before it (Ohlenburg 2003, equations 4.3 to 4.5,
// corrected). At a sharp turn, an angle of less than 90 degrees at x1, only the two newest positions count and there
// is no acceleration.
struct PositionHistory {
  Vec3 velocity = Vec3::Zero(), acceleration = Vec3::Zero();
  bool sharp_turn = false;
};
[[nodiscard]] PositionHistory position_history(const Vec3& x0, const Vec3& x1, const Vec3& x2, double d1_s,
                                               double d2_s);

// The constant spin [rad/s, body frame] that turns one orientation into the other by the shorter way.
[[nodiscard]] Vec3 spin_between(const Quat& from, const Quat& to, double dt_s);

// Finds the derivatives of a source that knows poses alone. Velocity and acceleration are those of position_history()
// of the last three poses; the spin follows from the last two orientations, at most half a turn apart.
class PoseHistory {
 public:
  // `t` is later than that of every call before.
  [[nodiscard]] KinematicState derive(SimTime t, const Pose& pose);

 private:
  struct Seen {
    SimTime at;
    Pose pose;
  };
  Seen last_[2];  // the newer pose comes first
  std::size_t seen_ = 0;
};

}  // namespace peerd::replication
