#pragma once
#include <algorithm>
#include <cassert>
#include <initializer_list>
#include <limits>
#include <utility>
#include <vector>

#include "core/geometry/mesh.hpp"

namespace peerd {

// Collects a mesh's vertices and polygons.
class PolygonWriter {
 public:
  PolygonWriter(std::uint64_t vertices, const MeshSize& size) {
    const std::uint64_t corners = size.triangles + 3 * size.polygons;  // each polygon of n: n - 2 triangles, n + 1 here
    assert(corners <= std::numeric_limits<std::int32_t>::max());       // and then the vertices are no more
    vertices_.reserve(vertices);
    corners_.reserve(corners);
  }

  // The nearest binary32 that is finite, and 0 for -0.
  void vertex(double x, double y, double z) { vertices_.emplace_back(to_float(x), to_float(y), to_float(z)); }
  [[nodiscard]] std::uint64_t vertex_count() const { return vertices_.size(); }

  void corner(std::uint64_t vertex) { corners_.push_back(static_cast<std::int32_t>(vertex)); }
  void close() { corners_.push_back(Mesh::kEndOfPolygon); }
  void polygon(std::initializer_list<std::uint64_t> corners) {
    for (const std::uint64_t v : corners) corner(v);
    close();
  }
  // The vertices first .. first + count - 1, as they are or, with the first corner kept, the other way around.
  void ring(std::uint64_t first, std::uint64_t count, bool reversed) {
    for (std::uint64_t i = 0; i < count; ++i) corner(first + (reversed && i > 0 ? count - i : i));
    close();
  }

  [[nodiscard]] Mesh finish(bool ccw = true) && { return make_mesh(std::move(vertices_), std::move(corners_), ccw); }

 private:
  static float to_float(double x) {
    constexpr double kMax = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(x, -kMax, kMax)) + 0.0F;
  }

  std::vector<Eigen::Vector3f> vertices_;
  std::vector<std::int32_t> corners_;
};

}  // namespace peerd
