#pragma once
#include <span>

#include "collision/volumes/convex_hull.hpp"
#include "core/math.hpp"

namespace peerd::collision {

// A box around points, along axes of its own.
struct EnclosingBox {
  Mat3 axes = Mat3::Identity();  // its rows are the axes
  Vec3 sides = Vec3::Zero();     // lengths along them [m]
};

// The box around points along given axes.
[[nodiscard]] EnclosingBox box_along(const Mat3& axes, std::span<const Vec3> points);

// A small box around a hull: the smallest with a side in one of the hull's faces (O'Rourke, "Finding minimal enclosing
// boxes", Int. J. Comp. Inf. Sci. 14, 1985, shows that the smallest has two sides that touch edges), or one along the
// frame or the principal axes, turned for as long as small turns make it smaller. A local minimum, without randomness;
// of 16,000 faces or more, every n-th is tried.
[[nodiscard]] EnclosingBox small_box(const ConvexHull& hull);

[[nodiscard]] double volume(const EnclosingBox& box);  // [m^3]

}  // namespace peerd::collision
