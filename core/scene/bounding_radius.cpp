#include "core/scene/bounding_radius.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/tessellate.hpp"

namespace peerd {

double bounding_radius_m(const Scene& scene, ObjectId object) {
  double farthest_m2 = 0.0;
  for (std::uint32_t i = scene.index_of(object); i < scene.at(object).subtree_end; ++i) {
    const ObjectId shape = scene.id_of(i);
    const Geometry* geometry = scene.geometry(shape);
    if (geometry == nullptr) continue;
    const Mesh mesh = build_mesh(*geometry, scene.tessellation);
    const Eigen::Affine3d object_from_shape = scene.object_from_shape(object, shape);
    for (const std::int32_t corner : mesh.corners.span()) {
      if (corner == Mesh::kEndOfPolygon) continue;
      const Eigen::Vector3f& v = mesh.vertices[static_cast<std::size_t>(corner)];
      farthest_m2 = std::max(farthest_m2, (object_from_shape * v.cast<double>()).squaredNorm());
    }
  }
  return std::sqrt(farthest_m2);
}

}  // namespace peerd
