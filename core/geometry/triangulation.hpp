#pragma once
#include <span>
#include <vector>

#include "core/geometry/ear_clipping.hpp"
#include "core/geometry/mesh.hpp"

namespace peerd {

// A Triangulator cuts a polygon into triangles, by a rule that every peer follows to the same triangles. Its decisions
// are exact.
// - 1 corner: (0, 0, 0). 2 corners: (0, 1, 1). These are points and segments, as triangles without an area.
// - 3 corners: (0, 1, 2).
// - More corners: n - 2 triangles. The polygon is projected along the axis of the largest component of its area vector
// (Newell; exact; of equal ones the lowest axis), so that it runs counter-clockwise as a whole.
//   - Convex: a fan, (0, i, i + 1). Convex means that it never turns right and goes around once; straight and repeated
// corners may be among them, so polygons on a line or in a point can be convex too.
//   - Not convex: ear clipping (ear_clipping.hpp says by which rule), in the order of the cuts.
// The corners of the triangles run in the direction of the polygon. Coordinates must be finite.
class Triangulator {
 public:
  // The result is valid until the next call. Memory is kept for the next call, and only polygons of more than 3 corners
  // need any.
  [[nodiscard]] std::span<const CornerTriangle> triangulate(std::span<const Eigen::Vector3f> vertices,
                                                            std::span<const std::int32_t> polygon);
  [[nodiscard]] std::span<const CornerTriangle> triangulate(const Mesh& mesh, std::size_t polygon) {
    return triangulate(mesh.vertices.span(), mesh.polygon(polygon));
  }

 private:
  std::vector<PlanePoint> points_;
  std::vector<CornerTriangle> triangles_;
  EarClipping ear_clipping_;
};

// Returns whether the area vector (Newell) is not zero, exactly. It is zero where a polygon crosses itself so that its
// parts make up for each other, as in a bow tie: such a polygon has no front.
[[nodiscard]] bool has_front(std::span<const Eigen::Vector3f> vertices, std::span<const std::int32_t> polygon);

// Returns the number of triangles that a polygon of that many corners gives.
[[nodiscard]] constexpr std::uint64_t triangle_count(std::uint64_t corners) { return corners < 4 ? 1 : corners - 2; }

}  // namespace peerd
