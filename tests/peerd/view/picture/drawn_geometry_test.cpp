#include "peerd/view/picture/drawn_geometry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::drawn_geometry_test {

using peerd::testing_support::picture_of_text;
using testing::ElementsAre;

TEST(DrawnGeometry, NormalsAreFlatUpToTheCreaseAngle) {
  const auto normals_with = [](const char* crease) {
    const ScenePicture drawn =
        picture_of_text(std::string("Shape { geometry IndexedFaceSet { creaseAngle ") + crease +
                        R"( coord Coordinate { point [0 0 0, 1 0 0, 1 1 0, 0 1 0, -1 0 -1, -1 1 -1] }
      coordIndex [0 1 2 3 -1 4 0 3 5 -1] } })");
    return drawn.geometries.at(0);
  };
  const DrawnGeometry flat = normals_with("0"), smooth = normals_with("1");  // the angle between the two is pi/4
  EXPECT_EQ(flat.positions.size(), 8u);
  for (const Eigen::Vector3f& n : flat.normals) {
    EXPECT_TRUE(n.isApprox(Eigen::Vector3f::UnitZ()) || n.isApprox(Eigen::Vector3f(-1, 0, 1).normalized()));
  }
  EXPECT_EQ(smooth.positions.size(), 6u) << "the edge is shared";
  const auto edge = std::ranges::find(smooth.positions, Eigen::Vector3f(0, 0, 0));
  ASSERT_NE(edge, smooth.positions.end());
  const Eigen::Vector3f between = (Eigen::Vector3f::UnitZ() + Eigen::Vector3f(-1, 0, 1).normalized()).normalized();
  EXPECT_TRUE(smooth.normals[static_cast<std::size_t>(edge - smooth.positions.begin())].isApprox(between, 1e-5F));
}

// The share of the triangles' area that is seen from a direction, where the back of a triangle is not.
double area_seen_from(const DrawnGeometry& g, const Eigen::Vector3f& from) {
  double area = 0.0;
  for (std::size_t i = 0; i + 2 < g.corners.size(); i += 3) {
    const auto at = [&](std::size_t k) -> Eigen::Vector3f { return g.positions[g.corners[i + k]]; };
    const Eigen::Vector3f normal = (at(1) - at(0)).cross(at(2) - at(0));
    EXPECT_GT(normal.dot(g.normals[g.corners[i]]), 0.0F) << "it is lit from the side that it shows";
    area += std::max(0.0F, 0.5F * normal.dot(from));
  }
  return area;
}

// A polygon that crosses itself collides by the triangles that it is cut into, and these are drawn. It has no front
// where the areas of its parts cancel, and is then drawn from both sides.
TEST(DrawnGeometry, WhatCrossesItselfIsDrawn) {
  const auto drawn = [](const char* points, const char* more) {
    return picture_of_text(std::string("Shape { geometry IndexedFaceSet { coord Coordinate { point [") + points +
                           "] } coordIndex [0 1 2 3 -1] " + more + " } }");
  };
  for (const char* const more :
       {"", "ccw FALSE", "creaseAngle 1", "normal Normal { vector [0 0 1, 0 0 1, 0 0 1, 0 0 1] }"}) {
    const ScenePicture even = drawn("0 0 0, 2 2 0, 2 0 0, 0 2 0", more);
    ASSERT_EQ(even.geometries.size(), 1u) << more;
    EXPECT_EQ(area_seen_from(even.geometries[0], Eigen::Vector3f::UnitZ()), 4.0) << more;
    EXPECT_EQ(area_seen_from(even.geometries[0], -Eigen::Vector3f::UnitZ()), 4.0) << more;
    EXPECT_TRUE(even.undrawn.empty()) << more;
  }
  for (const char* const more : {"", "ccw FALSE"}) {
    const DrawnGeometry uneven = drawn("0 0 0, 2 2 0, 2 0 0, 0 3 0", more).geometries.at(0);
    const Eigen::Vector3f front = uneven.normals.at(0);
    EXPECT_EQ(area_seen_from(uneven, front), 5.0) << more;
    EXPECT_EQ(area_seen_from(uneven, -front), 0.0) << more;
  }
}

TEST(DrawnGeometry, RoundSolidsAreDrawnRound) {
  for (const char* form : {"Sphere { radius 2 }", "Cylinder { radius 2 top FALSE bottom FALSE }"}) {
    const ScenePicture drawn = picture_of_text("Shape { geometry " + std::string(form) + " }");
    const DrawnGeometry& g = drawn.geometries.at(0);
    for (std::size_t i = 0; i < g.positions.size(); ++i) {
      Eigen::Vector3f out = g.positions[i];
      if (form[0] == 'C') out.y() = 0;
      EXPECT_GT(g.normals[i].dot(out.normalized()), 0.99F) << form;
    }
  }
  const DrawnGeometry cylinder = picture_of_text("Shape { geometry Cylinder { } }").geometries.at(0);
  EXPECT_EQ(cylinder.positions.size(), 4u * 24) << "the caps have an edge";
}

TEST(DrawnGeometry, ColoursAreThoseOfVerticesOrFaces) {
  const std::string points =
      "coord Coordinate { point [0 0 0, 1 0 0, 1 1 0, 0 1 0] } coordIndex [0 1 2 -1 0 2 3 -1] "
      "color Color { color [1 0 0, 0 1 0, 0 0 1, 1 1 0] } ";
  const auto drawn = [&](const std::string& more) {
    return picture_of_text("Shape { geometry IndexedFaceSet { " + points + more + " } }").geometries.at(0);
  };
  const auto color_at = [](const DrawnGeometry& g, std::size_t corner) { return g.colors.at(g.corners.at(corner)); };
  const DrawnGeometry by_vertex = drawn("");
  EXPECT_EQ(color_at(by_vertex, 2), (Color{0, 0, 1}));
  EXPECT_EQ(color_at(by_vertex, 5), (Color{1, 1, 0}));
  const DrawnGeometry by_index = drawn("colorIndex [3 2 1 -1 0 0 0 -1]");
  EXPECT_EQ(color_at(by_index, 0), (Color{1, 1, 0}));
  EXPECT_EQ(color_at(by_index, 4), (Color{1, 0, 0}));
  const DrawnGeometry by_face = drawn("colorPerVertex FALSE");
  for (const std::size_t corner : {0, 1, 2}) EXPECT_EQ(color_at(by_face, corner), (Color{1, 0, 0}));
  for (const std::size_t corner : {3, 4, 5}) EXPECT_EQ(color_at(by_face, corner), (Color{0, 1, 0}));
  const DrawnGeometry by_face_index = drawn("colorPerVertex FALSE colorIndex [2 3]");
  EXPECT_EQ(color_at(by_face_index, 0), (Color{0, 0, 1}));
  EXPECT_EQ(color_at(by_face_index, 3), (Color{1, 1, 0}));
}

TEST(DrawnGeometry, LinesAndPointsShineByThemselves) {
  const ScenePicture drawn = picture_of_text(R"(
Shape { appearance Appearance { material Material { emissiveColor 1 0 0 } }
        geometry IndexedLineSet { coord Coordinate { point [0 0 0, 1 0 0, 1 1 0] } coordIndex [0 1 2 -1 2 0 -1] } }
Shape { geometry PointSet { coord Coordinate { point [0 0 0, 1 0 0] } color Color { color [1 0 0, 0 1 0] } } })");
  ASSERT_EQ(drawn.geometries.size(), 2u);
  EXPECT_EQ(drawn.geometries[0].mode, DrawnGeometry::Mode::kLines);
  EXPECT_EQ(drawn.geometries[0].corners.size(), 2u * 3);
  EXPECT_EQ(drawn.geometries[1].mode, DrawnGeometry::Mode::kPoints);
  EXPECT_THAT(drawn.geometries[1].colors, ElementsAre(Color{1, 0, 0}, Color{0, 1, 0}));
  const DrawnMaterial& lines = drawn.materials[drawn.meshes[drawn.shapes[0].mesh].material];
  EXPECT_FALSE(lines.lit);
  EXPECT_EQ(lines.diffuse, (Color{1, 0, 0}));
}

}  // namespace peerd::view::drawn_geometry_test
