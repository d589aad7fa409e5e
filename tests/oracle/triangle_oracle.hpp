#pragma once
#include <array>

namespace peerd::oracle {

using Point = std::array<double, 3>;
using Triangle = std::array<Point, 3>;

// Whether two triangles share a point. A triangle is the closed convex hull of its three points, also when that is a
// segment or a point. Exact for all finite coordinates; no tolerance.
[[nodiscard]] bool touch(const Triangle& a, const Triangle& b);

}  // namespace peerd::oracle
