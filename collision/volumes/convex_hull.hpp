#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/math.hpp"

namespace peerd::collision {

// The convex hull of points. Points that lie in a face or on an edge of it may be among the corners.
struct ConvexHull {
  std::vector<Vec3> corners;                            // [m], some of the points, each once
  std::vector<std::array<std::uint32_t, 3>> triangles;  // into `corners`, counter-clockwise seen from outside
  double volume_m3 = 0.0;                               // rounded
};

// Quickhull (Barber, Dobkin and Huhdanpaa, "The Quickhull algorithm for convex hulls", ACM TOMS 22(4), 1996) with exact
// signs: no point is outside, whatever the points are. There is none where all points lie in one plane. Coordinates are
// finite.
[[nodiscard]] std::optional<ConvexHull> convex_hull(std::span<const Vec3> points);

}  // namespace peerd::collision
