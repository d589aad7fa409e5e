#pragma once
#include <cstdint>

#include "core/box.hpp"
#include "replication/physics/world/flexible_parts.hpp"
#include "replication/physics/world/motion_world.hpp"

namespace peerd::replication {

// A part of an end of an interest as it stands in the world at an instant: for all that must know how near what moves
// with an object comes to something, and not only the object's own body.
struct PartAt {
  KinematicState state;                   // of the part's frame: a node, or the world
  const collision::Body* body = nullptr;  // none: it is flexible
  Vec3 center = Vec3::Zero();             // of a sphere around it, in its frame [m]
  double radius_m = 0.0;                  // of that sphere; of a flexible part, for as long as was asked
  double extent_m = 0.0;                  // no point of it is farther from the frame's origin, for as long

  [[nodiscard]] Vec3 center_world() const {  // most bodies are centred, and need no turning
    return center.isZero(0.0) ? state.position : Vec3(state.position + state.orientation * center);
  }
  // A box around the sphere, in the world.
  [[nodiscard]] WorldBox box() const {
    const Vec3 at = center_world();
    return {at.array() - radius_m, at.array() + radius_m};
  }
};

// Returns the model's part at t, by that world. A flexible part keeps within its sphere from t on for h_s. `flexible`:
// null where the model has no flexible parts.
[[nodiscard]] PartAt part_at(const WorldModel& model, const MotionWorld& world, FlexibleParts* flexible,
                             std::uint32_t part, SimTime t, double h_s = 0.0);

}  // namespace peerd::replication
