#include "collision/exact/triangle_soup.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/collision/shapes.hpp"

namespace peerd::collision::triangle_soup_test {

using namespace test;
using ::testing::HasSubstr;

TEST(TriangleSoup, KeepsVerticesAndNumbersPolygons) {
  auto vertices = box_vertices(2, 4, 6);
  vertices.push_back({50, 50, 50});  // no polygon uses it
  const auto soup = make_soup(make_mesh(vertices, kBoxFaces));
  ASSERT_TRUE(soup.has_value());
  ASSERT_EQ(soup->vertices.size(), 9u);
  ASSERT_EQ(soup->faces.size(), 12u);
  for (std::size_t f = 0; f < soup->faces.size(); ++f) {
    EXPECT_EQ(soup->faces[f].polygon, f / 2);
    for (const std::uint32_t c : soup->faces[f].corners) EXPECT_LT(c, 8u);
  }
  EXPECT_EQ(soup->box.lo, Vec3(-1, -2, -3));
  EXPECT_EQ(soup->box.hi, Vec3(1, 2, 3));
  EXPECT_EQ(soup->triangle(0)[0], soup->vertices[soup->faces[0].corners[0]]);
}

TEST(TriangleSoup, BakesTheStretchIntoItsVertices) {
  const Mat3 stretch = Vec3(0.1, 2.0, 3.0).asDiagonal();
  const Mesh mesh = box_mesh(2, 2, 2);
  const auto soup = make_soup(mesh, stretch);
  ASSERT_TRUE(soup.has_value());
  for (std::size_t v = 0; v < soup->vertices.size(); ++v) {
    EXPECT_EQ(soup->vertices[v], multiply(stretch, Vec3(mesh.vertices[v].cast<double>())));
  }
}

TEST(TriangleSoup, RefusesByNameWhatIsTooFarOutOrNoNumber) {
  EXPECT_TRUE(is_representable({0x1p128, -0x1p128, 0}));
  EXPECT_FALSE(is_representable({std::nextafter(0x1p128, 0x1p129), 0, 0}));
  EXPECT_FALSE(is_representable({0, std::numeric_limits<double>::quiet_NaN(), 0}));
  EXPECT_FALSE(is_representable({0, 0, -std::numeric_limits<double>::infinity()}));
  const auto far = make_soup(box_mesh(2, 2, 2), Vec3(1, 0x1p129, 1).asDiagonal());
  ASSERT_FALSE(far.has_value());
  EXPECT_THAT(far.error(), HasSubstr("vertex 0 of polygon 0"));
  // What no polygon uses may be anywhere.
  EXPECT_TRUE(make_soup(make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 0}}, {{0, 1, 2}})).has_value());
}

TEST(TriangleSoup, WithoutPolygonsItIsEmpty) {
  const auto soup = make_soup(make_mesh({{1, 2, 3}}, {}));
  ASSERT_TRUE(soup.has_value());
  EXPECT_TRUE(soup->faces.empty());
  EXPECT_TRUE(soup->box.is_empty());
}

}  // namespace peerd::collision::triangle_soup_test
