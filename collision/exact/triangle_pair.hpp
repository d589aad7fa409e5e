#pragma once
#include <array>

#include "collision/exact/orientation.hpp"

namespace peerd::collision {

// The closed convex hull of three points of one frame [m]: with collinear corners a segment, with equal ones a point.
using Triangle = std::array<Vec3, 3>;

// Whether two triangles share a point. Exact for all finite binary64 corners: the answer of the real numbers, so it
// doesn't depend on the order of triangles or corners, on the compiler or on the instruction set.
[[nodiscard]] bool touch(const Triangle& a, const Triangle& b, OrientationCounters& counters);

}  // namespace peerd::collision
