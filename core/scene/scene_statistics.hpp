#pragma once
#include <cstddef>
#include <cstdint>

#include "core/scene/scene.hpp"

namespace peerd {

struct SceneStatistics {
  std::size_t nodes = 0;                       // in the document, of any type; PROTOs expanded
  std::size_t instances = 0;                   // a USE counts again
  std::size_t groups = 0;                      // instances that are no Shape
  std::size_t shapes = 0;                      // instances that are
  std::size_t shapes_not_colliding = 0;        // shapes whose Instance::collides is false
  std::size_t depth = 0;                       // depth of the deepest instance; 1 at the top level
  std::size_t geometries = 0;                  // stored once however often they are used
  std::size_t geometries_without_surface = 0;  // geometries that are lines, points, text
  std::uint64_t polygons = 0;                  // polygons of the geometries
  std::uint64_t triangles = 0;                 // triangles that the polygons are cut into
  std::uint64_t faces = 0;                     // those of `polygons` that files write, in face sets and elevation grids
  std::uint64_t face_triangles = 0;            // likewise
  std::uint64_t polygons_instanced = 0;        // polygons of the Shapes: a USE counts again
  std::uint64_t triangles_instanced = 0;       // likewise
  std::size_t collision_interests = 0;         // as the world's CollisionInterests register them, one a collider
  std::size_t interests = 0;                   // pairs of collider and collidee
  std::size_t key_sensors = 0;
  std::size_t routes = 0;
  std::size_t moving_objects = 0;  // instances of a velocityVector that isn't zero
  std::size_t pending_inlines = 0;
};

// Counts without building any mesh.
[[nodiscard]] SceneStatistics statistics_of(const Scene& scene);

}  // namespace peerd
