#pragma once
#include <cstdint>
#include <vector>

#include "collision/query/tree_query.hpp"

namespace peerd::collision {

// Numbers in [0, 1) that are the same everywhere (splitmix64).
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed) {}
  double unit() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  double between(double low, double high) { return low + (high - low) * unit(); }
  Vec3 point(double size) {
    const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

// Triangles of that size around random places of a cube of half side 1, with cracks, crossings, a few doubled, a few
// without an area. Binary32 coordinates.
[[nodiscard]] TriangleSoup random_soup(std::uint32_t triangles, double size, std::uint64_t seed);

// A closed tube around a circle: 2 * around * along triangles, two to a polygon where `quads`.
[[nodiscard]] TriangleSoup torus(std::uint32_t around, std::uint32_t along, bool quads);

// A closed box of half sides `half` around `center`, seen from outside. Polygons of two triangles each: 0 -x, 1 +x,
// 2 -y, 3 +y, 4 -z, 5 +z.
[[nodiscard]] TriangleSoup closed_box(const Vec3& half, const Vec3& center = Vec3::Zero());
// Half a space as files have it: a box below z = 0, to the largest binary32 numbers. Six of its triangles.
[[nodiscard]] TriangleSoup half_space();

// Sets the box of a soup whose vertices have been changed.
void find_box(TriangleSoup& soup);

[[nodiscard]] Pose random_pose(Numbers& numbers, double distance);

// All pairs of polygons with a common point, every triangle against every one.
[[nodiscard]] std::vector<PolygonPair> brute_force(const TriangleSoup& a, const TriangleSoup& b,
                                                   const RelativeMotion& a_from_b);

}  // namespace peerd::collision
