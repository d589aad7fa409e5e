#include "collision/volumes/convex_hull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "collision/exact/orientation.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::convex_hull_test {

// Corners of an integer grid of side `n`, moved by `at`.
std::vector<Vec3> grid(int n, const Vec3& at) {
  std::vector<Vec3> out;
  for (int x = 0; x <= n; ++x) {
    for (int y = 0; y <= n; ++y) {
      for (int z = 0; z <= n; ++z) out.emplace_back(at + Vec3(x, y, z));
    }
  }
  return out;
}

// Points spread about evenly over the unit sphere, by a spiral.
std::vector<Vec3> sphere(int count) {
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, r = std::sqrt(1 - z * z);
    const double angle_rad = i * std::numbers::pi * (3 - std::sqrt(5.0));
    out.emplace_back(r * std::cos(angle_rad), r * std::sin(angle_rad), z);
  }
  return out;
}

// Exactly: no point is in front of a triangle, and each edge has a triangle on either side.
void expect_hull(const ConvexHull& hull, const std::vector<Vec3>& points) {
  OrientationCounters counters;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : hull.triangles) {
    for (const Vec3& p : points) {
      ASSERT_LE(volume_sign(hull.corners[t[0]], hull.corners[t[1]], hull.corners[t[2]], p, counters), 0);
    }
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_EQ(hull.triangles.size(), 2 * hull.corners.size() - 4) << "Euler's formula";
}

TEST(ConvexHull, OfACubeWithPointsAllOverIt) {
  for (const int n : {1, 2, 5}) {
    const auto points = grid(n, Vec3(0.1, 1e3, -7));
    const auto hull = convex_hull(points);
    ASSERT_TRUE(hull);
    expect_hull(*hull, points);
    EXPECT_NEAR(hull->volume_m3, n * n * n, 1e-9);
  }
  EXPECT_EQ(convex_hull(grid(1, Vec3::Zero()))->corners.size(), 8u);
}

TEST(ConvexHull, OfRandomAndDoubledPoints) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Numbers numbers(seed);
    std::vector<Vec3> points;
    const auto count = static_cast<std::size_t>(12 + 100 * numbers.unit());
    for (std::size_t i = 0; i < count; ++i) {
      // Coordinates of few bits make many coplanar points.
      Vec3 p = numbers.point(1.0);
      if (seed % 2 == 0) p = (4.0 * p).array().round().matrix();
      points.push_back(p);
      if (numbers.unit() < 0.2) points.push_back(points[static_cast<std::size_t>(numbers.unit() * i)]);
    }
    const auto hull = convex_hull(points);
    ASSERT_TRUE(hull) << seed;
    expect_hull(*hull, points);
    std::ranges::reverse(points);
    const auto other = convex_hull(points);
    ASSERT_TRUE(other);
    EXPECT_NEAR(hull->volume_m3, other->volume_m3, 1e-12 * (1.0 + hull->volume_m3)) << seed;
  }
}

// An inscribed polyhedron of n even points lacks some 4.8 / n of the ball's volume.
TEST(ConvexHull, OfASphereIsNearlyIt) {
  const auto points = sphere(5'000);
  const auto hull = convex_hull(points);
  ASSERT_TRUE(hull);
  EXPECT_EQ(hull->corners.size(), points.size());
  const double ball = 4.0 / 3.0 * std::numbers::pi;
  EXPECT_LT(hull->volume_m3, ball);
  EXPECT_GT(hull->volume_m3, ball * (1.0 - 2e-3));
}

TEST(ConvexHull, ThereIsNoneOfPointsInOnePlane) {
  EXPECT_FALSE(convex_hull({}));
  EXPECT_FALSE(convex_hull(std::vector<Vec3>(5, Vec3::Ones())));
  EXPECT_FALSE(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}}));
  std::vector<Vec3> flat;
  for (const Vec3& p : grid(3, Vec3::Zero())) flat.emplace_back(p.x(), p.y(), p.x() + 2.0 * p.y());
  EXPECT_FALSE(convex_hull(flat));
  flat.emplace_back(0.0, 0.0, 0x1p-1000);
  EXPECT_TRUE(convex_hull(flat)) << "one point a trifle off";
}

}  // namespace peerd::collision::convex_hull_test
