#include "core/scene/scene_statistics.hpp"

#include <algorithm>
#include <vector>

#include "core/geometry/tessellate.hpp"
#include "core/scene/interest_pairs.hpp"
#include "core/vrml/document.hpp"

namespace peerd {

SceneStatistics statistics_of(const Scene& scene) {
  SceneStatistics s;
  if (scene.document != nullptr) {
    s.nodes = scene.document->nodes.size();
    s.routes = scene.document->routes.size();
  }
  s.instances = scene.instances.size();
  s.geometries = scene.geometries.size();
  std::vector<MeshSize> sizes;
  sizes.reserve(scene.geometries.size());
  for (const Geometry& geometry : scene.geometries) {
    sizes.push_back(mesh_size(geometry, scene.tessellation));
    s.polygons += sizes.back().polygons;
    s.triangles += sizes.back().triangles;
    if (std::holds_alternative<FaceSetGeometry>(geometry) || std::holds_alternative<ElevationGridGeometry>(geometry)) {
      s.faces += sizes.back().polygons;
      s.face_triangles += sizes.back().triangles;
    }
    if (std::holds_alternative<NoSurface>(geometry)) ++s.geometries_without_surface;
  }
  std::vector<std::uint32_t> depth(scene.instances.size());
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    depth[i] = instance.parent < 0 ? 1 : depth[static_cast<std::size_t>(instance.parent)] + 1;
    s.depth = std::max<std::size_t>(s.depth, depth[i]);
    ++(instance.kind == NodeKind::kShape ? s.shapes : s.groups);
    if (instance.kind == NodeKind::kShape && !instance.collides) ++s.shapes_not_colliding;
    if (instance.kind == NodeKind::kTransform &&
        !scene.object(scene.id_of(static_cast<std::uint32_t>(i))).velocity.isZero(0))
      ++s.moving_objects;
    if (instance.geometry == Instance::kNone) continue;
    s.polygons_instanced += sizes[instance.geometry].polygons;
    s.triangles_instanced += sizes[instance.geometry].triangles;
  }
  s.collision_interests = scene.interests.size();
  for (const CollisionInterest& interest : scene.interests) s.interests += InterestPairs(scene, interest).count();
  s.key_sensors = scene.key_sensors.size();
  s.pending_inlines = scene.pending_inlines.size();
  return s;
}

}  // namespace peerd
