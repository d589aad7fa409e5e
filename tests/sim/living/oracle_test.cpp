// The oracle of living worlds by hand cases, and its parts against what is exact.
#include "tests/sim/living/oracle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "core/geometry/tessellate.hpp"
#include "core/geometry/triangulation.hpp"
#include "tests/oracle/distance_oracle.hpp"
#include "tests/oracle/triangle_cases.hpp"
#include "tests/sim/chance.hpp"
#include "tests/sim/living/forms.hpp"

namespace peerd::living::oracle_test {

using sim::testing_support::Chance;

void expect_holds(const Interval& interval, double value, double width) {
  EXPECT_LE(interval.lo, value);
  EXPECT_GE(interval.hi, value);
  EXPECT_LE(interval.hi - interval.lo, width);
}

TEST(Interval, HoldsWhatRoundingLoses) {
  const Interval third = Interval(1.0) / Interval(3.0);
  EXPECT_LT(third.lo * 3.0L, 1.0L);
  EXPECT_GT(third.hi * 3.0L, 1.0L);
  const Interval sum = Interval(1.0) + Interval(0x1p-60);
  EXPECT_LE(sum.lo, 1.0);
  EXPECT_GT(sum.hi, 1.0);
  expect_holds(Interval(-2.0, 1.0) * Interval(-3.0, 5.0), 6.0, 17.0);
  expect_holds(square_root(Interval(2.0)), std::numbers::sqrt2, 1e-15);
}
TEST(Interval, SinesAndCosinesAreNarrow) {
  for (double angle = -3.4; angle < 3.4; angle += 0.0173) {
    expect_holds(sine(Interval(angle)), std::sin(angle), 1e-13);
    expect_holds(cosine(Interval(angle)), std::cos(angle), 1e-13);
    const Interval s = sine(Interval(angle)), c = cosine(Interval(angle));
    expect_holds(s * s + c * c, 1.0, 1e-12);
    if (std::abs(angle) > 0.01 && std::abs(angle) < 1.57) expect_holds(arc_cosine(c), std::abs(angle), 1e-10);
  }
}

// A soup of one triangle whose corners are exact.
Soup soup_of(const oracle::Triangle& triangle) {
  std::vector<Point> points;
  for (const auto& p : triangle) points.push_back({p[0], p[1], p[2]});
  return Soup({{0, 1, 2}}, points);
}
TEST(Soup, HoldsTheExactDistanceOfTriangles) {
  Chance chance(7);
  int crossing = 0;
  for (int i = 0; i < 1000; ++i) {
    oracle::Triangle a, b;
    const double apart = chance.one_of({0.0, 0.5, 2.0}), fine = chance.one_of({1e-9, 0.25});
    for (oracle::Triangle* triangle : {&a, &b}) {
      for (auto& p : *triangle) {
        // On a grid now and then, so that edges are parallel and faces in one plane.
        for (double& x : p) x = std::round(chance.between(-1.0, 1.0) / fine) * fine;
      }
    }
    for (auto& p : b) p[0] += apart;
    const double exact = std::sqrt(oracle::squared_distance(a, b).get_d());
    const Soup of_a = soup_of(a), of_b = soup_of(b);
    Range range{1e9, 1e9};
    Soup::lower_distance(of_a, of_b, range);
    EXPECT_LE(range.lo, exact) << i;
    EXPECT_GE(range.hi, exact - 1e-15) << i;
    if (exact > 0.0) {
      EXPECT_LT(range.hi - range.lo, 1e-7) << i;
    }
    if (Soup::cross(of_a, of_b)) {
      ++crossing;
      EXPECT_EQ(exact, 0.0) << i;
    }
  }
  EXPECT_GT(crossing, 100);
}
TEST(Soup, OfManyTrianglesIsTheNearestPair) {
  Chance chance(8);
  for (int i = 0; i < 10; ++i) {
    std::vector<oracle::Triangle> all[2];
    std::vector<Point> points[2];
    std::vector<std::array<int, 3>> triangles[2];
    for (std::size_t side = 0; side < 2; ++side) {
      for (int t = 0; t < 20; ++t) {
        oracle::Triangle& triangle = all[side].emplace_back();
        const double x = chance.between(0.0, 2.0), y = chance.between(0.0, 2.0), z = side == 0 ? 0.0 : 0.7;
        const int first = int(points[side].size());
        triangles[side].push_back({first, first + 1, first + 2});
        for (auto& p : triangle) {
          p = {x + chance.between(-0.3, 0.3), y + chance.between(-0.3, 0.3), z + chance.between(-0.3, 0.3)};
          points[side].push_back({p[0], p[1], p[2]});
        }
      }
    }
    mpq_class least = oracle::squared_distance(all[0][0], all[1][0]);
    for (const auto& a : all[0]) {
      for (const auto& b : all[1]) least = std::min<mpq_class>(least, oracle::squared_distance(a, b));
    }
    Range range{1e9, 1e9};
    Soup::lower_distance(Soup(triangles[0], points[0]), Soup(triangles[1], points[1]), range);
    const double exact = std::sqrt(least.get_d());
    EXPECT_LE(range.lo, exact);
    EXPECT_GE(range.hi, exact - 1e-15);
    EXPECT_LT(range.hi - range.lo, 1e-7);
  }
}

// The oracle cuts curved forms by formulas of its own; they are the project's polygons, to the last bit of a binary32.
TEST(OracleMotion, CutsFormsAsTheProjectDoes) {
  struct Case {
    Form form;
    Geometry geometry;
  };
  const std::vector<Case> cases{
      {{.kind = FormKind::kBox, .size = {0.7F, 1.3F, 0.2F}}, BoxGeometry{{0.7F, 1.3F, 0.2F}}},
      {{.kind = FormKind::kCone, .size = {0.37F, 1.1F, 0}}, ConeGeometry{0.37F, 1.1F}},
      {{.kind = FormKind::kCylinder, .size = {0.41F, 0.9F, 0}}, CylinderGeometry{0.41F, 0.9F}},
      {{.kind = FormKind::kSphere, .size = {0.33F, 0, 0}}, SphereGeometry{0.33F}}};
  for (const auto& [form, geometry] : cases) {
    World world{.duration_s = 1.0};
    world.forms.push_back(form);
    const OracleMotion motion(world);
    const Mesh mesh = build_mesh(geometry, {});
    std::vector<Three> ours, theirs(mesh.vertices.size());
    for (const Point& p : motion.points(0, 0.0, 0.5)) ours.push_back({float(p[0].lo), float(p[1].lo), float(p[2].lo)});
    for (std::size_t i = 0; i < theirs.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) theirs[i][k] = mesh.vertices[i][Eigen::Index(k)];
    }
    ASSERT_EQ(ours.size(), theirs.size());
    // The nearest of the other's vertices, and triangles by such places of their corners, in any order.
    std::vector<int> place_of_theirs;
    for (const Three& p : theirs) {
      int found = -1;
      for (int i = 0; i < int(ours.size()); ++i) {
        const Three& q = ours[std::size_t(i)];
        const float off = std::max({std::abs(p[0] - q[0]), std::abs(p[1] - q[1]), std::abs(p[2] - q[2])});
        if (off < 1e-7F) found = i;
      }
      ASSERT_GE(found, 0);
      place_of_theirs.push_back(found);
    }
    EXPECT_EQ(std::set<int>(place_of_theirs.begin(), place_of_theirs.end()).size(), ours.size());
    // All our triangles lie in their polygons: a triangle's corners are corners of one polygon.
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < mesh.polygon_count(); ++i) {
      triangles += triangle_count(mesh.polygon(i).size());
      std::set<int> corners;
      for (const std::int32_t c : mesh.polygon(i)) corners.insert(place_of_theirs[std::size_t(c)]);
      const auto holds = [&](const auto& t) {
        return corners.contains(t[0]) && corners.contains(t[1]) && corners.contains(t[2]);
      };
      EXPECT_EQ(std::size_t(std::ranges::count_if(motion.triangles(0), holds)), triangle_count(mesh.polygon(i).size()));
    }
    EXPECT_EQ(motion.triangles(0).size(), triangles);
  }
}

// Worlds by hand

int add_node(World& world, Node node) {
  world.nodes.push_back(std::move(node));
  return int(world.nodes.size()) - 1;
}
int add_box(World& world, int parent, const Three& size) {
  world.forms.push_back({.kind = FormKind::kBox, .size = size});
  return add_node(world, {.kind = NodeKind::kShape, .parent = parent, .form = int(world.forms.size()) - 1});
}
Node transform(int parent = -1) { return {.kind = NodeKind::kTransform, .parent = parent}; }

Point at(const World& world, int node, double t_s, double within_s, const Three& p = {}) {
  const OracleMotion motion(world);
  return times(motion.parent_from_local(node, t_s, within_s), Point{double(p[0]), double(p[1]), double(p[2])});
}
void expect_at(const Point& p, double x, double y, double z) {
  expect_holds(p[0], x, 1e-13);
  expect_holds(p[1], y, 1e-13);
  expect_holds(p[2], z, 1e-13);
}

TEST(OracleMotion, ClocksStartStopAndGoAround) {
  World world{.duration_s = 10.0};
  world.clocks = {{.cycle_s = 2.0, .start_s = 1.0},
                  {.cycle_s = 2.0, .start_s = 1.0, .stop_s = 4.5},
                  {.cycle_s = 2.0, .start_s = 1.0, .loop = false}};
  for (int clock = 0; clock < 3; ++clock) {
    Node node = transform();
    node.translation = {9, 0, 0};
    node.translations = {clock, {0.0F, 0.5F, 0.5F, 1.0F}, {{0, 0, 0}, {4, 0, 0}, {8, 0, 0}, {6, 0, 0}}};
    add_node(world, node);
    const auto x = [&](double t_s, double within_s) { return at(world, clock, t_s, within_s)[0].mid(); };
    EXPECT_DOUBLE_EQ(x(0.5, 0.5), 9.0);  // as the file has it
    EXPECT_DOUBLE_EQ(x(1.5, 1.5), 2.0);
    EXPECT_DOUBLE_EQ(x(2.0, 1.9), 4.0);  // it jumps
    EXPECT_DOUBLE_EQ(x(2.0, 2.1), 8.0);
    EXPECT_DOUBLE_EQ(x(3.0, 2.9), 6.0);
    EXPECT_DOUBLE_EQ(x(3.0, 3.1), clock == 2 ? 6.0 : 0.0);  // the next cycle, or none
    EXPECT_DOUBLE_EQ(x(4.25, 4.25), clock == 2 ? 6.0 : 7.5);
    EXPECT_NEAR(x(7.0, 7.1), clock == 0 ? 0.0 : clock == 1 ? 7.0 : 6.0, 1e-12);  // around, stopped at 4.5 s, at the end
  }
}
TEST(OracleMotion, TurnsTheShorterWayAboutTheCenter) {
  World world{.duration_s = 10.0};
  world.clocks = {{.cycle_s = 1.0}};
  Node node = transform();
  node.translation = {0, 5, 0};
  node.center = {1, 0, 0};
  const float quarter = std::numbers::pi_v<float> / 2;
  // The second value is a quarter to the right, said as three to the left about an axis that is not unit.
  node.rotations = {0, {0.0F, 1.0F}, {{0, 1, 0, 0}, {0, 0, 2, 3 * quarter}}};
  add_node(world, node);
  const double eighth = -std::numbers::pi / 4;
  const Point p = at(world, 0, 0.5, 0.5, {3, 0, 0});
  EXPECT_NEAR(p[0].mid(), 1.0 + 2.0 * std::cos(eighth), 1e-7);  // the angle is a binary32
  EXPECT_NEAR(p[1].mid(), 5.0 + 2.0 * std::sin(eighth), 1e-7);
  EXPECT_LT(p[0].radius(), 1e-12);
  const OracleMotion motion(world);
  const auto bound = motion.bound(0, {.radius_m = 3.0, .speed_m_s = 0.5}, 0.5);
  EXPECT_GE(bound.speed_m_s, 2.0 * std::numbers::pi / 2 + 0.5);
  EXPECT_LT(bound.speed_m_s, 4.0 * std::numbers::pi / 2 + 0.6);  // the arm is taken for 3 + 1 m
}
TEST(OracleMotion, StretchesAlongTurnedAxes) {
  World world{.duration_s = 1.0};
  Node node = transform();
  const float quarter = std::numbers::pi_v<float> / 2;
  node.scale = {3, 1, 1};
  node.scale_orientation = {0, 0, 1, quarter};  // so y is stretched
  add_node(world, node);
  const Point p = at(world, 0, 0.5, 0.5, {1, 1, 1});
  EXPECT_NEAR(p[0].mid(), 1.0, 1e-6);
  EXPECT_NEAR(p[1].mid(), 3.0, 1e-6);
  expect_at(at(world, 0, 0.5, 0.5, {0, 0, -2}), 0.0, 0.0, -2.0);
}

// Boxes of 1 m: one moves by 1 m/s, and its face is at that of the other at 4 s.
World meeting() {
  World world{.duration_s = 10.0};
  const int standing = add_node(world, transform());
  add_box(world, standing, {1, 1, 1});
  Node mover = transform();
  mover.translation = {-5, 0.25F, 0.125F};  // no edge lies in a plane of the other
  mover.velocity = {1, 0, 0};
  const int moving = add_node(world, mover);
  add_box(world, moving, {1, 1, 1});
  return world;
}
struct Asked {
  const char* name;
  double since_s, t_s;
  bool early, late, touched_before;
};
class Report : public testing::TestWithParam<Asked> {};
TEST_P(Report, IsJudged) {
  const auto& [name, since_s, t_s, early, late, touched_before] = GetParam();
  const World world = meeting();
  const OracleMotion motion(world);
  ContactOracle oracle(motion, world, 2, 0, InterestType::kWitness);
  const auto verdict = oracle.judge(since_s, t_s);
  EXPECT_TRUE(verdict.complete);
  EXPECT_EQ(verdict.is_early(), early);
  EXPECT_EQ(verdict.is_late(), late);
  EXPECT_EQ(verdict.earlier_touch_s.has_value(), touched_before);
  EXPECT_LT(verdict.unproven_s, 1e-4);
}
INSTANTIATE_TEST_SUITE_P(Table, Report,
                         testing::Values(Asked{"Exact", 0.0, 4.0, false, false, false},
                                         Asked{"ALittleEarly", 0.0, 4.0 - 2.1e-5, false, false, false},
                                         Asked{"TooEarly", 0.0, 4.0 - 3e-5, true, false, false},
                                         Asked{"FarTooEarly", 0.0, 3.0, true, false, false},
                                         Asked{"WithinRounding", 0.0, 4.0 + 5e-7, false, false, false},
                                         Asked{"ALittleLate", 0.0, 4.0 + 5e-5, false, true, true},
                                         Asked{"Late", 0.0, 4.5, false, true, true},
                                         // From 4 to 6 s their surfaces cross, for the one is higher.
                                         Asked{"ShortlyBeforeTheEnd", 0.0, 5.9, false, true, true},
                                         Asked{"AfterTheEnd", 0.0, 6.1, true, false, true},
                                         Asked{"SinceTheEnd", 6.01, 9.0, true, false, false}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST(ContactOracle, ComesOutLateByWhatItIs) {
  const World world = meeting();
  const OracleMotion motion(world);
  ContactOracle oracle(motion, world, 0, 2, InterestType::kAllPairs);
  const auto verdict = oracle.judge(0.0, 4.5);
  EXPECT_GT(verdict.late_s, 0.25);  // doubled from an instant on
  EXPECT_LE(verdict.late_s, 0.5);
  EXPECT_NEAR(verdict.earlier_touch_s.value(), 4.0, 1e-4);
  expect_holds({oracle.distance_m(2.0).lo, oracle.distance_m(2.0).hi}, 2.0, 1e-5);
}
// A turned cube's box is wider than the cube.
TEST(ContactOracle, ComparesBoxesOfVertices) {
  World world = meeting();
  world.nodes[0].rotation = {0, 0, 1, std::numbers::pi_v<float> / 4};
  world.nodes[2].translation[1] = 1.0F;
  const OracleMotion motion(world);
  ContactOracle boxes(motion, world, 2, 0, InterestType::kBox), polygons(motion, world, 2, 0, InterestType::kWitness);
  const double half = std::sqrt(0.5), boxes_at_s = 4.5 - half;
  EXPECT_FALSE(boxes.touches(boxes_at_s - 1e-4));
  EXPECT_TRUE(boxes.touches(boxes_at_s + 1e-4));
  EXPECT_NEAR(boxes.distance_m(boxes_at_s - 0.5).lo, 0.5, 1e-5);
  const auto verdict = boxes.judge(0.0, boxes_at_s);
  EXPECT_FALSE(verdict.is_early() || verdict.is_late() || verdict.earlier_touch_s);
  // The cube's corner passes below the other, which meets its side half a metre up, and half a metre later.
  EXPECT_FALSE(polygons.touches(boxes_at_s + 0.4999));
  EXPECT_TRUE(polygons.touches(boxes_at_s + 0.5001));
}
// What both go by changes nothing, and costs nothing: common motion is left out.
TEST(ContactOracle, LooksAtWhatMovesThemApart) {
  World world = meeting();
  world.clocks = {{.cycle_s = 1.0}};
  Node carrier = transform();
  carrier.translations = {0, {0.0F, 0.5F, 1.0F}, {{0, 0, 0}, {4, 4, 0}, {0, 0, 0}}};
  World carried{.duration_s = world.duration_s, .clocks = world.clocks, .forms = world.forms};
  add_node(carried, carrier);
  for (Node node : world.nodes) {
    node.parent += 1;
    add_node(carried, node);
  }
  const OracleMotion motion(carried);
  ContactOracle oracle(motion, carried, 3, 1, InterestType::kWitness);
  const auto verdict = oracle.judge(0.0, 4.0);
  EXPECT_FALSE(verdict.is_early() || verdict.is_late() || verdict.earlier_touch_s);
  EXPECT_LT(verdict.placements, 100u);
  EXPECT_TRUE(oracle.judge(0.0, 4.0001).is_late());
}
// A part against what it is a part of, which holds it too.
TEST(ContactOracle, DoesNotLetAShapeTouchItself) {
  World world{.duration_s = 10.0};
  const int whole = add_node(world, transform());
  add_box(world, whole, {1, 1, 1});
  Node part = transform(whole);
  part.translation = {-5, 0.25F, 0.125F};
  part.velocity = {1, 0, 0};
  const int below = add_node(world, part);
  add_box(world, below, {1, 1, 1});
  const OracleMotion motion(world);
  for (const auto& [a, b] : {std::pair{whole, below}, std::pair{below, whole}}) {
    ContactOracle oracle(motion, world, a, b, InterestType::kWitness);
    EXPECT_FALSE(oracle.touches(3.9));
    EXPECT_TRUE(oracle.touches(4.1));
    EXPECT_NEAR(oracle.distance_m(3.0).lo, 1.0, 1e-5);
  }
}
// At the very time of a jump, both sides of it count.
TEST(ContactOracle, KnowsBothSidesOfAJump) {
  World world = meeting();
  world.clocks = {{.cycle_s = 4.0}};
  world.nodes[2].velocity = {};
  world.nodes[2].translations = {
      0, {0.0F, 0.5F, 0.5F, 1.0F}, {{-5, 0, 0}, {-5, 0, 0}, {0.75F, 0.5F, 0}, {0.75F, 0.5F, 0}}};
  const OracleMotion motion(world);
  ContactOracle oracle(motion, world, 0, 2, InterestType::kWitness);
  EXPECT_FALSE(oracle.touches(1.9999));
  EXPECT_TRUE(oracle.touches(2.0));
  const auto verdict = oracle.judge(0.0, 2.0);
  EXPECT_FALSE(verdict.is_early() || verdict.is_late() || verdict.earlier_touch_s);
  EXPECT_EQ(verdict.unproven_s, 0.0);
  EXPECT_TRUE(oracle.judge(0.0, 2.001).is_late());
  EXPECT_TRUE(oracle.judge(0.0, 1.999).is_early());
}
// Vertices that bend are asked where they are.
TEST(ContactOracle, FollowsWhatBends) {
  World world{.duration_s = 4.0};
  world.clocks = {{.cycle_s = 4.0}};
  const int standing = add_node(world, transform());
  add_box(world, standing, {1, 1, 1});
  Form thorn{.kind = FormKind::kFaces, .points = {{-2, 3, -0.5F}, {0, 3, 0}, {-2, 3, 0.5F}}};
  thorn.polygons = {{0, 1, 2}};
  thorn.triangles = {{0, 1, 2}};
  // Its tip goes down from 3 m to -1 m in 4 s, and is at 0.5 m, the box's top, at 2.5 s.
  thorn.bend = {0, {0.0F, 1.0F}, {thorn.points, {{-2, 3, -0.5F}, {0, -1, 0}, {-2, 3, 0.5F}}}};
  world.forms.push_back(thorn);
  const int shape = add_node(world, {.kind = NodeKind::kShape, .form = 1});
  const OracleMotion motion(world);
  ContactOracle oracle(motion, world, shape, standing, InterestType::kAllPairs);
  const auto verdict = oracle.judge(0.0, 2.5);
  EXPECT_FALSE(verdict.is_early() || verdict.is_late() || verdict.earlier_touch_s);
  EXPECT_TRUE(oracle.judge(0.0, 2.501).is_late());
  EXPECT_TRUE(oracle.judge(0.0, 2.499).is_early());
}

}  // namespace peerd::living::oracle_test
