#pragma once
#include "core/animation/value.hpp"
#include "core/math.hpp"

namespace peerd::animation {

// A Segment describes how a field moves from begin_s until end_s, in the frame that the field is in. For translation
// and rotation that is the frame of the parent. SFFloat and SFTime use the first component of `position` and
// `velocity`.
struct Segment {
  double begin_s = -kInfinity;          // [s]
  double end_s = kInfinity;             // [s], exclusive; +inf: it never changes again
  bool initial = true;                  // no event has come: the file's value holds, and what is below means nothing
  bool is_constant = true;              // nothing moves
  Vec3 position = Vec3::Zero();         // at begin_s
  Vec3 velocity = Vec3::Zero();         // [1/s]; a translation's [m/s]
  Quat orientation = Quat::Identity();  // at begin_s, unit
  Vec3 angular_velocity_body = Vec3::Zero();  // [rad/s] in the rotating frame, constant, as KinematicState has it

  // begin_s <= t <= end_s. Where begin_s is -inf (it is still) any t.
  [[nodiscard]] Vec3 position_at(double t) const;
  [[nodiscard]] Quat orientation_at(double t) const;  // orientation * exp(angular_velocity_body * (t - begin_s) / 2)
};

}  // namespace peerd::animation
