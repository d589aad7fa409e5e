#include "core/mesh.hpp"

#include <utility>

namespace peerd {

Mesh make_mesh(SharedArray<Eigen::Vector3f> vertices, SharedArray<std::int32_t> corners, bool ccw) {
  Mesh mesh{std::move(vertices), std::move(corners), {}, ccw};
  const auto size = static_cast<std::uint32_t>(mesh.corners.size());
  bool inside = false;
  for (std::uint32_t i = 0; i < size; ++i) {
    const bool corner = mesh.corners[i] != Mesh::kEndOfPolygon;
    if (corner && !inside) mesh.polygon_begin.push_back(i);
    inside = corner;
  }
  if (!mesh.polygon_begin.empty()) mesh.polygon_begin.push_back(size);
  return mesh;
}

}  // namespace peerd
