#pragma once
#include "collision/exact/orientation.hpp"
#include "collision/exact/triangle.hpp"

namespace peerd::collision {

// Whether two triangles share a point. Exact for all finite binary64 corners: the answer of the real numbers, so it
// doesn't depend on the order of triangles or corners, on the compiler or on the instruction set.
[[nodiscard]] bool touch(const Triangle& a, const Triangle& b, OrientationCounters& counters);

}  // namespace peerd::collision
