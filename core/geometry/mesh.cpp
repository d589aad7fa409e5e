#include "core/geometry/mesh.hpp"

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

LocalBox box_of(const Mesh& mesh) {
  LocalBox box;
  float lo[3], hi[3];
  for (int k = 0; k < 3; ++k) {
    lo[k] = box.lo[k];
    hi[k] = box.hi[k];
  }
  for (const std::int32_t corner : mesh.corners) {
    if (corner == Mesh::kEndOfPolygon) continue;
    const float* const v = mesh.vertices[static_cast<std::size_t>(corner)].data();
    for (int k = 0; k < 3; ++k) {
      lo[k] = v[k] < lo[k] ? v[k] : lo[k];
      hi[k] = v[k] > hi[k] ? v[k] : hi[k];
    }
  }
  box.lo = {lo[0], lo[1], lo[2]};
  box.hi = {hi[0], hi[1], hi[2]};
  return box;
}

}  // namespace peerd
