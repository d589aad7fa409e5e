#include "core/geometry/planarity.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace peerd::planarity_test {

using Rational = boost::multiprecision::cpp_rational;
using Point = Eigen::Vector3f;

struct RationalVector {
  Rational x, y, z;
};
RationalVector minus(const Point& a, const Point& b) {
  return {Rational(a.x()) - Rational(b.x()), Rational(a.y()) - Rational(b.y()), Rational(a.z()) - Rational(b.z())};
}
RationalVector cross(const RationalVector& a, const RationalVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
bool on_a_line(const Point& a, const Point& b, const Point& c) {
  const RationalVector n = cross(minus(b, a), minus(c, a));
  return n.x == 0 && n.y == 0 && n.z == 0;
}
bool in_a_plane(const Point& a, const Point& b, const Point& c, const Point& d) {
  const RationalVector n = cross(minus(b, a), minus(c, a)), p = minus(d, a);
  return n.x * p.x + n.y * p.y + n.z * p.z == 0;
}

// All points of a solid are on lines at first: the plane needs three that are not.
TEST(Planarity, OfManyPointsLooksAtAll) {
  std::vector<Point> points(3, Point(1, 1, 1));
  for (int i = 2; i < 20; ++i) points.emplace_back(Point::Constant(static_cast<float>(i)));
  EXPECT_TRUE(coplanar(points));
  points.emplace_back(1.0F, 2.0F, 3.0F);
  points.emplace_back(2.0F, 4.0F, 6.0F);
  EXPECT_TRUE(coplanar(points));
  points.emplace_back(1.0F, 0.0F, 0.0F);
  EXPECT_FALSE(coplanar(points));
  EXPECT_TRUE(coplanar(std::vector<Point>{}));
}

// The points have the largest and smallest numbers there are, and leave planes by the last place of one coordinate.
TEST(Planarity, IsWhatRationalNumbersSay) {
  constexpr float kMax = std::numeric_limits<float>::max(), kTiny = std::numeric_limits<float>::denorm_min();
  const std::vector<float> extremes = {0,    -0.0F, kTiny,  -kTiny, 3 * kTiny, 1, -1, std::nextafter(1.0F, 2.0F),
                                       kMax, -kMax, 1e-20F, 0.1F};
  std::mt19937 rng(11);
  int planar = 0, lines = 0;
  for (int round = 0; round < 20000; ++round) {
    std::vector<Point> p(4);
    if (round % 2 == 0) {
      for (Point& q : p) {
        for (float& x : q) x = extremes[rng() % extremes.size()];
      }
    } else {  // d = a + s (b - a) + t (c - a), with a unit of the last place more or less at times
      for (Point& q : p) {
        for (float& x : q) x = static_cast<float>(static_cast<int>(rng() % 2001) - 1000) * 0x1p-4F;
      }
      p[3] = p[0] + static_cast<float>(rng() % 4) * (p[1] - p[0]) + static_cast<float>(rng() % 4) * (p[2] - p[0]);
      if (rng() % 2 == 0) p[3].x() = std::nextafter(p[3].x(), 0.0F);
    }
    const bool plane = in_a_plane(p[0], p[1], p[2], p[3]), line = on_a_line(p[0], p[1], p[3]);
    planar += plane;
    lines += line;
    ASSERT_EQ(coplanar(p[0], p[1], p[2], p[3]), plane) << round;
    ASSERT_EQ(coplanar(p), plane) << round;
    ASSERT_EQ(collinear(p[0], p[1], p[3]), line) << round;
  }
  EXPECT_GT(planar, 4000);
  EXPECT_GT(lines, 500);
}

}  // namespace peerd::planarity_test
