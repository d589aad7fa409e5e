#include "collision/volumes/enclosing_ball.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/collision/soups.hpp"

namespace peerd::collision::enclosing_ball_test {

// The thesis's figure for a cube: its bounding sphere has pi sqrt(3) / 2 = 272.07 % of its volume.
TEST(SmallestBall, OfACube) {
  std::vector<Vec3> cube;
  for (int i = 0; i < 8; ++i) cube.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  for (int i = 0; i < 8; ++i) cube.push_back(cube[static_cast<std::size_t>(i)]);  // all doubled
  const EnclosingBall ball = smallest_ball(cube);
  EXPECT_NEAR(volume(ball), std::numbers::pi * std::sqrt(3.0) / 2.0, 1e-12);
}

// The ball holds all points. The distance to the farthest one is a convex function of the center, so that a center that
// no small move makes better is the best one.
TEST(SmallestBall, IsTheSmallestOfRandomPoints) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Numbers numbers(seed);
    std::vector<Vec3> points;
    for (int i = 0; i < 12; ++i) points.push_back(numbers.point(1.0));
    const EnclosingBall ball = smallest_ball(points);
    for (const Vec3& p : points) EXPECT_LE((p - ball.center).norm(), ball.radius_m);
    for (int i = 0; i < 200; ++i) {
      const Vec3 near = ball.center + numbers.point(1e-3);
      double radius = 0.0;
      for (const Vec3& p : points) radius = std::max(radius, (p - near).norm());
      EXPECT_GE(radius, ball.radius_m * (1.0 - 1e-9)) << seed;
    }
  }
}

}  // namespace peerd::collision::enclosing_ball_test
