#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "core/geometry/mesh_defects.hpp"
#include "core/scene/scene.hpp"

namespace peerd {

// SceneDefects are the defects of all geometries of a scene. A geometry is examined once however often it is used, and
// by itself: two Shapes may share edges and repeat each other's polygons.
struct SceneDefects {
  struct Count {
    std::uint64_t polygons = 0;
    std::optional<ObjectId> shape;  // the first that shows the first of them; none where no Shape has that geometry
    std::uint32_t polygon = 0;      // number in the mesh
  };
  std::array<Count, kDefects> counts;
  std::uint64_t boundary_edges = 0, non_manifold_edges = 0, same_direction_edges = 0, edges_without_length = 0;

  [[nodiscard]] const Count& operator[](Defect defect) const { return counts[static_cast<std::size_t>(defect)]; }
};

// Finds the defects, with one mesh in memory at a time.
[[nodiscard]] SceneDefects defects_of(const Scene& scene);

}  // namespace peerd
