#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <ostream>
#include <set>
#include <utility>
#include <vector>

#include "core/geometry/tessellate.hpp"
#include "core/math.hpp"

namespace peerd {

using Polygons = std::vector<std::vector<std::int32_t>>;
using Points = std::vector<std::array<float, 3>>;

inline Polygons polygons_of(const Mesh& mesh) {
  Polygons polygons;
  for (std::size_t i = 0; i < mesh.polygon_count(); ++i) {
    polygons.emplace_back(mesh.polygon(i).begin(), mesh.polygon(i).end());
  }
  return polygons;
}

inline Points points_of(const Mesh& mesh) {
  Points points;
  for (const Eigen::Vector3f& v : mesh.vertices) points.push_back({v.x(), v.y(), v.z()});
  return points;
}

// The mesh has each directed edge once, and also its reverse: a closed surface of one orientation.
inline bool is_closed(const Mesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& polygon : polygons_of(mesh)) {
    for (std::size_t i = 0; i < polygon.size(); ++i) ++edges[{polygon[i], polygon[(i + 1) % polygon.size()]}];
  }
  return !edges.empty() && std::ranges::all_of(edges, [&](const auto& edge) {
    const auto reverse = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && reverse != edges.end();
  });
}

inline bool uses_all_vertices(const Mesh& mesh) {
  std::set<std::int32_t> used;
  for (const auto& polygon : polygons_of(mesh)) used.insert(polygon.begin(), polygon.end());
  return used.size() == mesh.vertices.size();
}

// Positive if a closed surface's polygons run counter-clockwise seen from outside.
inline double signed_volume(const Mesh& mesh) {
  double six_volumes = 0.0;
  for (const auto& polygon : polygons_of(mesh)) {
    const auto at = [&](std::size_t i) {
      return Vec3(mesh.vertices[static_cast<std::size_t>(polygon[i])].cast<double>());
    };
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) six_volumes += at(0).dot(at(i).cross(at(i + 1)));
  }
  return six_volumes / 6.0;
}

// Counts the mesh that build_mesh() gave, as mesh_size() should have.
inline MeshSize counted(const Mesh& mesh) {
  MeshSize size;
  for (const auto& polygon : polygons_of(mesh)) {
    ++size.polygons;
    size.triangles += polygon.size() < 3 ? 1 : polygon.size() - 2;
  }
  return size;
}
inline bool operator==(const MeshSize& a, const MeshSize& b) {
  return a.polygons == b.polygons && a.triangles == b.triangles;
}
inline std::ostream& operator<<(std::ostream& out, const MeshSize& size) {
  return out << size.polygons << " polygons, " << size.triangles << " triangles";
}

}  // namespace peerd
