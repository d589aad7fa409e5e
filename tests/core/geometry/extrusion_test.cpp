#include "core/geometry/extrusion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/geometry/tessellate.hpp"
#include "tests/core/mesh_checks.hpp"

namespace peerd::extrusion_test {

using Spine = std::vector<Eigen::Vector3f>;
using Section = std::vector<std::array<float, 2>>;
using Orientations = std::vector<std::array<float, 4>>;
constexpr float kHalfTurn = std::numbers::pi_v<float>, kQuarterTurn = kHalfTurn / 2;

const Section kSquare = {{1, 1}, {1, -1}, {-1, -1}, {-1, 1}, {1, 1}};  // the field's default, and closed
const Section kAxes = {{1, 0}, {0, 1}};                                // its rings are spine + x axis, spine + z axis

ExtrusionGeometry extrude(Section section, Spine spine) {
  ExtrusionGeometry e;
  e.cross_section = std::move(section);
  e.spine = std::move(spine);
  return e;
}

// The x and z axes of each spine-aligned cross-section plane, off the mesh.
struct Axes {
  Vec3 x, z;
};
std::vector<Axes> axes(const Spine& spine) {
  ExtrusionGeometry e = extrude(kAxes, spine);
  Orientations none(spine.size(), {0, 0, 1, 0});
  none.back() = {0, 1, 0, 0};  // another one that does nothing keeps a closed spine's last ring apart
  e.orientation = std::move(none);
  const Mesh mesh = build_mesh(e);
  EXPECT_EQ(mesh.vertices.size(), 2 * spine.size());
  std::vector<Axes> result;
  for (std::size_t i = 0; i < spine.size(); ++i) {
    result.push_back(
        {(mesh.vertices[2 * i] - spine[i]).cast<double>(), (mesh.vertices[2 * i + 1] - spine[i]).cast<double>()});
  }
  return result;
}

// 6.18.1, 6.18.4: the default is a box of 2 x 1 x 2. "One quadrilateral has the points: spine[0](crossSection[0],
// crossSection[1]) spine[1](crossSection[1], crossSection[0])". "A beginCap with a counterclockwise ordering shall have
// a normal along the negative Y-axis."
TEST(Extrusion, DefaultIsABox) {
  const Mesh mesh = build_mesh(extrude(kSquare, {{0, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(points_of(mesh),
            (Points{{1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, {-1, 0, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}, {-1, 1, 1}}));
  EXPECT_EQ(polygons_of(mesh),
            (Polygons{{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {0, 3, 2, 1}, {4, 5, 6, 7}}));
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_EQ(signed_volume(mesh), 4.0);
}

TEST(Extrusion, CapsCloseAnOpenCrossSection) {
  const ExtrusionGeometry e = extrude({{1, 1}, {1, -1}, {-1, -1}, {-1, 1}}, {{0, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(polygons_of(build_mesh(e)),
            (Polygons{{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {0, 3, 2, 1}, {4, 5, 6, 7}}));
}

TEST(Extrusion, HasOnlyTheCapsAskedFor) {
  ExtrusionGeometry e = extrude(kSquare, {{0, 0, 0}, {0, 1, 0}});
  e.begin_cap = false;
  EXPECT_EQ(polygons_of(build_mesh(e)).back(), (std::vector<std::int32_t>{4, 5, 6, 7}));
  e.end_cap = false;
  EXPECT_EQ(build_mesh(e).polygon_count(), 4U);
  e.begin_cap = true;
  EXPECT_EQ(polygons_of(build_mesh(e)).back(), (std::vector<std::int32_t>{0, 3, 2, 1}));
}

struct ScpCase {
  const char* name;
  Spine spine;
  std::vector<Axes> axes;
};
const double kHalf = std::sqrt(0.5);
class SpineAlignedPlane : public testing::TestWithParam<ScpCase> {};
TEST_P(SpineAlignedPlane, HasTheAxesOfTheStandard) {
  const std::vector<Axes> found = axes(GetParam().spine);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_LT((found[i].x - GetParam().axes[i].x).norm(), 1e-6) << i << ": " << found[i].x.transpose();
    EXPECT_LT((found[i].z - GetParam().axes[i].z).norm(), 1e-6) << i << ": " << found[i].z.transpose();
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, SpineAlignedPlane,
    testing::Values(
        // 6.18.3: "If the entire spine is collinear, the SCP is computed by finding the rotation of a vector along the
        // positive Y-axis (v1) to the vector formed by the spine points (v2)."
        ScpCase{"StraightUp", {{0, 0, 0}, {0, 2, 0}}, {{{1, 0, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}}}},
        ScpCase{"StraightAlongX", {{0, 0, 0}, {3, 0, 0}}, {{{0, -1, 0}, {0, 0, 1}}, {{0, -1, 0}, {0, 0, 1}}}},
        ScpCase{"StraightAlongMinusX", {{0, 0, 0}, {-3, 0, 0}}, {{{0, 1, 0}, {0, 0, 1}}, {{0, 1, 0}, {0, 0, 1}}}},
        ScpCase{"StraightAlongZ", {{0, 0, 0}, {0, 0, 1}}, {{{1, 0, 0}, {0, -1, 0}}, {{1, 0, 0}, {0, -1, 0}}}},
        ScpCase{"StraightAlongMinusZ", {{0, 0, 0}, {0, 0, -1}}, {{{1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 1, 0}}}},
        ScpCase{"StraightDiagonal",
                {{0, 0, 0}, {1, 1, 0}},
                {{{kHalf, -kHalf, 0}, {0, 0, 1}}, {{kHalf, -kHalf, 0}, {0, 0, 1}}}},
        ScpCase{"StraightDiagonalDown",
                {{0, 0, 0}, {1, -1, 0}},
                {{{-kHalf, -kHalf, 0}, {0, 0, 1}}, {{-kHalf, -kHalf, 0}, {0, 0, 1}}}},
        ScpCase{"StraightDown", {{0, 2, 0}, {0, 0, 0}}, {{{-1, 0, 0}, {0, 0, 1}}, {{-1, 0, 0}, {0, 0, 1}}}},
        ScpCase{"StraightAlmostDown", {{0, 2, 0}, {1e-9F, 0, 0}}, {{{-1, 0, 0}, {0, 0, 1}}, {{-1, 0, 0}, {0, 0, 1}}}},
        ScpCase{"ThereAndBackIsStraight",
                {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}},
                {{{0, -1, 0}, {0, 0, 1}}, {{0, -1, 0}, {0, 0, 1}}, {{0, -1, 0}, {0, 0, 1}}}},
        ScpCase{"AllPointsOne", {{1, 2, 3}, {1, 2, 3}}, {{{1, 0, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}}}},
        // The standard has y = spine[i+1] - spine[i-1]; z = (spine[i+1] - spine[i]) x (spine[i-1] - spine[i]); the ends
        // take the z of their neighbour and the y of their own segment; x = y x z.
        ScpCase{"Bend",
                {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                {{{-1, 0, 0}, {0, 0, -1}}, {{-kHalf, kHalf, 0}, {0, 0, -1}}, {{0, 1, 0}, {0, 0, -1}}}},
        // The third's z would be +z: its product with the second's is negative, so it's flipped.
        ScpCase{"SCurveIsFlipped",
                {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 2, 0}},
                {{{-1, 0, 0}, {0, 0, -1}},
                 {{-kHalf, kHalf, 0}, {0, 0, -1}},
                 {{-kHalf, kHalf, 0}, {0, 0, -1}},
                 {{-1, 0, 0}, {0, 0, -1}}}},
        // The standard says: "If the Z-axis of the first point is undefined (because the spine is not closed and the
        // first two spine segments are collinear) then the Z-axis for the first spine point with a defined Z-axis is
        // used."
        ScpCase{"FirstTwoSegmentsCollinear",
                {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {1, 2, 0}},
                {{{-1, 0, 0}, {0, 0, -1}},
                 {{-1, 0, 0}, {0, 0, -1}},
                 {{-kHalf, kHalf, 0}, {0, 0, -1}},
                 {{0, 1, 0}, {0, 0, -1}}}},
        // The standard says: "If the three points .. are collinear, .. the value from the previous point is used
        // instead."
        ScpCase{"LastSegmentsCollinear",
                {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}},
                {{{-1, 0, 0}, {0, 0, -1}},
                 {{-kHalf, kHalf, 0}, {0, 0, -1}},
                 {{0, 1, 0}, {0, 0, -1}},
                 {{0, 1, 0}, {0, 0, -1}}}},
        // The standard says: "If two points are coincident, they both have the same SCP."
        ScpCase{"CoincidentAtTheBend",
                {{0, 0, 0}, {0, 1, 0}, {0, 1, 0}, {1, 1, 0}},
                {{{-1, 0, 0}, {0, 0, -1}},
                 {{-kHalf, kHalf, 0}, {0, 0, -1}},
                 {{-kHalf, kHalf, 0}, {0, 0, -1}},
                 {{0, 1, 0}, {0, 0, -1}}}},
        ScpCase{"CoincidentAtTheEnds",
                {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}},
                {{{0, -1, 0}, {0, 0, 1}}, {{0, -1, 0}, {0, 0, 1}}, {{0, -1, 0}, {0, 0, 1}}, {{0, -1, 0}, {0, 0, 1}}}},
        // Closed: first and last have y = spine[1] - spine[n-2], z = (spine[1] - spine[0]) x (spine[n-2] - spine[0]).
        ScpCase{"ClosedSquare",
                {{1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}},
                {{{kHalf, 0, kHalf}, {0, 1, 0}},
                 {{kHalf, 0, -kHalf}, {0, 1, 0}},
                 {{-kHalf, 0, -kHalf}, {0, 1, 0}},
                 {{-kHalf, 0, kHalf}, {0, 1, 0}},
                 {{kHalf, 0, kHalf}, {0, 1, 0}}}},
        // The spine goes from (1, 1, 0) straight back to where it was: y is that of the previous point, (1, 1, 0) /
        // sqrt 2.
        ScpCase{"StraightBack",
                {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 1, 0}},
                {{{-1, 0, 0}, {0, 0, -1}},
                 {{-kHalf, kHalf, 0}, {0, 0, -1}},
                 {{-kHalf, kHalf, 0}, {0, 0, -1}},
                 {{0, -1, 0}, {0, 0, -1}}}}),
    [](const auto& test) { return std::string(test.param.name); });

// 6.18.3: "If the spine curve is closed: The SCP for the first and last points is the same", however often the z axis
// is flipped on the way around.
TEST(Extrusion, ClosedSpineEndsInItsFirstPlane) {
  std::mt19937 rng(1);
  for (int round = 0; round < 200; ++round) {
    Spine spine(4 + rng() % 4);
    for (Eigen::Vector3f& p : spine) {
      for (float& x : p) x = static_cast<float>(rng() % 5);
    }
    spine.push_back(spine.front());
    const std::vector<Axes> found = axes(spine);
    EXPECT_EQ(found.front().x, found.back().x);
    EXPECT_EQ(found.front().z, found.back().z);
    for (const Axes& a : found) {
      EXPECT_NEAR(a.x.norm(), 1, 1e-6);
      EXPECT_NEAR(a.z.norm(), 1, 1e-6);
      EXPECT_NEAR(a.x.dot(a.z), 0, 2e-6);
    }
  }
}

// The bound is no epsilon, but the distance that rounding the decimals of the file can have moved the points.
TEST(Extrusion, CollinearIsToWithinTheRoundingOfTheFile) {
  // 0.1F, 0.3F and 0.7F aren't multiples of each other, but on x = y = z these points are.
  const Spine straight = {{0, 0, 0}, {0.1F, 0.1F, 0.1F}, {0.3F, 0.3F, 0.3F}, {0.7F, 0.7F, 0.7F}};
  Spine rounded = straight, bent = straight;
  rounded[2].x() = std::nextafter(rounded[2].x(), 1.0F);
  bent[2].x() += 1e-5F;
  // The straight one's z axis: +z turned by the rotation that takes +y to (1, 1, 1) / sqrt 3.
  const Vec3 expected(-0.2113249, -0.5773503, 0.7886751);
  EXPECT_LT((axes(straight)[1].z - expected).norm(), 1e-6);
  EXPECT_LT((axes(rounded)[1].z - expected).norm(), 1e-6);
  // The bent one's is square to x = y = z and to the way in which the third point left it.
  const Vec3 z = axes(bent)[1].z;
  EXPECT_LT(std::abs(z.dot(Vec3(1, 1, 1))), 1e-4);
  EXPECT_LT(std::abs(z.x()), 1e-2);
}

// Straight as written, in decimals that binary32 doesn't have: no ring stands turned against another.
TEST(Extrusion, StraightDecimalsStayStraight) {
  for (const Vec3& step : {Vec3(0.1, 0.2, 0.3), Vec3(0.7, -0.1, 0.3), Vec3(-1.1, 0.9, 0.1)}) {
    Spine spine;
    for (int i = 0; i < 12; ++i) spine.push_back((0.1 * std::round(10.0 * i) * step).cast<float>());
    for (const auto& ring : axes(spine)) EXPECT_LT((ring.z - axes(spine)[0].z).norm(), 1e-6);
  }
}

// The spine bends so gently that no three points in a row differ from a line by more than rounding makes.
TEST(Extrusion, TakesABendThatOnlyTheWholeShows) {
  Spine spine;
  for (int i = 0; i <= 2000; ++i) {
    const float t = 1e-3F * static_cast<float>(i);
    spine.push_back({1000.0F + t * t * 1e-3F, 1000.0F + t, 0});
  }
  for (const auto& ring : axes(spine)) EXPECT_NEAR(ring.z.norm(), 1.0, 1e-5);
}

// 6.18.2: scaled in the y = 0 plane, then turned relative to the cross-section plane, then into the plane.
TEST(Extrusion, ScalesThenTurnsThenAligns) {
  ExtrusionGeometry e = extrude({{1, 0}, {0, 1}}, {{5, 0, 0}, {5, 1, 0}});
  e.scale = Section{{2, 3}};
  e.orientation = Orientations{{0, 10, 0, kQuarterTurn}};  // +x to -z, +z to +x; the axis is made a unit
  const Mesh up = build_mesh(e);
  EXPECT_LT((up.vertices[0] - Eigen::Vector3f(5, 0, -2)).norm(), 1e-6F);
  EXPECT_LT((up.vertices[1] - Eigen::Vector3f(8, 0, 0)).norm(), 1e-6F);

  e.spine = Spine{{0, 0, 0}, {1, 0, 0}};  // x axis -y, z axis +z
  const Mesh along_x = build_mesh(e);
  EXPECT_LT((along_x.vertices[0] - Eigen::Vector3f(0, 0, -2)).norm(), 1e-6F);
  EXPECT_LT((along_x.vertices[1] - Eigen::Vector3f(0, -3, 0)).norm(), 1e-6F);

  e.orientation = Orientations{{1, 0, 0, kQuarterTurn}};  // about the plane's x axis: +z to -y, which is -x here
  EXPECT_LT((build_mesh(e).vertices[1] - Eigen::Vector3f(-3, 0, 0)).norm(), 1e-6F);
}

TEST(Extrusion, EachSpinePointHasItsScaleAndOrientation) {
  ExtrusionGeometry e = extrude({{1, 0}, {0, 1}}, {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}});
  e.scale = Section{{1, 1}, {2, 1}, {3, 1}, {9, 9}};  // 6.18: "the excess values are ignored"
  e.orientation = Orientations{{0, 1, 0, 0}, {0, 1, 0, 0}, {0, 1, 0, kHalfTurn}, {0, 1, 0, 1}};
  const Mesh mesh = build_mesh(e);
  ASSERT_EQ(mesh.vertices.size(), 6U);
  EXPECT_EQ(mesh.vertices[0], Eigen::Vector3f(1, 0, 0));
  EXPECT_EQ(mesh.vertices[2], Eigen::Vector3f(2, 1, 0));
  EXPECT_LT((mesh.vertices[4] - Eigen::Vector3f(-3, 2, 0)).norm(), 1e-6F);
}

// 6.18.3: coincident points with different orientations are "useful in creating revolved surfaces".
TEST(Extrusion, RevolvesAboutOnePoint) {
  ExtrusionGeometry e = extrude({{1, 0}, {2, 0}}, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  e.orientation = Orientations{{0, 0, 1, 0}, {0, 0, 1, kQuarterTurn}, {0, 0, 1, kHalfTurn}};
  const Mesh mesh = build_mesh(e);
  ASSERT_EQ(mesh.vertices.size(), 6U);
  EXPECT_LT((mesh.vertices[3] - Eigen::Vector3f(0, 2, 0)).norm(), 1e-6F);
  EXPECT_LT((mesh.vertices[5] - Eigen::Vector3f(-2, 0, 0)).norm(), 1e-6F);
  EXPECT_EQ(mesh.polygon_count(), 2U);
}

Spine circle(std::size_t n) {  // closed, counter-clockwise seen from above
  Spine spine;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    spine.emplace_back(static_cast<float>(3 * std::sin(angle)), 0.0F, static_cast<float>(3 * std::cos(angle)));
  }
  spine.push_back(spine.front());
  return spine;
}

TEST(Extrusion, ClosedSpineSharesItsFirstRing) {
  ExtrusionGeometry e = extrude({{0.5F, 0.5F}, {0.5F, -0.5F}, {-0.5F, -0.5F}, {-0.5F, 0.5F}, {0.5F, 0.5F}}, circle(64));
  e.begin_cap = e.end_cap = false;
  const Mesh mesh = build_mesh(e);
  EXPECT_EQ(mesh.vertices.size(), 64U * 4U);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(signed_volume(mesh), 2 * std::numbers::pi * 3, 0.1);  // Pappus
  EXPECT_GT(signed_volume(mesh), 0.0);

  // The last ring is not the first where there is a twist.
  e.orientation = [] {
    Orientations twist(65, {0, 1, 0, 0});
    twist.back()[3] = kQuarterTurn;
    return twist;
  }();
  EXPECT_EQ(build_mesh(e).vertices.size(), 65U * 4U);
  // 6.18.4: caps are generated "even if spine is also a closed curve".
  e.begin_cap = e.end_cap = true;
  EXPECT_EQ(build_mesh(e).polygon_count(), 64U * 4U + 2U);
}

TEST(Extrusion, BentTubeIsClosedAndOutward) {
  const ExtrusionGeometry e = extrude(kSquare, {{0, 0, 0}, {0, 10, 0}, {10, 20, 0}, {20, 20, 5}, {30, 20, 30}});
  const Mesh mesh = build_mesh(e);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_TRUE(uses_all_vertices(mesh));
  EXPECT_GT(signed_volume(mesh), 0.0);
}

TEST(Extrusion, RoundColumnTendsToACylinder) {
  for (const std::size_t n : {8U, 64U}) {
    Section section;
    for (const Eigen::Vector3f& p : circle(n)) section.push_back({p.x(), p.z()});
    const Mesh mesh = build_mesh(extrude(section, {{1, 2, 3}, {4, 6, 3}}));  // 5 long
    const double slices = static_cast<double>(n);
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_NEAR(signed_volume(mesh), 5 * 9 * slices / 2 * std::sin(2 * std::numbers::pi / slices), 1e-4);
  }
}

struct SizeCase {
  const char* name;
  Section section;
  Spine spine;
  std::size_t vertices, polygons;
};
class ExtrusionSize : public testing::TestWithParam<SizeCase> {};
TEST_P(ExtrusionSize, IsThatOfItsMesh) {
  const auto& [name, section, spine, vertices, polygons] = GetParam();
  const ExtrusionGeometry e = extrude(section, spine);
  const Mesh mesh = build_mesh(e);
  EXPECT_EQ(mesh.vertices.size(), vertices);
  EXPECT_EQ(mesh.polygon_count(), polygons);
  EXPECT_EQ(mesh_size(e), counted(mesh));
  EXPECT_TRUE(uses_all_vertices(mesh));
}
INSTANTIATE_TEST_SUITE_P(
    Table, ExtrusionSize,
    testing::Values(SizeCase{"Nothing", {}, {}, 0, 0}, SizeCase{"NoSpine", kSquare, {}, 0, 0},
                    SizeCase{"OneSpinePoint", kSquare, {{0, 0, 0}}, 0, 0},
                    SizeCase{"NoCrossSection", {}, {{0, 0, 0}, {0, 1, 0}}, 0, 0},
                    SizeCase{"OneCrossSectionPoint", {{1, 1}}, {{0, 0, 0}, {0, 1, 0}}, 0, 0},
                    SizeCase{"RibbonHasNoCaps", kAxes, {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}, 6, 2},
                    SizeCase{"ClosedRibbonHasNoCaps", {{1, 0}, {0, 1}, {1, 0}}, {{0, 0, 0}, {0, 1, 0}}, 4, 2},
                    SizeCase{"CrossSectionOfOnePointTwice", {{1, 0}, {1, 0}}, {{0, 0, 0}, {0, 1, 0}}, 2, 1},
                    SizeCase{"TwoSpinePointsThatAreOne", kSquare, {{0, 0, 0}, {0, 0, 0}}, 4, 6},
                    SizeCase{"Column", kSquare, {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}, 12, 10},
                    SizeCase{"Ring", kSquare, circle(6), 24, 26}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Extrusion, ScaleOfZeroKeepsThePolygons) {
  ExtrusionGeometry e = extrude(kSquare, {{0, 0, 0}, {0, 1, 0}});
  e.scale = Section{{1, 1}, {0, 0}};
  const Mesh mesh = build_mesh(e);
  EXPECT_EQ(mesh.polygon_count(), 6U);
  EXPECT_EQ(mesh.vertices[7], Eigen::Vector3f(0, 1, 0));
  EXPECT_NEAR(signed_volume(mesh), 4.0 / 3.0, 1e-6);  // a pyramid
}

TEST(Extrusion, TurnedOverKeepsItsCorners) {
  ExtrusionGeometry e = extrude(kSquare, {{0, 0, 0}, {0, 1, 0}});
  const Polygons out = polygons_of(build_mesh(e));
  e.ccw = false;
  EXPECT_FALSE(build_mesh(e).ccw);
  EXPECT_EQ(polygons_of(build_mesh(e)), out);
}

TEST(Extrusion, StaysFinite) {
  ExtrusionGeometry e = extrude(kSquare, {{0, 0, 0}, {0, 3e38F, 0}, {-3e38F, 3e38F, 3e38F}});
  e.scale = Section{{3e38F, 1e-45F}};
  for (const Eigen::Vector3f& v : build_mesh(e).vertices) EXPECT_TRUE(v.allFinite());
}

}  // namespace peerd::extrusion_test
