#pragma once
#include "collision/triangle_pair.hpp"

namespace peerd::collision {

// The distance of two triangles and a pair of points that has it, as rounded: of a few units in the last place of their
// largest coordinate. Triangles that cross have distance 0.
struct TriangleDistance {
  double distance = 0.0;
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();
};
[[nodiscard]] TriangleDistance triangle_distance(const Triangle& a, const Triangle& b);

}  // namespace peerd::collision
