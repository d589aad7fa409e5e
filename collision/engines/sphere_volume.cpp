#include "collision/engines/sphere_volume.hpp"

#include <algorithm>

#include "collision/engines/volume_tree.hpp"
#include "core/box.hpp"

namespace peerd::collision::engines {

Sphere::Test::Test(const RelativeMotion& a_from_b, double extent_a_m, double extent_b_m)
    : a_from_b_(a_from_b),
      room_m_(8.0 * kRounding * (extent_a_m + extent_b_m + a_from_b.translation.cwiseAbs().maxCoeff())) {}

Sphere Sphere::around(const TriangleSoup& soup, std::span<const std::uint32_t> faces) {
  WorldBox box;
  for (const std::uint32_t face : faces) {
    for (const Vec3& corner : soup.triangle(face)) box.merge(corner);
  }
  Sphere sphere;
  sphere.center = (box.lo + box.hi) / 2.0;
  sphere.box_half = (box.hi - box.lo) / 2.0;
  for (const std::uint32_t face : faces) {
    for (const Vec3& corner : soup.triangle(face)) {
      sphere.radius_m = std::max(sphere.radius_m, (corner - sphere.center).norm());
    }
  }
  sphere.radius_m += kRounding * largest_coordinate(soup.box);
  return sphere;
}

std::array<Vec3, 3> Sphere::axes() const {
  std::array<int, 3> order{0, 1, 2};
  std::ranges::stable_sort(order, [this](int i, int j) { return box_half[i] > box_half[j]; });
  return {Vec3::Unit(order[0]), Vec3::Unit(order[1]), Vec3::Unit(order[2])};
}

}  // namespace peerd::collision::engines
