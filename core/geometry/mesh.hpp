#pragma once
#include <Eigen/Core>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "core/box.hpp"
#include "core/shared_array.hpp"

namespace peerd {

// Polygons as they are written: not split, merged or cleaned, planar or not. Shape frame.
struct Mesh {
  SharedArray<Eigen::Vector3f> vertices;  // [m], binary32
  // Corners, indices into `vertices`; -1 closes a polygon, as in VRML97's coordIndex. The last -1 may be missing.
  SharedArray<std::int32_t> corners;
  std::vector<std::uint32_t> polygon_begin;  // polygons + 1 offsets into `corners`; see polygon()
  bool ccw = true;                           // corners run counter-clockwise seen from the front

  [[nodiscard]] std::size_t polygon_count() const { return polygon_begin.empty() ? 0 : polygon_begin.size() - 1; }
  // The corners of polygon i: at least one. Fewer than three bound no area, but they keep their number.
  [[nodiscard]] std::span<const std::int32_t> polygon(std::size_t i) const {
    assert(i < polygon_count());
    std::uint32_t end = polygon_begin[i + 1];
    while (corners[end - 1] == kEndOfPolygon) --end;
    return corners.span().subspan(polygon_begin[i], end - polygon_begin[i]);
  }

  static constexpr std::int32_t kEndOfPolygon = -1;
};

// The number of polygons of a mesh and of the triangles that they are cut into: n - 2 for a polygon of n corners, and
// at least 1.
struct MeshSize {
  std::uint64_t polygons = 0;
  std::uint64_t triangles = 0;
};
// A mesh of those corners; finds where its polygons begin. A -1 behind a -1 makes no polygon.
[[nodiscard]] Mesh make_mesh(SharedArray<Eigen::Vector3f> vertices, SharedArray<std::int32_t> corners, bool ccw = true);

// Returns the box of the vertices that polygons use.
[[nodiscard]] LocalBox box_of(const Mesh& mesh);

}  // namespace peerd
