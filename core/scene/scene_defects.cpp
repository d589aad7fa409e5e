#include "core/scene/scene_defects.hpp"
#include "core/geometry/tessellate.hpp"

#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace peerd {
namespace {

using Key = std::vector<float>;

Key key_of(const BoxGeometry& box) { return {box.size[0], box.size[1], box.size[2]}; }
Key key_of(const SphereGeometry& sphere) { return {sphere.radius}; }
Key key_of(const ConeGeometry& cone) {
  return {cone.bottom_radius, cone.height, cone.side ? 1.0F : 0.0F, cone.bottom ? 1.0F : 0.0F};
}
Key key_of(const CylinderGeometry& cylinder) {
  return {cylinder.radius, cylinder.height, cylinder.side ? 1.0F : 0.0F, cylinder.top ? 1.0F : 0.0F,
          cylinder.bottom ? 1.0F : 0.0F};
}
Key key_of(const auto&) { return {}; }  // lists of any length: equal ones are rarely written twice

// A few bytes of text ask for hundreds of polygons, and worlds repeat them.
class RepeatedGeometryCache {
 public:
  // Returns the defects of an equal geometry, or none yet, to be filled in. Null where the search is not worth it.
  [[nodiscard]] std::optional<MeshDefects>* find(const Geometry& geometry) {
    Key key = std::visit([](const auto& g) { return key_of(g); }, geometry);
    if (key.empty()) return nullptr;
    key.push_back(static_cast<float>(geometry.index()));
    return &seen_[std::move(key)];
  }

 private:
  std::map<Key, std::optional<MeshDefects>> seen_;
};

}  // namespace

SceneDefects defects_of(const Scene& scene) {
  std::vector<std::optional<ObjectId>> first_shape(scene.geometries.size());
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const std::uint32_t geometry = scene.instances[i].geometry;
    if (geometry != Instance::kNone && !first_shape[geometry]) first_shape[geometry] = scene.id_of(i);
  }

  SceneDefects all;
  MeshDefectFinder finder;
  RepeatedGeometryCache seen_before;
  for (std::size_t g = 0; g < scene.geometries.size(); ++g) {
    std::optional<MeshDefects>* const known = seen_before.find(scene.geometries[g]);
    const MeshDefects found =
        known != nullptr && *known ? **known : finder.find(build_mesh(scene.geometries[g], scene.tessellation));
    if (known != nullptr) *known = found;
    for (std::size_t d = 0; d < kDefects; ++d) {
      if (all.counts[d].polygons == 0) {
        all.counts[d].shape = first_shape[g];
        all.counts[d].polygon = found.counts[d].first;
      }
      all.counts[d].polygons += found.counts[d].polygons;
    }
    all.boundary_edges += found.boundary_edges;
    all.non_manifold_edges += found.non_manifold_edges;
    all.same_direction_edges += found.same_direction_edges;
    all.edges_without_length += found.edges_without_length;
  }
  return all;
}

}  // namespace peerd
