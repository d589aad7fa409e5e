#include "core/geometry/mesh_defects.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <tuple>

#include "core/geometry/tessellate.hpp"

namespace peerd::mesh_defects_test {

using Rational = boost::multiprecision::cpp_rational;
using Point = Eigen::Vector3f;
using Counts = std::array<std::uint64_t, kDefects>;  // degenerate, duplicate, non-planar, warped, non-manifold

MeshDefects defects_of(const std::vector<Point>& vertices, const std::vector<std::int32_t>& corners) {
  return MeshDefectFinder().find(make_mesh(vertices, corners));
}

Counts counts_of(const MeshDefects& defects) {
  Counts counts;
  for (std::size_t i = 0; i < kDefects; ++i) counts[i] = defects.counts[i].polygons;
  return counts;
}

Counts edges_of(const MeshDefects& d) {
  return {d.boundary_edges, d.non_manifold_edges, d.same_direction_edges, d.edges_without_length};
}

// The corners lie on a plane of no axis; all are exact.
std::vector<Point> tilted(const std::vector<std::array<float, 2>>& points) {
  std::vector<Point> out;
  for (const auto& [x, y] : points) out.emplace_back(x, x + 2 * y + 1, y - x);
  return out;
}

struct Case {
  const char* name;
  std::vector<Point> vertices;
  std::vector<std::int32_t> corners;
  Counts polygons;
  Counts edges;  // boundary, non-manifold, same direction, without length
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class DefectsByHand : public testing::TestWithParam<Case> {};
TEST_P(DefectsByHand, AreCounted) {
  const Case& c = GetParam();
  const MeshDefects found = defects_of(c.vertices, c.corners);
  EXPECT_EQ(counts_of(found), c.polygons);
  EXPECT_EQ(edges_of(found), c.edges);
}

const std::vector<Point> kSquare = tilted({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
const std::vector<Point> kTetrahedron = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Point> kBook = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};

INSTANTIATE_TEST_SUITE_P(
    Table, DefectsByHand,
    testing::Values(
        Case{"Nothing", {}, {}, {}, {}},                     //
        Case{"Triangle", kSquare, {0, 1, 2, -1}, {}, {3}},   //
        Case{"Square", kSquare, {0, 1, 2, 3, -1}, {}, {4}},  //
        Case{"Closed", kTetrahedron, {0, 2, 1, -1, 0, 1, 3, -1, 1, 2, 3, -1, 2, 0, 3}, {}, {}},
        Case{"OneFaceTurned", kTetrahedron, {0, 1, 2, -1, 0, 1, 3, -1, 1, 2, 3, -1, 2, 0, 3}, {}, {0, 0, 3}},
        // Degenerate
        Case{"Point", kSquare, {0, -1}, {1}, {0, 0, 0, 1}},  //
        Case{"Segment", kSquare, {0, 1, -1}, {1}, {}},       //
        Case{"OnALine", tilted({{0, 0}, {1, 1}, {3, 3}}), {0, 1, 2, -1}, {1}, {3}},
        Case{"NearlyOnALine", {{0, 0, 0}, {1, 1, 1}, {3, 3, 3 + 0x1p-22F}}, {0, 1, 2, -1}, {}, {3}},
        Case{"AllInOnePlace", kSquare, {1, 1, 1, 1, -1}, {1}, {0, 0, 0, 4}},
        Case{"OutAndBackTwice", kSquare, {0, 1, 0, 3, -1}, {1}, {0, 0, 0, 0}},
        Case{"BackAndForthOnALine", tilted({{0, 0}, {3, 3}, {1, 1}, {2, 2}}), {0, 1, 2, 3, -1}, {1}, {4}},
        // The parts of the polygon cancel out, and still have an area.
        Case{"BowTie", tilted({{0, 0}, {2, 2}, {2, 0}, {0, 2}}), {0, 1, 2, 3, -1}, {1}, {4}},
        Case{"UnevenBowTie", tilted({{0, 0}, {2, 2}, {2, 0}, {0, 3}}), {0, 1, 2, 3, -1}, {}, {4}},
        Case{"TinyArea", {{0, 0, 0}, {1e-45F, 0, 0}, {0, 1e-45F, 0}}, {0, 1, 2, -1}, {}, {3}},
        Case{"HugeArea", {{3e38F, 0, 0}, {-3e38F, 1e-45F, 0}, {0, 0, 0}}, {0, 1, 2, -1}, {}, {3}},
        // Duplicate
        Case{"SameAgain", kSquare, {0, 1, 2, -1, 0, 1, 2, -1}, {0, 1}, {0, 0, 3}},
        Case{"Rotated", kSquare, {0, 1, 2, 3, -1, 2, 3, 0, 1, -1}, {0, 1}, {0, 0, 4}},
        Case{"Reversed", kSquare, {0, 1, 2, 3, -1, 1, 0, 3, 2, -1}, {0, 1}, {}},
        Case{"ThreeOfAKind", kSquare, {0, 1, 2, -1, 2, 1, 0, -1, 1, 2, 0, -1}, {0, 2, 0, 0, 3}, {0, 3}},
        Case{"OtherOrder", kSquare, {0, 1, 2, 3, -1, 0, 2, 1, 3, -1}, {1, 0}, {4, 0, 1}},
        Case{"OtherVertices",
             {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0F, 0, -0.0F}, {1, -0.0F, 0}, {0, 1, 0}},
             {0, 1, 2, -1, 5, 4, 3, -1},
             {0, 1},
             {}},
        Case{"WithAStraightCorner",
             tilted({{0, 0}, {4, 0}, {0, 4}, {2, 0}}),
             {0, 1, 2, -1, 0, 3, 1, 2, -1},
             {},
             {3, 0, 2}},
        Case{"CornerTwice", kSquare, {0, 1, 2, -1, 0, 1, 1, 2, -1}, {}, {0, 0, 3, 1}},
        Case{"TwoSegments", kSquare, {0, 1, -1, 1, 0, -1}, {2, 1}, {0, 0, 1}},
        // Non-planar
        Case{"OffByTheLastPlace",
             {{0, 0, 0}, {1, 0, 0}, {1, 1, 0x1p-149F}, {0, 1, 0}},
             {0, 1, 2, 3, -1},
             {0, 0, 1},
             {4}},
        Case{"NotByEnoughToSee", {{0, 0, 0}, {1, 0, 0}, {1, 1, 1.99e-4F}, {0, 1, 0}}, {0, 1, 2, 3}, {0, 0, 1, 0}, {4}},
        Case{"ByEnoughToSee", {{0, 0, 0}, {1, 0, 0}, {1, 1, 2.01e-4F}, {0, 1, 0}}, {0, 1, 2, 3}, {0, 0, 1, 1}, {4}},
        Case{"FarFromTheOrigin",
             {{8e6F, 8e6F, 0}, {8e6F + 1, 8e6F, 0}, {8e6F + 1, 8e6F + 1, 0}, {8e6F, 8e6F + 1, 1e-5F}},
             {0, 1, 2, 3},
             {0, 0, 1, 0},
             {4}},
        Case{"OffBeforeTheThirdOfItsPlane",
             {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 1}},
             {0, 1, 2, 3, 4, 5, -1},
             {0, 0, 1, 1},
             {6}},
        // The area vector is zero, but there is no plane, and the triangles have areas.
        Case{"SpikesOfThreeAxes", kTetrahedron, {0, 1, 0, 2, 0, 3, -1}, {1, 0, 1, 1}, {}},
        // Non-manifold
        Case{"Book", kBook, {0, 1, 2, -1, 1, 0, 3, -1, 0, 1, 4, -1}, {0, 0, 0, 0, 3}, {6, 1}},
        Case{"BookOfFour", kBook, {0, 1, 2, -1, 1, 0, 3, -1, 0, 1, 4, -1, 1, 0, 5, -1}, {0, 0, 0, 0, 4}, {8, 1}},
        // The polygon goes to a hole and back again, as files have holes: that edge belongs to one polygon.
        Case{"HoleByABridge",
             tilted({{0, 0}, {6, 0}, {6, 6}, {0, 6}, {2, 2}, {2, 4}, {4, 4}, {4, 2}}),
             {0, 1, 2, 3, 0, 4, 5, 6, 7, 4, -1},
             {},
             {8}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(MeshDefects, OfSolidsAreNone) {
  for (const Geometry& solid :
       {Geometry(BoxGeometry{}), Geometry(ConeGeometry{}), Geometry(CylinderGeometry{}), Geometry(SphereGeometry{})}) {
    const MeshDefects found = MeshDefectFinder().find(build_mesh(solid));
    EXPECT_EQ(edges_of(found), Counts{}) << solid.index();
    Counts expected{};
    expected[2] = found[Defect::kNonPlanar].polygons;  // polygons of the sphere, by rounding
    EXPECT_EQ(counts_of(found), expected) << solid.index();
    if (!std::holds_alternative<SphereGeometry>(solid)) {
      EXPECT_EQ(expected, Counts{}) << solid.index();
    }
  }
  const MeshDefects no_bottom = MeshDefectFinder().find(build_mesh(ConeGeometry{.bottom = false}));
  EXPECT_EQ(edges_of(no_bottom), Counts{24});
}

// The oracle works in the plainest way: rational numbers, and every pair is compared.
class Oracle {
 public:
  explicit Oracle(const Mesh& mesh) : mesh_(mesh) {
    for (std::size_t i = 0; i < mesh.polygon_count(); ++i) polygons_.push_back(corners_of(i));
    for (std::size_t i = 0; i < polygons_.size(); ++i) {
      set(0, i, area_of(polygons_[i]) == Place{});
      bool earlier = false;
      for (std::size_t j = 0; j < i; ++j) earlier |= alike(polygons_[i], polygons_[j]);
      set(1, i, earlier);
      const bool solid = !is_planar(polygons_[i]);
      set(2, i, solid);
      set(3, i, solid && is_warped(polygons_[i]));
    }
    find_edges();
  }

  Counts counts{}, edges{};
  std::array<std::optional<std::size_t>, kDefects> first;
  bool doubtful = false;  // too close to the limit of what is warped for binary64

 private:
  using Place = std::array<Rational, 3>;
  using Polygon = std::vector<Place>;

  static Place minus(const Place& a, const Place& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static Place cross(const Place& a, const Place& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static Rational dot(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  void set(std::size_t defect, std::size_t polygon, bool has_it) {
    counts[defect] += has_it;
    if (has_it && !first[defect]) first[defect] = polygon;
  }
  [[nodiscard]] Polygon corners_of(std::size_t i) const {
    Polygon out;
    for (const std::int32_t c : mesh_.polygon(i)) {
      const Point& p = mesh_.vertices[static_cast<std::size_t>(c)];
      out.push_back({Rational(p.x()), Rational(p.y()), Rational(p.z())});
    }
    return out;
  }
  static Place area_of(const Polygon& p) {
    Place area{};
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Place c = cross(p[i], p[(i + 1) % p.size()]);
      for (std::size_t k = 0; k < 3; ++k) area[k] += c[k];
    }
    return area;
  }
  static bool alike(const Polygon& a, const Polygon& b) {
    const std::size_t n = a.size();
    if (n != b.size()) return false;
    for (std::size_t shift = 0; shift < n; ++shift) {
      bool forward = true, backward = true;
      for (std::size_t i = 0; i < n; ++i) {
        forward &= a[i] == b[(i + shift) % n];
        backward &= a[i] == b[(2 * n - i - 1 + shift) % n];
      }
      if (forward || backward) return true;
    }
    return false;
  }
  static bool is_planar(const Polygon& p) {
    for (std::size_t i = 1; i < p.size(); ++i) {
      for (std::size_t j = i + 1; j < p.size(); ++j) {
        const Place normal = cross(minus(p[i], p[0]), minus(p[j], p[0]));
        for (std::size_t k = j + 1; k < p.size(); ++k) {
          if (dot(normal, minus(p[k], p[0])) != 0) return false;
        }
      }
    }
    return true;
  }
  bool is_warped(const Polygon& p) {
    const Place area = area_of(p);
    Rational longest = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Place edge = minus(p[(i + 1) % p.size()], p[i]);
      longest = std::max<Rational>(longest, dot(edge, edge));
    }
    if (area == Place{}) return true;
    Rational low = dot(area, p[0]), high = low;
    for (const Place& at : p) {
      low = std::min<Rational>(low, dot(area, at));
      high = std::max<Rational>(high, dot(area, at));
    }
    const Rational range_2 = (high - low) * (high - low), limit_2 = dot(area, area) * longest / 100'000'000;
    doubtful |= abs(range_2 - limit_2) * 1'000'000'000 < limit_2;
    return range_2 > limit_2;
  }
  void find_edges() {
    struct Uses {
      std::multiset<std::size_t> polygons;
      std::array<int, 2> directions{};
    };
    std::map<std::pair<Place, Place>, Uses> all;
    for (std::size_t i = 0; i < polygons_.size(); ++i) {
      const Polygon& p = polygons_[i];
      for (std::size_t k = 0; k < p.size(); ++k) {
        const Place &a = p[k], &b = p[(k + 1) % p.size()];
        edges[3] += a == b;
        if (a == b) continue;
        Uses& uses = all[std::minmax(a, b)];
        uses.polygons.insert(i);
        ++uses.directions[a < b];
      }
    }
    std::set<std::size_t> non_manifold;
    for (const auto& [edge, uses] : all) {
      const std::set<std::size_t> distinct(uses.polygons.begin(), uses.polygons.end());
      edges[0] += uses.polygons.size() == 1;
      edges[1] += distinct.size() > 2;
      edges[2] += distinct.size() <= 2 && (uses.directions[0] > 1 || uses.directions[1] > 1);
      if (distinct.size() > 2) non_manifold.insert(distinct.begin(), distinct.end());
    }
    for (const std::size_t i : non_manifold) set(4, i, true);
  }

  const Mesh& mesh_;
  std::vector<Polygon> polygons_;
};

// Few places make every defect common. All meshes are examined by a finder that has seen others.
TEST(MeshDefects, OfAnyMeshAreWhatTheOracleSays) {
  constexpr float kMax = std::numeric_limits<float>::max(), kTiny = std::numeric_limits<float>::denorm_min();
  const std::vector<std::vector<float>> values = {
      {0, 1, -0.0F}, {0, 1, 2, 3, -1}, {0, 1, 1.0001F, 1.0002F, 5}, {0, kTiny, -kTiny, 1, kMax, -kMax, 0.1F, 0.3F}};
  std::mt19937 rng(3);
  MeshDefectFinder finder;
  Counts seen{}, edges_seen{};
  int compared = 0;
  for (int round = 0; round < 3000; ++round) {
    const std::size_t which = rng() % values.size();
    const std::vector<float>& from = values[which];
    const bool flat = rng() % 4 == 0;
    std::vector<Point> vertices;
    for (std::size_t i = 0, n = 3 + rng() % 12; i < n; ++i) {
      const float x = from[rng() % from.size()], y = from[rng() % from.size()], z = from[rng() % from.size()];
      vertices.emplace_back(x, y, flat ? x : z);
    }
    std::vector<std::int32_t> corners;
    for (std::size_t i = 0, n = rng() % 8; i < n; ++i) {
      for (std::size_t k = 0, m = 1 + rng() % 6; k < m; ++k) {
        corners.push_back(static_cast<std::int32_t>(rng() % vertices.size()));
      }
      corners.push_back(-1);
      if (rng() % 4 > 0 || corners.size() > 100) continue;  // once more, rotated or reversed
      std::vector<std::int32_t> again(corners.begin(), corners.end() - 1);
      again.erase(again.begin(), std::find(again.rbegin(), again.rend(), -1).base());
      std::ranges::rotate(again, again.begin() + static_cast<std::ptrdiff_t>(rng() % again.size()));
      if (rng() % 2 == 0) std::ranges::reverse(again);
      corners.insert(corners.end(), again.begin(), again.end());
      corners.push_back(-1);
    }
    // The mesh has vertices that no polygon has, more than corners at times.
    vertices.resize(vertices.size() + rng() % 40, Point::Zero());
    const Mesh mesh = make_mesh(vertices, corners);
    const Oracle oracle(mesh);
    if (oracle.doubtful) continue;
    ++compared;
    MeshDefects found = finder.find(mesh);
    // Warped polygons are found in binary64, where sizes of 1e-45 and 1e38 don't meet.
    const auto warped = static_cast<std::size_t>(Defect::kWarped);
    if (which == 3)
      found.counts[warped] = {oracle.counts[warped], static_cast<std::uint32_t>(oracle.first[warped].value_or(0))};
    ASSERT_EQ(counts_of(found), oracle.counts) << "round " << round;
    ASSERT_EQ(edges_of(found), oracle.edges) << "round " << round;
    for (std::size_t i = 0; i < kDefects; ++i) {
      ASSERT_EQ(found.counts[i].first, oracle.first[i].value_or(0)) << "round " << round << ", defect " << i;
      seen[i] += oracle.counts[i];
      edges_seen[i] += oracle.edges[i];
    }
  }
  EXPECT_GT(compared, 2900);
  for (const std::uint64_t count : seen) EXPECT_GT(count, 500U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_GT(edges_seen[i], 500U);
}

// The polygons have many equal beginnings, all of one lowest corner, or are cycles that repeat themselves: the test is
// quick, unless a sort or a search for the least rotation is quadratic.
TEST(MeshDefects, OfManyPolygonsAroundACornerAreQuick) {
  std::vector<Point> vertices = {{0, 0, 0}};
  std::vector<std::int32_t> corners;
  const std::int32_t n = 50000;
  for (std::int32_t i = 1; i <= n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    vertices.emplace_back(static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a)), 0.0F);
    corners.insert(corners.end(), {0, i, i % n + 1, -1});
  }
  const MeshDefects fan = defects_of(vertices, corners);
  EXPECT_EQ(counts_of(fan), Counts{});
  EXPECT_EQ(edges_of(fan), Counts{50000});

  corners.clear();
  for (int twice = 0; twice < 2; ++twice) {
    for (int i = 0; i < 100000; ++i) corners.push_back(i % 1000 == 999 ? 2 : 1);
    corners.push_back(-1);
  }
  EXPECT_EQ(counts_of(defects_of(vertices, corners)), (Counts{2, 1}));
}

}  // namespace peerd::mesh_defects_test
