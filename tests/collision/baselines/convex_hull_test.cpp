#include "collision/baselines/convex_hull.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/collision/soups.hpp"

namespace peerd::collision::baselines::convex_hull_test {

using ::testing::Each;
using ::testing::Ge;
using ::testing::IsSupersetOf;
using ::testing::SizeIs;

// The farthest a point is above its fellows' hull along a few directions [m]: at most 0 where the hull contains all.
double overhang(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& hull, std::uint64_t seed) {
  Numbers numbers(seed);
  double most = -1.0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 direction = numbers.point(1.0);
    double of_all = -1e300, of_hull = -1e300;
    for (const Vec3& p : points) of_all = std::max(of_all, direction.dot(p));
    for (const std::uint32_t at : hull) of_hull = std::max(of_hull, direction.dot(points[at]));
    most = std::max(most, of_all - of_hull);
  }
  return most;
}

TEST(ConvexHull, OfACubeWithMuchInsideIsItsCorners) {
  std::vector<Vec3> points;
  Numbers numbers(1);
  for (int i = 0; i < 200; ++i) points.push_back(numbers.point(1.0));
  for (int i = 0; i < 8; ++i) points.push_back({i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
  for (const double x : {-1.0, 0.0, 0.5, 1.0}) points.push_back({x, 1.0, 0.25});  // on its sides
  const auto hull = hull_corners(points);
  EXPECT_THAT(hull, IsSupersetOf({200u, 201u, 202u, 203u, 204u, 205u, 206u, 207u}));
  EXPECT_THAT(hull, Each(Ge(200u)));
}

TEST(ConvexHull, OfPointsOnASphereIsAllOfThem) {
  std::vector<Vec3> points;
  Numbers numbers(2);
  for (int i = 0; i < 500; ++i) points.push_back(numbers.point(1.0).normalized());
  EXPECT_THAT(hull_corners(points), SizeIs(500));
}

// A grid has points in one plane and on one line by the hundred, and each twice: what inexact signs stumble over.
TEST(ConvexHull, OfAGridHasEveryPointInside) {
  std::vector<Vec3> points;
  for (int i = 0; i < 2 * 7 * 7 * 7; ++i) points.push_back(0.1 * Vec3(i % 7, i / 7 % 7, i / 49 % 7));
  const auto hull = hull_corners(points);
  EXPECT_LE(overhang(points, hull, 3), 1e-15);
  EXPECT_THAT(hull, SizeIs(Ge(8u)));
  EXPECT_THAT(hull, SizeIs(testing::Lt(250u)));
}

TEST(ConvexHull, OfCloudsHasEveryPointInside) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    Numbers numbers(seed);
    std::vector<Vec3> points;
    const Vec3 size(1.0, seed % 3 == 0 ? 1e-9 : 1.0, seed % 5 == 0 ? 1e6 : 0.1);
    for (std::uint32_t i = 0; i < 5 + 40 * seed; ++i) points.push_back(numbers.point(1.0).cwiseProduct(size));
    EXPECT_LE(overhang(points, hull_corners(points), seed), 1e-9) << seed;
  }
}

TEST(ConvexHull, OfWhatIsFlatIsAllOfIt) {
  std::vector<Vec3> points;
  for (int i = 0; i < 9; ++i) points.push_back(Vec3(i % 3, i / 3, 1.0));
  EXPECT_THAT(hull_corners(points), SizeIs(9));
  EXPECT_THAT(hull_corners(std::vector<Vec3>(3, Vec3::Zero())), SizeIs(3));
}

}  // namespace peerd::collision::baselines::convex_hull_test
