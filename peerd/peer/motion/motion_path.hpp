#pragma once
#include <vector>

#include "core/kinematics.hpp"

namespace peerd::motion {

// The interval that a generated path covers. It begins before 0, because the scenario is under way before its start.
struct PathTimes {
  double begin_s = 0.0, end_s = 0.0;
};

// An object's motion at one instant of a path; derivatives are right-hand ones. World frame, SI units.
struct Knot {
  double t_s = 0.0;
  KinematicState state;
};

// A motion through knots in order of time. Between two knots the position is the quintic that has both ends' positions,
// velocities and accelerations, so it is twice continuously differentiable, and the orientation is a cubic quaternion
// curve that has both ends' orientations and spins (Kim, Kim and Shin, "A general construction scheme for unit
// quaternion curves", SIGGRAPH 1995), so the spin is continuous. Two knots of one time make a corner. Before the first
// knot and from the last one on the object stands still.
class MotionPath {
 public:
  // There is at least one knot, and the object turns by less than half a turn from one to the next. With `loops` the
  // last knot is the first one again, and the path has neither beginning nor end.
  explicit MotionPath(std::vector<Knot> knots, bool loops = false);

  [[nodiscard]] Pose pose(double t_s) const { return sample(t_s).pose(); }
  // The state at a time, with right-hand derivatives.
  [[nodiscard]] KinematicState sample(double t_s) const;
  [[nodiscard]] const std::vector<Knot>& knots() const { return knots_; }

 private:
  std::vector<Knot> knots_;
  bool loops_;
};

// The rotation from `a` to `b`, the shorter way round, as a rotation vector in their bodies' frame [rad].
[[nodiscard]] Vec3 turn_between(const Quat& a, const Quat& b);

// Turns the object so that its -z is turned by `yaw` about the world's y and then up by `pitch`, with these rates.
void face(KinematicState& state, double yaw, double pitch, double yaw_rate, double pitch_rate);
// Turns the object so that it looks along its velocity, level or not. An object at rest keeps the direction of
// `before`.
void face_forward(KinematicState& state, bool level, const KinematicState& before);

}  // namespace peerd::motion
