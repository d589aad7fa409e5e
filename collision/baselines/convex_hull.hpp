#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "collision/exact/triangle_soup.hpp"

namespace peerd::collision::baselines {

// The indices of points whose convex hull contains all of them, ascending: the corners of the triangles of QuickHull
// (Barber, Dobkin and Huhdanpaa, "The Quickhull algorithm for convex hulls", ACM TOMS 22(4), 1996). All signs are exact
// (orientation.hpp), so that no point is outside the hull, and none needs the paper's wide facets. Points that are all
// in one plane are all returned.
[[nodiscard]] std::vector<std::uint32_t> hull_corners(std::span<const Vec3> points);

// Points of a soup's triangles whose convex hull contains all of those [m].
[[nodiscard]] std::vector<Vec3> hull_of(const TriangleSoup& soup);

}  // namespace peerd::collision::baselines
