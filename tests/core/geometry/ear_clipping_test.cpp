#include "core/geometry/ear_clipping.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/oracle/ear_clipping_oracle.hpp"

namespace peerd::ear_clipping_test {

using Points = std::vector<PlanePoint>;
using Triangles = std::vector<CornerTriangle>;

Triangles cut(const Points& points) {
  Triangles triangles;
  EarClipping().cut(points, triangles);
  return triangles;
}

Triangles by_oracle(const Points& points) {
  std::vector<std::pair<double, double>> polygon;
  for (const PlanePoint& p : points) polygon.emplace_back(p.x, p.y);
  return oracle::cut_ears(polygon);
}

// The area of most polygons is positive, as cut() requires; the rule is defined for the others as well.
Points to_the_left(Points points) {
  double area = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PlanePoint &p = points[i], &q = points[(i + 1) % points.size()];
    area += static_cast<double>(p.x) * static_cast<double>(q.y) - static_cast<double>(q.x) * static_cast<double>(p.y);
  }
  if (area < 0) std::ranges::reverse(points);
  return points;
}

class RandomPolygon {
 public:
  explicit RandomPolygon(std::uint32_t seed) : random_(seed) {}
  Points next() {
    const std::size_t n = 4 + random_() % (random_() % 8 == 0 ? 400 : 40);
    switch (random_() % 6) {
      case 0:
        return star(n);
      case 1:
        return anywhere(n, 0);  // crosses itself
      case 2:
        return anywhere(n, 2 + random_() % 6);  // this one touches itself, with equal corners and straight ones
      case 3:
        return steps(n);
      case 4:
        return spiral(n);
      default:
        return with_seams(star(n));
    }
  }

 private:
  float number(double lo, double hi) {
    return static_cast<float>(std::uniform_real_distribution<double>(lo, hi)(random_));
  }
  Points star(std::size_t n) {
    Points points;
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
      const auto r = static_cast<double>(number(0.1, 1));
      points.push_back({static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle))});
    }
    return points;
  }
  Points anywhere(std::size_t n, std::size_t grid) {
    Points points;
    for (std::size_t i = 0; i < n; ++i) {
      if (grid == 0) {
        points.push_back({number(-1, 1), number(-1, 1)});
      } else {
        points.push_back({static_cast<float>(random_() % grid), static_cast<float>(random_() % grid)});
      }
    }
    return points;
  }
  // The polygon is a walk along the lines of a grid, to and fro.
  Points steps(std::size_t n) {
    Points points;
    PlanePoint at;
    for (std::size_t i = 0; i < n; ++i) {
      (random_() % 2 == 0 ? at.x : at.y) += static_cast<float>(random_() % 3) - 1.0F;
      points.push_back(at);
    }
    return points;
  }
  Points spiral(std::size_t n) {
    Points points;
    const double turns = static_cast<double>(number(0.2, 5));
    for (std::size_t i = 0; i < n; ++i) {
      const bool outward = i < n / 2;
      const double t = static_cast<double>(outward ? i : n - 1 - i) / static_cast<double>(n);
      const double r = 1 + 10 * t + (outward ? 0.4 : 0.0), a = 4 * std::numbers::pi * turns * t;
      points.push_back({static_cast<float>(r * std::cos(a)), static_cast<float>(r * std::sin(a))});
    }
    return points;
  }
  // The polygon goes from some corners to another and back, and has corners twice.
  Points with_seams(Points points) {
    for (int k = 0; k < 3; ++k) {
      const std::size_t i = random_() % points.size(), j = random_() % points.size();
      const PlanePoint here = points[i], there = points[j];
      const auto at = points.begin() + static_cast<std::ptrdiff_t>(i);
      random_() % 2 == 0 ? points.insert(at, here) : points.insert(at, {here, there});
    }
    return points;
  }

  std::mt19937 random_;
};

TEST(EarClipping, CutsAsTheOracleDoes) {
  RandomPolygon polygons(5);
  for (int round = 0; round < 300; ++round) {
    const Points points = round % 4 == 0 ? polygons.next() : to_the_left(polygons.next());
    ASSERT_EQ(cut(points), by_oracle(points)) << "round " << round;
  }
}

// State that was kept of the polygon before is of no account.
TEST(EarClipping, ForgetsTheLastPolygon) {
  RandomPolygon polygons(6);
  EarClipping clipping;
  for (int round = 0; round < 500; ++round) {
    const Points points = to_the_left(polygons.next());
    Triangles triangles;
    clipping.cut(points, triangles);
    ASSERT_EQ(triangles, cut(points)) << "round " << round;
  }
}

// The polygon has two straight edges and a concave arc: the triangle of each corner has the range of x, or of y, of
// many others.
Points funnel(std::size_t n) {
  Points points = {{0, 0}, {2, 0}, {2, 2}};
  for (std::size_t i = 1; i + 3 < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n - 3) * std::numbers::pi / 2;
    points.push_back({static_cast<float>(2 - 1.998 * std::sin(t)), static_cast<float>(2 * std::cos(t))});
  }
  return points;
}
TEST(EarClipping, OfManyCornersIsNotQuadratic) {
  EXPECT_EQ(cut(funnel(500)), by_oracle(funnel(500)));
  EXPECT_EQ(cut(funnel(80'000)).size(), 79'997U);  // polygon of 79,999 corners
}

}  // namespace peerd::ear_clipping_test
