#include "collision/exact/convexity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/collision/shapes.hpp"

namespace peerd::collision::convexity_test {

using namespace test;
using ::testing::HasSubstr;

std::string refusal(const std::vector<Eigen::Vector3f>& vertices, const Faces& faces) {
  const auto surface = convex_surface(make_mesh(vertices, faces));
  return surface ? "" : surface.error();
}

TEST(Convexity, NamesTheReason) {
  const auto cube = box_vertices(2, 2, 2);
  EXPECT_EQ(refusal(cube, kBoxFaces), "");
  Faces open = kBoxFaces;
  open.pop_back();
  EXPECT_EQ(refusal(cube, open), "open surface");
  Faces twice = kBoxFaces;
  twice.push_back(kBoxFaces[0]);
  EXPECT_EQ(refusal(cube, twice), "more than two polygons share an edge");
  auto dented = cube;
  dented[7] = {0.1F, 0.1F, 0.1F};
  EXPECT_NE(refusal(dented, kBoxFaces), "");
  EXPECT_THAT(refusal({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5F}, {0, 1, 0}}, {{0, 1, 2, 3}}), HasSubstr("not planar"));
  EXPECT_THAT(refusal({{0, 0, 0}, {2, 0, 0}, {0.5F, 0.5F, 0}, {0, 2, 0}}, {{0, 1, 2, 3}}), HasSubstr("concave"));
  EXPECT_THAT(refusal({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}), HasSubstr("no area"));
  EXPECT_THAT(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2, 1}}), HasSubstr("repeats a corner"));
  EXPECT_THAT(refusal({{0, 0, 0}, {NAN, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), HasSubstr("not finite"));
  EXPECT_THAT(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}),
              HasSubstr("several polygons in one plane"));

  auto two_cubes = cube;
  Faces of_both = kBoxFaces;
  for (const Eigen::Vector3f& v : cube) two_cubes.push_back(v + Eigen::Vector3f(3, 0, 0));
  for (const auto& f : kBoxFaces) of_both.push_back({f[0] + 8, f[1] + 8, f[2] + 8, f[3] + 8});
  EXPECT_THAT(refusal(two_cubes, of_both), HasSubstr("several parts"));

  Faces fan;
  std::vector<Eigen::Vector3f> around = {{0, 0, 0}};
  for (std::uint32_t i = 0; i < 300; ++i) {
    const float angle = 0.02F * static_cast<float>(i);
    around.emplace_back(std::cos(angle), std::sin(angle), 1.0F);
    if (i > 0) fan.push_back({0, i, i + 1});
  }
  EXPECT_THAT(refusal(around, fan), HasSubstr("more than 256 polygons"));
}

// One binary32 step decides: no tolerance.
TEST(Convexity, IsExact) {
  auto vertices = box_vertices(2, 2, 2);
  vertices.push_back({0, 0, 1});  // in the middle of the side +z, which is four triangles now
  Faces faces(kBoxFaces.begin(), kBoxFaces.end() - 1);
  for (std::size_t i = 0; i < 4; ++i) faces.push_back({kBoxFaces[5][i], kBoxFaces[5][(i + 1) % 4], 8});
  EXPECT_EQ(refusal(vertices, faces), "");
  vertices[8].z() = std::nextafter(1.0F, 2.0F);
  EXPECT_EQ(refusal(vertices, faces), "");
  vertices[8].z() = std::nextafter(1.0F, 0.0F);
  EXPECT_EQ(refusal(vertices, faces), "concave");
}

TEST(Convexity, SurfacesFaceOutwardHoweverTheyAreWound) {
  std::mt19937_64 rng(211);
  for (int i = 0; i < 30; ++i) {
    const Mesh mesh = random_polyhedron(rng, i == 0 ? 102 : 4 + static_cast<std::size_t>(i));  // of 200 faces, and few
    std::vector<std::vector<std::uint32_t>> faces;
    for (std::size_t p = 0; p < mesh.polygon_count(); ++p) {
      faces.emplace_back(mesh.polygon(p).begin(), mesh.polygon(p).end());
      if (rng() % 2 == 0) std::ranges::reverse(faces.back());
    }
    const auto surface = convex_surface(make_mesh({mesh.vertices.begin(), mesh.vertices.end()}, faces));
    ASSERT_TRUE(surface.has_value()) << surface.error();
    ASSERT_EQ(surface->normals.size(), surface->polygons.size());
    for (std::size_t p = 0; p < surface->polygons.size(); ++p) {
      const Vec3& n = surface->normals[p];
      EXPECT_NEAR(n.norm(), 1.0, 1e-15);
      const Vec3 corner = surface->vertices[surface->polygons[p][0]].cast<double>();
      for (const Eigen::Vector3f& v : surface->vertices) EXPECT_LE(n.dot(v.cast<double>() - corner), 1e-12);
    }
  }
}

// The coordinates are 2^100 apart: the filter cannot tell, the integers can.
TEST(Convexity, SeesAWideRangeOfMagnitudes) {
  const float tiny = 0x1p-60F, large = 0x1p60F;
  const Faces faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  EXPECT_EQ(refusal({{0, 0, 0}, {large, 0, 0}, {0, large, 0}, {0, 0, tiny}}, faces), "");
}

TEST(Convexity, AFlatPolygonFacesAsItIsWound) {
  const auto up = convex_surface(make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  const auto down = convex_surface(make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, false));
  ASSERT_TRUE(up.has_value() && down.has_value());
  EXPECT_TRUE(up->flat());
  EXPECT_EQ(up->normals[0], Vec3::UnitZ());
  EXPECT_EQ(down->normals[0], -Vec3::UnitZ());
  EXPECT_EQ(up->edge_axes.size(), 3u);
}

}  // namespace peerd::collision::convexity_test
