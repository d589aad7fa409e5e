#pragma once
#include "core/shape_polygon.hpp"
#include "replication/physics/world/flexible_parts.hpp"
#include "replication/physics/world/motion_world.hpp"

namespace peerd::replication {

// The pairs of polygons with which the two ends of a contact touch, all their moving and flexible parts included, at
// the contact time and where `contact` has its two ends before anything answered: for kAllPairs all pairs, for kWitness
// the least by Shapes' ids and polygons' numbers, for kBox none. `world` holds how the parts of an end stand in it.
//
// Pairs that touch exactly are named, as SceneQuery would name them where everything stands so. A contact time is
// rounded down to a nanosecond, and most searches end within a tolerance of the contact, so that often no two polygons
// touch yet. Then the nearest are named, and those that are no more than kAdvancementTolerance_m farther apart: of a
// Sphere, which meets others as the sphere it is, the polygons nearest to the contact. None are named where all are
// farther apart than contact times leave them, or where it is not known any more how a part stood.
//
// `flexible`: null where the model has no flexible parts.
[[nodiscard]] TouchedPolygons touched_polygons(const WorldModel& model, const MotionWorld& world,
                                               FlexibleParts* flexible, const ContactEvent& contact);

}  // namespace peerd::replication
