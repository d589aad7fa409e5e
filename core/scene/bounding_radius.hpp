#pragma once
#include "core/scene/scene.hpp"

namespace peerd {

// Returns the distance [m] of the farthest vertex of all Shapes at and below `object` from the origin of the object, in
// its rigid frame; 0 where there are none. It builds each mesh once and keeps none.
[[nodiscard]] double bounding_radius_m(const Scene& scene, ObjectId object);

}  // namespace peerd
