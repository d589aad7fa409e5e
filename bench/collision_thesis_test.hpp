#pragma once
#include "collision/exact/triangle_pair.hpp"

namespace peerd::bench {

// The thesis's polygon-polygon test (3.2.2), of triangles in binary64: does an edge of one cross the other's plane, and
// is the place where it does inside by the crossings test (Haines, "Point in Polygon Strategies", Graphics Gems IV,
// 1994)? No care is taken of coplanar polygons, and the half-open crossings test decides borders.
[[nodiscard]] bool thesis_polygons_touch(const collision::Triangle& a, const collision::Triangle& b);

}  // namespace peerd::bench
