#pragma once
#include <utility>
#include <vector>

#include "bench/polygon_file.hpp"
#include "core/geometry/mesh.hpp"
#include "core/math.hpp"

namespace peerd::bench {

// The mesh of a file, its vertices rounded to binary32.
inline Mesh mesh_of(const PolygonFile& file) {
  std::vector<Eigen::Vector3f> vertices;
  for (const auto& p : file.vertices) vertices.emplace_back(Vec3(p[0], p[1], p[2]).cast<float>());
  std::vector<std::int32_t> corners;
  for (const std::vector<int>& polygon : file.polygons) {
    corners.insert(corners.end(), polygon.begin(), polygon.end());
    corners.push_back(Mesh::kEndOfPolygon);
  }
  return make_mesh(std::move(vertices), std::move(corners));
}

}  // namespace peerd::bench
