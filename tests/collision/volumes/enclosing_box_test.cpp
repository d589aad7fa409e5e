#include "collision/volumes/enclosing_box.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/collision/soups.hpp"

namespace peerd::collision::enclosing_box_test {

std::vector<Vec3> turned_box(const Vec3& sides, const Mat3& rotation) {
  std::vector<Vec3> out;
  for (int i = 0; i < 8; ++i) {
    out.emplace_back(rotation * Vec3((i & 1) * sides.x(), (i >> 1 & 1) * sides.y(), (i >> 2 & 1) * sides.z()));
  }
  return out;
}

TEST(SmallBox, OfATurnedBoxIsThatBox) {
  Numbers numbers(3);
  for (int i = 0; i < 20; ++i) {
    const Mat3 rotation = quat_exp(numbers.point(3.0)).toRotationMatrix();
    const auto points = turned_box(Vec3(1, 2, 5), rotation);
    EXPECT_NEAR(volume(small_box(*convex_hull(points))), 10.0, 1e-9);
    EXPECT_GT(volume(box_along(Mat3::Identity(), points)), 10.0);
  }
}

// A regular tetrahedron's smallest box is the cube whose face diagonals are its edges (O'Rourke): three times its
// volume.
TEST(SmallBox, OfATetrahedron) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}};
  const auto hull = convex_hull(points);
  EXPECT_NEAR(hull->volume_m3, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(volume(small_box(*hull)), 1.0, 1e-4);
}

TEST(SmallBox, IsNoLargerThanTheAxisAlignedOne) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Numbers numbers(seed);
    std::vector<Vec3> points;
    for (int i = 0; i < 40; ++i) points.push_back(numbers.point(1.0));
    const EnclosingBox box = small_box(*convex_hull(points));
    EXPECT_LE(volume(box), volume(box_along(Mat3::Identity(), points)));
    const EnclosingBox again = box_along(box.axes, points);
    EXPECT_NEAR((again.sides - box.sides).norm(), 0.0, 1e-12) << "it holds all points";
    EXPECT_NEAR((box.axes * box.axes.transpose() - Mat3::Identity()).norm(), 0.0, 1e-9);
  }
}

}  // namespace peerd::collision::enclosing_box_test
