#pragma once
#include <vector>

#include "core/kinematics.hpp"

namespace peerd::config {

// What a generated path has to cover: the scenario is under way before its start.
struct PathTimes {
  double begin_s = 0.0, end_s = 0.0;
};

// An object's motion at one instant of a path, as what follows has it. World frame, SI units.
struct Knot {
  double t_s = 0.0;
  KinematicState state;
};

// A motion through knots in order of time. Between two knots the position is the quintic that has both ends' positions,
// velocities and accelerations, so it is twice continuously differentiable, and the orientation a cubic quaternion
// curve that has both ends' orientations and spins (Kim, Kim and Shin, "A general construction scheme for unit
// quaternion curves", SIGGRAPH 1995), so the spin is continuous. Two knots of one time make a corner. Before the first
// and from the last on it stands there.
class MotionPath {
 public:
  // At least one knot; the object turns by less than half a turn from one to the next. With `loops` the last knot is
  // the first one again, and the path has neither beginning nor end.
  explicit MotionPath(std::vector<Knot> knots, bool loops = false);

  [[nodiscard]] Pose pose(double t_s) const { return sample(t_s).pose(); }
  // With right-hand derivatives.
  [[nodiscard]] KinematicState sample(double t_s) const;
  [[nodiscard]] const std::vector<Knot>& knots() const { return knots_; }

 private:
  std::vector<Knot> knots_;
  bool loops_;
};

// The turn from `a` to `b`, the shorter way round, as a rotation vector in their bodies' frame [rad].
[[nodiscard]] Vec3 turn_between(const Quat& a, const Quat& b);

// Looks along its -z, turned by `yaw` about the world's y and then up by `pitch`, and turns on at those rates.
void face(KinematicState& state, double yaw, double pitch, double yaw_rate, double pitch_rate);
// Looks along its velocity, level or not. One that stands still looks where `before` did.
void face_forward(KinematicState& state, bool level, const KinematicState& before);

}  // namespace peerd::config
