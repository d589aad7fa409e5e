#pragma once
#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/physics/world/world_model.hpp"

namespace peerd::replication {

// A straight way in the world on which a viewer may draw a remote object, turned as its ghost is at t: all that the
// object carries goes with it, as the ghosts have it at t.
struct DrawnWay {
  ObjectId object;
  SimTime since, t;  // what the object may meet goes meanwhile from where it was drawn then to where it is
  Vec3 from, to;
};

// Whether nothing that the way moves meets what interests pair it with: part by part, by their types.
[[nodiscard]] bool is_free(const DrawnWay& way, const WorldModel& model, const OwnObjects& own, const Replica& replica);

}  // namespace peerd::replication
