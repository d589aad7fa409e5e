#include "core/geometry/tessellate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "tests/core/mesh_checks.hpp"

namespace peerd::tessellate_test {

constexpr double kPi = std::numbers::pi;

// 6.6: "centred at (0, 0, 0) .. and aligned with the local coordinate axes. By default, the box measures 2 metres in
// each dimension, from -1 to +1."
TEST(Box, HasItsSidesOutward) {
  const Mesh mesh = build_mesh(BoxGeometry{{2, 4, 6}});
  EXPECT_EQ(
      points_of(mesh),
      (Points{{-1, -2, -3}, {1, -2, -3}, {-1, 2, -3}, {1, 2, -3}, {-1, -2, 3}, {1, -2, 3}, {-1, 2, 3}, {1, 2, 3}}));
  EXPECT_EQ(mesh.polygon_count(), 6U);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_EQ(signed_volume(mesh), 48.0);
}

// 6.10: "apex at y = height/2 and its bottom at y = -height/2". Textures wrap "counterclockwise (from above) starting
// at the back of the cone .. in the X=0 plane".
TEST(Cone, OfFourSlices) {
  const Mesh mesh = build_mesh(ConeGeometry{.bottom_radius = 3, .height = 8}, {.slices = 4});
  EXPECT_EQ(points_of(mesh), (Points{{0, -4, -3}, {-3, -4, 0}, {0, -4, 3}, {3, -4, 0}, {0, 4, 0}}));
  EXPECT_EQ(polygons_of(mesh), (Polygons{{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 3, 2, 1}}));
}

// 6.14: centred, "the cylinder is sized at -1 to +1 in all three dimensions" by default.
TEST(Cylinder, OfFourSlices) {
  const Mesh mesh = build_mesh(CylinderGeometry{}, {.slices = 4});
  EXPECT_EQ(points_of(mesh),
            (Points{{0, -1, -1}, {-1, -1, 0}, {0, -1, 1}, {1, -1, 0}, {0, 1, -1}, {-1, 1, 0}, {0, 1, 1}, {1, 1, 0}}));
  EXPECT_EQ(polygons_of(mesh),
            (Polygons{{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}, {0, 3, 2, 1}}));
}

// 6.42: textures wrap "counterclockwise from the back of the sphere (i.e., longitudinal arc intersecting the -Z-axis)".
TEST(Sphere, OfFourSlicesAndTwoStacksIsAnOctahedron) {
  const Mesh mesh = build_mesh(SphereGeometry{2}, {.slices = 4, .stacks = 2});
  EXPECT_EQ(points_of(mesh), (Points{{0, 2, 0}, {0, 0, -2}, {-2, 0, 0}, {0, 0, 2}, {2, 0, 0}, {0, -2, 0}}));
  EXPECT_EQ(polygons_of(mesh),
            (Polygons{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}, {4, 1, 0}, {5, 2, 1}, {5, 3, 2}, {5, 4, 3}, {5, 1, 4}}));
}

TEST(Sphere, HasQuadrilateralsBetweenItsRings) {
  const Mesh mesh = build_mesh(SphereGeometry{1}, {.slices = 3, .stacks = 3});
  EXPECT_EQ(
      polygons_of(mesh),
      (Polygons{
          {1, 2, 0}, {2, 3, 0}, {3, 1, 0}, {4, 5, 2, 1}, {5, 6, 3, 2}, {6, 4, 1, 3}, {7, 5, 4}, {7, 6, 5}, {7, 4, 6}}));
}

struct Solid {
  const char* name;
  Geometry geometry;
  double volume;            // volume of the round one
  double (*prism)(double);  // volume of the one with that many slices; null if it is no prism or pyramid
};
double circle_area(double slices) { return slices / 2 * std::sin(2 * kPi / slices); }
class RoundSolid : public testing::TestWithParam<Solid> {};

TEST_P(RoundSolid, IsClosedAndOutward) {
  for (const std::uint32_t slices : {3U, 4U, 5U, 24U}) {
    for (const std::uint32_t stacks : {2U, 3U, 4U, 12U}) {
      const Tessellation tessellation{slices, stacks};
      const Mesh mesh = build_mesh(GetParam().geometry, tessellation);
      EXPECT_TRUE(is_closed(mesh));
      EXPECT_TRUE(uses_all_vertices(mesh));
      EXPECT_GT(signed_volume(mesh), 0.0);
      EXPECT_EQ(mesh_size(GetParam().geometry, tessellation), counted(mesh));
      const std::set<std::array<float, 3>> distinct = [&] {
        const Points points = points_of(mesh);
        return std::set(points.begin(), points.end());
      }();
      EXPECT_EQ(distinct.size(), mesh.vertices.size());
    }
  }
}

TEST_P(RoundSolid, VolumeTendsToTheTrueOneFromBelow) {
  double missing = GetParam().volume;
  for (std::uint32_t n = 8; n <= 128; n *= 2) {
    const double volume = signed_volume(build_mesh(GetParam().geometry, {n, n}));
    if (GetParam().prism != nullptr) {
      EXPECT_NEAR(volume, GetParam().prism(n), 1e-6 * GetParam().volume);
    }
    EXPECT_GT(volume, 0.0);
    EXPECT_LT(volume, GetParam().volume);
    if (n > 8) {
      EXPECT_NEAR(missing / (GetParam().volume - volume), 4.0, 0.2);  // the error is quadratic
    }
    missing = GetParam().volume - volume;
  }
}

// Bounds must not lean to one side: x, z -> -x, z in each circle, y -> -y in the sphere.
TEST_P(RoundSolid, IsItsOwnMirrorImageToTheLastBit) {
  for (const std::uint32_t n : {3U, 7U, 8U, 12U, 25U}) {
    const Points points = points_of(build_mesh(GetParam().geometry, {n, n}));
    Points mirrored = points, sorted = points;
    for (auto& p : mirrored) p[0] = -p[0];
    std::ranges::sort(mirrored), std::ranges::sort(sorted);
    EXPECT_EQ(mirrored, sorted);
  }
}

INSTANTIATE_TEST_SUITE_P(Table, RoundSolid,
                         testing::Values(Solid{"Sphere", SphereGeometry{3}, 36 * kPi, nullptr},
                                         Solid{"Cone", ConeGeometry{.bottom_radius = 2, .height = 3}, 4 * kPi,
                                               +[](double n) { return 4 * circle_area(n); }},
                                         Solid{"Cylinder", CylinderGeometry{.radius = 2, .height = 3}, 12 * kPi,
                                               +[](double n) { return 12 * circle_area(n); }}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Sphere, HasItsVerticesOnTheSurface) {
  for (const float radius : {1.0F, 0.1F, 1e30F, 1e-30F}) {
    for (const Eigen::Vector3f& v : build_mesh(SphereGeometry{radius}).vertices) {
      EXPECT_NEAR(v.cast<double>().norm() / radius, 1.0, 0x1p-23);  // three roundings of half a unit in the last place
    }
  }
}

TEST(Sphere, MeetsTheAxes) {
  const Points points = points_of(build_mesh(SphereGeometry{0.1F}, {.slices = 24, .stacks = 12}));
  for (const float r : {-0.1F, 0.1F}) {
    EXPECT_THAT(points, testing::Contains(std::array<float, 3>{r, 0, 0}));
    EXPECT_THAT(points, testing::Contains(std::array<float, 3>{0, r, 0}));
    EXPECT_THAT(points, testing::Contains(std::array<float, 3>{0, 0, r}));
  }
}

struct PartsCase {
  const char* name;
  Geometry geometry;
  std::size_t vertices, polygons;
};
class Parts : public testing::TestWithParam<PartsCase> {};
TEST_P(Parts, OnlyTheOnesAskedFor) {
  const Mesh mesh = build_mesh(GetParam().geometry, {.slices = 5});
  EXPECT_EQ(mesh.vertices.size(), GetParam().vertices);
  EXPECT_EQ(mesh.polygon_count(), GetParam().polygons);
  EXPECT_TRUE(uses_all_vertices(mesh));
  EXPECT_EQ(mesh_size(GetParam().geometry, {.slices = 5}), counted(mesh));
}
INSTANTIATE_TEST_SUITE_P(
    Table, Parts,
    testing::Values(PartsCase{"ConeSide", ConeGeometry{.bottom = false}, 6, 5},
                    PartsCase{"ConeBottom", ConeGeometry{.side = false}, 5, 1},
                    PartsCase{"ConeNone", ConeGeometry{.side = false, .bottom = false}, 0, 0},
                    PartsCase{"CylinderSide", CylinderGeometry{.top = false, .bottom = false}, 10, 5},
                    PartsCase{"CylinderTop", CylinderGeometry{.side = false, .bottom = false}, 5, 1},
                    PartsCase{"CylinderBottom", CylinderGeometry{.side = false, .top = false}, 5, 1},
                    PartsCase{"CylinderCaps", CylinderGeometry{.side = false}, 10, 2},
                    PartsCase{"CylinderNone", CylinderGeometry{.side = false, .top = false, .bottom = false}, 0, 0}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Cylinder, TopFacesUpAndBottomDown) {
  const Mesh top = build_mesh(CylinderGeometry{.side = false, .bottom = false}, {.slices = 4});
  EXPECT_EQ(points_of(top), (Points{{0, 1, -1}, {-1, 1, 0}, {0, 1, 1}, {1, 1, 0}}));
  EXPECT_EQ(polygons_of(top), (Polygons{{0, 1, 2, 3}}));
  const Mesh bottom = build_mesh(CylinderGeometry{.side = false, .top = false}, {.slices = 4});
  EXPECT_EQ(polygons_of(bottom), (Polygons{{0, 3, 2, 1}}));
}

TEST(FaceSet, IsNotCopied) {
  const FaceSetGeometry faces{.points = std::vector<Eigen::Vector3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                              .corners = std::vector<std::int32_t>{0, 1, 2, -1, 2, 1, 0},
                              .ccw = false};
  const Mesh mesh = build_mesh(faces);
  EXPECT_EQ(mesh.vertices.data(), faces.points.data());
  EXPECT_EQ(mesh.corners.data(), faces.corners.data());
  EXPECT_FALSE(mesh.ccw);
  EXPECT_EQ(polygons_of(mesh), (Polygons{{0, 1, 2}, {2, 1, 0}}));
}

struct CornersCase {
  const char* name;
  std::vector<std::int32_t> corners;
  MeshSize size;
};
class FaceSetSize : public testing::TestWithParam<CornersCase> {};
TEST_P(FaceSetSize, IsThatOfItsMesh) {
  const FaceSetGeometry faces{.points = std::vector<Eigen::Vector3f>(6), .corners = GetParam().corners};
  EXPECT_EQ(mesh_size(faces), GetParam().size);
  EXPECT_EQ(counted(build_mesh(faces)), GetParam().size);
}
INSTANTIATE_TEST_SUITE_P(Table, FaceSetSize,
                         testing::Values(CornersCase{"Empty", {}, {0, 0}}, CornersCase{"OnlyEnds", {-1, -1}, {0, 0}},
                                         CornersCase{"LastEndMissing", {0, 1, 2, -1, 0, 1, 2, 3}, {2, 3}},
                                         CornersCase{
                                             "EndsRepeated", {-1, 0, 1, 2, -1, -1, 0, 1, 2, 3, 4, -1, -1}, {2, 4}},
                                         CornersCase{"FewCorners", {0, -1, 1, 2, -1}, {2, 2}}),
                         [](const auto& test) { return std::string(test.param.name); });

// The hashes are FNV-1a of the bits of the vertices. They are an agreement between peers: they change with no compiler
// and machine.
std::uint64_t bits_of(const Mesh& mesh) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    for (const float x : v) hash = (hash ^ std::bit_cast<std::uint32_t>(x)) * 0x100000001b3;
  }
  return hash;
}

TEST(Mesh, HasTheSameBitsEverywhere) {
  EXPECT_EQ(bits_of(build_mesh(SphereGeometry{0.7F}, {.slices = 37, .stacks = 23})), 0x07ed2fed85dce733);
  EXPECT_EQ(bits_of(build_mesh(ConeGeometry{.bottom_radius = 0.3F, .height = 1.7F}, {.slices = 37})),
            0x8d653858ef0ab20b);
  EXPECT_EQ(bits_of(build_mesh(CylinderGeometry{.radius = 0.3F, .height = 1.7F}, {.slices = 37})), 0x3ac8a03ab4ba6d8d);
  ExtrusionGeometry e;
  e.cross_section = std::vector<std::array<float, 2>>{{0.1F, 0.2F}, {0.3F, -0.7F}, {-1.1F, 0.4F}};
  e.spine = std::vector<Eigen::Vector3f>{{0, 0, 0}, {0.1F, 0.7F, 0.3F}, {-0.4F, 1.3F, 0.9F}, {1.9F, 1.2F, -0.8F}};
  e.scale = std::vector<std::array<float, 2>>{{1.3F, 0.7F}};
  e.orientation = std::vector<std::array<float, 4>>{{0.3F, 0.5F, -0.2F, 1.1F}};
  EXPECT_EQ(bits_of(build_mesh(e)), 0x7d8de4eaec47a5c8);
  e.spine = std::vector<Eigen::Vector3f>{{0, 0, 0}, {0.1F, -0.7F, 0.3F}};
  EXPECT_EQ(bits_of(build_mesh(e)), 0x7d845f2239ce505e);
}

TEST(NoSurface, HasNoPolygons) {
  const Geometry text = NoSurface{"Text"};
  EXPECT_EQ(build_mesh(text).polygon_count(), 0U);
  EXPECT_EQ(build_mesh(text).vertices.size(), 0U);
  EXPECT_EQ(mesh_size(text), MeshSize{});
}

}  // namespace peerd::tessellate_test
