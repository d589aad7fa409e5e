#pragma once
#include "core/ids.hpp"
#include "core/kinematics.hpp"

namespace peerd::replication {

// Pose and derivatives of a driven object at a tick, from whatever moves it. At a corner, the derivatives are those of
// what follows.
struct OwnSample {
  ObjectId object;
  KinematicState state;
  // False: only the pose is known; the derivatives are found from the samples before (position_history.hpp).
  bool has_derivatives = true;
};

}  // namespace peerd::replication
