#include "core/geometry/triangulation.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "tests/oracle/ear_clipping_oracle.hpp"

namespace peerd::triangulation_test {

using Rational = boost::multiprecision::cpp_rational;
using Point3 = Eigen::Vector3f;
using Polygon = std::vector<Point3>;
using Triangles = std::vector<CornerTriangle>;

Triangles triangulated(const Polygon& polygon) {
  std::vector<std::int32_t> corners(polygon.size());
  std::iota(corners.begin(), corners.end(), 0);
  Triangulator triangulator;
  const auto triangles = triangulator.triangulate(polygon, corners);
  return {triangles.begin(), triangles.end()};
}

// The oracle follows the rule in rational numbers and in the plainest way; ears are cut by the oracle of ear clipping.
class Oracle {
 public:
  struct Point {
    Rational x, y;
    bool operator==(const Point&) const = default;
  };

  explicit Oracle(const Polygon& polygon) {
    std::array<Rational, 3> area;
    for (Eigen::Index k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        area[static_cast<std::size_t>(k)] +=
            Rational(p[(k + 1) % 3]) * Rational(q[(k + 2) % 3]) - Rational(p[(k + 2) % 3]) * Rational(q[(k + 1) % 3]);
      }
    }
    std::size_t axis = 0;
    for (const std::size_t k : {1U, 2U}) {
      if (abs(area[k]) > abs(area[axis])) axis = k;
    }
    twice_area = abs(area[axis]);
    auto x = static_cast<Eigen::Index>((axis + 1) % 3), y = static_cast<Eigen::Index>((axis + 2) % 3);
    if (area[axis] < 0) std::swap(x, y);
    for (const Point3& p : polygon) points.push_back({Rational(p[x]), Rational(p[y])});
  }

  [[nodiscard]] Rational twice_area_of(const CornerTriangle& t) const {
    return cross(points[t[0]], points[t[1]], points[t[2]]);
  }

  [[nodiscard]] bool is_convex() const {
    std::vector<Point> p;
    for (const Point& q : points) {
      if (p.empty() || q != p.back()) p.push_back(q);
    }
    while (p.size() > 1 && p.front() == p.back()) p.pop_back();
    if (p.size() == 1) return true;
    double turned = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Point &a = p[i], &b = p[(i + 1) % p.size()], &c = p[(i + 2) % p.size()];
      const Rational area = cross(a, b, c);
      if (area < 0) return false;
      const Rational forward = (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y);
      turned += std::atan2(area.convert_to<double>(), forward.convert_to<double>());
    }
    return turned < 3 * std::numbers::pi;  // one turn, not two
  }

  [[nodiscard]] Triangles triangulate() const {
    Triangles out;
    const auto count = static_cast<std::uint32_t>(points.size());
    if (is_convex()) {
      for (std::uint32_t i = 1; i + 1 < count; ++i) out.push_back({0, i, i + 1});
      return out;
    }
    std::vector<std::pair<double, double>> corners;
    for (const Point& p : points) corners.emplace_back(p.x.convert_to<double>(), p.y.convert_to<double>());
    return oracle::cut_ears(corners);
  }

  std::vector<Point> points;
  Rational twice_area;

 private:
  static Rational cross(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }
};

// Every polygon gives n - 2 triangles; each edge of the polygon is in one of them, each other edge in two, once each
// way; signed areas add up exactly.
void expect_sound(const Polygon& polygon, const Triangles& triangles) {
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  const Oracle oracle(polygon);
  Rational sum = 0;
  for (const CornerTriangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LT(t[k], polygon.size());
      ++edges[{t[k], t[(k + 1) % 3]}];
      --edges[{t[(k + 1) % 3], t[k]}];
    }
    sum += oracle.twice_area_of(t);
  }
  const auto n = static_cast<std::uint32_t>(polygon.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    --edges[{i, (i + 1) % n}];
    ++edges[{(i + 1) % n, i}];
  }
  for (const auto& [edge, count] : edges) ASSERT_EQ(count, 0) << edge.first << " " << edge.second;
  ASSERT_EQ(sum, oracle.twice_area);
}

// The triangles of a simple polygon then cover it and nothing else, once.
void expect_all_counter_clockwise(const Polygon& polygon, const Triangles& triangles) {
  const Oracle oracle(polygon);
  for (const CornerTriangle& t : triangles) {
    ASSERT_GT(oracle.twice_area_of(t), 0) << t[0] << " " << t[1] << " " << t[2];
  }
}

Polygon flat(const std::vector<std::array<float, 2>>& points) {
  Polygon polygon;
  for (const auto& [x, y] : points) polygon.emplace_back(x, y, 0.0F);
  return polygon;
}

struct Case {
  const char* name;
  Polygon polygon;
  Triangles triangles;
};
class Rule : public testing::TestWithParam<Case> {};
TEST_P(Rule, ByHand) { EXPECT_EQ(triangulated(GetParam().polygon), GetParam().triangles); }

INSTANTIATE_TEST_SUITE_P(
    Table, Rule,
    testing::Values(
        Case{"OneCorner", {{1, 2, 3}}, {{0, 0, 0}}}, Case{"TwoCorners", {{1, 2, 3}, {4, 5, 6}}, {{0, 1, 1}}},
        Case{"Triangle", {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}, {{0, 1, 2}}},
        Case{"TriangleInAPoint", {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 1, 2}}},
        Case{"Square", flat({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), {{0, 1, 2}, {0, 2, 3}}},
        Case{"SquareClockwise", flat({{0, 0}, {0, 1}, {1, 1}, {1, 0}}), {{0, 1, 2}, {0, 2, 3}}},
        Case{"SquareInXZ", {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}, {{0, 1, 2}, {0, 2, 3}}},
        // The polygons are cut along 0 2, and along 1 3, which is where they are concave. At 2, corner 0 is no ear, as
        // 2 is in its triangle.
        Case{"DartConcaveAt2", flat({{0, 0}, {4, -1}, {1, 0}, {4, 1}}), {{0, 1, 2}, {0, 2, 3}}},
        Case{"DartConcaveAt1", flat({{4, 1}, {1, 0}, {4, -1}, {0, 0}}), {{3, 0, 1}, {1, 2, 3}}},
        Case{"StraightCornerIsConvex", flat({{0, 0}, {1, 0}, {2, 0}, {1, 1}}), {{0, 1, 2}, {0, 2, 3}}},
        Case{"RepeatedCornerIsConvex", flat({{0, 0}, {1, 0}, {1, 0}, {1, 1}}), {{0, 1, 2}, {0, 2, 3}}},
        Case{"AllOnePoint", flat({{1, 1}, {1, 1}, {1, 1}, {1, 1}}), {{0, 1, 2}, {0, 2, 3}}},
        Case{"ThereAndBack", flat({{0, 0}, {1, 0}, {3, 0}, {2, 0}}), {{0, 1, 2}, {0, 2, 3}}},
        // The polygon is twisted, with the area vector (1, 1, 1): x is dropped. It is convex in y z, and concave at 1
        // in x y.
        Case{"TieDropsX", {{0, 0, 0}, {2, -1, 1}, {1, -1, 0}, {3, 0, -1}}, {{0, 1, 2}, {0, 2, 3}}},
        Case{"TieDropsXTurned", {{0, 0, 0}, {1, 2, -1}, {0, 1, -1}, {-1, 3, 0}}, {{3, 0, 1}, {1, 2, 3}}},
        // Corner 3 of an L is concave. 0 sees it on its new edge 5 1; 1 is the lowest ear.
        Case{"L", flat({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}), {{0, 1, 2}, {0, 2, 3}, {5, 0, 3}, {3, 4, 5}}},
        // A spike goes first: 2 is one, and then 1 (or 3), which is where its neighbour is.
        Case{"Spike", flat({{0, 0}, {2, 1}, {5, 1}, {2, 1}, {0, 3}}), {{1, 2, 3}, {0, 1, 3}, {0, 3, 4}}},
        // The areas of the crossed polygon cancel, so that all axes tie and x is dropped. In y z it runs to and fro on
        // one line, twice.
        Case{"BowTie", flat({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), {{3, 0, 1}, {1, 2, 3}}}),
    [](const auto& test) { return std::string(test.param.name); });

Polygon star_shaped(std::mt19937& rng, std::size_t n) {
  std::vector<double> angles(n);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  for (double& a : angles) a = angle(rng);
  std::ranges::sort(angles);
  std::uniform_real_distribution<double> radius(0.1, 1);
  // The polygon lies in a random direction, and is not quite planar once it is rounded.
  const Eigen::Quaterniond q = Eigen::Quaterniond(angle(rng), angle(rng), angle(rng), angle(rng)).normalized();
  const Eigen::Vector3d offset(angle(rng), angle(rng), angle(rng));
  Polygon polygon;
  for (const double a : angles) {
    const double r = radius(rng);
    polygon.emplace_back((q * Eigen::Vector3d(r * std::cos(a), r * std::sin(a), 0) + 10 * offset).cast<float>());
  }
  return polygon;
}

TEST(Triangulation, OfStarShapedPolygonsIsExact) {
  std::mt19937 rng(3);
  for (int round = 0; round < 300; ++round) {
    const std::size_t n = 5 + rng() % 30;
    const Polygon polygon = star_shaped(rng, n);
    const Triangles triangles = triangulated(polygon);
    expect_sound(polygon, triangles);
    if (n < 16) {  // few corners may leave a gap of half a turn, and cross there
      ASSERT_EQ(triangles, Oracle(polygon).triangulate());
    } else {
      expect_all_counter_clockwise(polygon, triangles);
    }
  }
}

// A polygon can't have a hole in VRML97, so that files lead a pair of edges to it.
TEST(Triangulation, OfHolesJoinedByPairsOfEdgesIsExact) {
  const Polygon one = flat({{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {2, 2}, {2, 4}, {4, 4}, {4, 2}, {2, 2}});
  const Polygon two = flat({{0, 0},
                            {9, 0},
                            {9, 6},
                            {0, 6},
                            {0, 0},
                            {2, 2},
                            {2, 4},
                            {4, 4},
                            {4, 2},
                            {5, 2},
                            {5, 4},
                            {7, 4},
                            {7, 2},
                            {5, 2},
                            {4, 2},
                            {2, 2}});
  const Polygon touching = flat({{0, 0}, {3, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {3, 0}, {2, 2}, {4, 2}, {3, 0}});
  for (Polygon polygon : {one, two}) {
    for (std::size_t first = 0; first < polygon.size(); ++first) {
      const Triangles triangles = triangulated(polygon);
      expect_sound(polygon, triangles);
      expect_all_counter_clockwise(polygon, triangles);
      EXPECT_EQ(triangles, Oracle(polygon).triangulate());
      std::ranges::rotate(polygon, polygon.begin() + 1);
    }
  }
  expect_sound(touching, triangulated(touching));
}

// Few places make every degeneracy common: crossings, spikes, repeated and straight corners, no area, ties of axes.
TEST(Triangulation, OfAnyPolygonIsWhatTheRuleSays) {
  std::mt19937 rng(4);
  for (int round = 0; round < 6000; ++round) {
    const std::size_t n = 4 + rng() % 9;
    const int size = 1 + static_cast<int>(rng() % 6);
    const bool planar = rng() % 2 == 0;
    Polygon polygon;
    for (std::size_t i = 0; i < n; ++i) {
      const auto at = [&] { return static_cast<float>(static_cast<int>(rng() % static_cast<unsigned>(size + 1))); };
      const float x = at(), y = at();
      polygon.emplace_back(x, y, planar ? x + 2 * y : at());
    }
    const Triangles triangles = triangulated(polygon);
    expect_sound(polygon, triangles);
    ASSERT_EQ(triangles, Oracle(polygon).triangulate()) << "round " << round;
  }
}

TEST(Triangulation, OfHugeAndTinyCoordinatesIsExact) {
  constexpr float kMax = std::numeric_limits<float>::max(), kTiny = std::numeric_limits<float>::denorm_min();
  std::mt19937 rng(5);
  const std::vector<float> values = {0,    kTiny, -kTiny, 3 * kTiny, 1, -1, std::nextafter(1.0F, 2.0F),
                                     kMax, -kMax, 1e-20F};
  for (int round = 0; round < 3000; ++round) {
    Polygon polygon;
    const std::size_t n = 4 + rng() % 6;
    for (std::size_t i = 0; i < n; ++i) {
      const auto at = [&] { return values[rng() % values.size()]; };
      const float x = at(), y = at(), z = at();
      polygon.emplace_back(x, y, z);
    }
    const Triangles triangles = triangulated(polygon);
    expect_sound(polygon, triangles);
    ASSERT_EQ(triangles.size(), n - 2);
  }
}

// The quadrilaterals are twisted, far from the origin, and their area vectors have equal components but for the last
// places.
TEST(Triangulation, OfNearTiesIsWhatTheRuleSays) {
  std::mt19937 rng(7);
  for (int round = 0; round < 3000; ++round) {
    Polygon polygon = {{0, 0, 0}, {2, -1, 1}, {1, -1, 0}, {3, 0, -1}};
    const float scale = 0.1F * static_cast<float>(1 + rng() % 9), offset = static_cast<float>(rng() % 3) * 1e4F;
    const int turned = static_cast<int>(rng() % 3);
    for (Point3& p : polygon) {
      p = Point3(p[turned], p[(turned + 1) % 3], p[(turned + 2) % 3]) * scale + Point3::Constant(offset);
      if (rng() % 4 == 0) p.x() = std::nextafter(p.x(), 0.0F);
      for (float& x : p) {  // where it's 0 still: of the size of what binary64 loses of the others
        if (x == 0.0F) x = static_cast<float>(static_cast<int>(rng() % 33) - 16) * 0x1p-55F;
      }
    }
    ASSERT_EQ(triangulated(polygon), Oracle(polygon).triangulate()) << round;
  }
}

TEST(Triangulation, DoesNotDependOnScale) {
  std::mt19937 rng(6);
  for (int round = 0; round < 100; ++round) {
    const Polygon polygon = star_shaped(rng, 12);
    Polygon scaled = polygon;
    for (Point3& p : scaled) p *= round % 2 == 0 ? 0x1p100F : 0x1p-60F;
    EXPECT_EQ(triangulated(polygon), triangulated(scaled));
  }
}

TEST(Triangulator, ReadsPolygonsOfAMeshOneAfterTheOther) {
  const Mesh mesh = make_mesh(std::vector<Point3>{{0, 0, 0}, {4, -1, 0}, {1, 0, 0}, {4, 1, 0}},
                              std::vector<std::int32_t>{3, -1, 0, 1, 2, 3, -1, 2, 3, -1, 1, 2, 3});
  Triangulator triangulator;
  const auto of = [&](std::size_t i) {
    const auto triangles = triangulator.triangulate(mesh, i);
    return Triangles(triangles.begin(), triangles.end());
  };
  EXPECT_EQ(of(0), (Triangles{{0, 0, 0}}));
  EXPECT_EQ(of(1), (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(of(2), (Triangles{{0, 1, 1}}));
  EXPECT_EQ(of(3), (Triangles{{0, 1, 2}}));
  EXPECT_EQ(of(1), (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

}  // namespace peerd::triangulation_test
