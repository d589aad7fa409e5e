#include "collision/contact/surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/collision/shapes.hpp"

namespace peerd::collision::surface_test {

using namespace test;
using ::testing::HasSubstr;

Vec3 here(const Eigen::Vector3f& p) { return p.cast<double>(); }

TEST(Surface, NumbersPolygonsThroughItsShapes) {
  Surface surface;
  ASSERT_TRUE(surface.append(ObjectId{4}, box_mesh(2, 2, 2), here).has_value());
  ASSERT_TRUE(
      surface
          .append(ObjectId{9}, wall_mesh(1, 1), [](const Eigen::Vector3f& p) { return Vec3(here(p) + Vec3(5, 0, 0)); })
          .has_value());
  EXPECT_EQ(surface.soup().faces.size(), 14u);
  EXPECT_EQ(surface.polygon(0).shape, ObjectId{4});
  EXPECT_EQ(surface.polygon(5).polygon, 5u);
  EXPECT_EQ(surface.polygon(6).shape, ObjectId{9});
  EXPECT_EQ(surface.polygon(6).polygon, 0u);
  EXPECT_EQ(surface.soup().box.hi, Vec3(5, 1, 1));
  EXPECT_TRUE(std::ranges::is_sorted(surface.soup().faces, {}, &TriangleSoup::Face::polygon));
}

TEST(Surface, NormalsAreThoseOfWholePolygons) {
  Surface surface;
  ASSERT_TRUE(surface.append(ObjectId{1}, box_mesh(2, 2, 2), here).has_value());
  EXPECT_EQ(surface.normal(1), Vec3(1, 0, 0));
  EXPECT_EQ(surface.normal(2), Vec3(0, -1, 0));
  Surface flat;
  ASSERT_TRUE(flat.append(ObjectId{1}, make_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}), here).has_value());
  EXPECT_EQ(flat.normal(0), std::nullopt);
}

// Polygons that have no place are left out; the vertices stay, for BOX.
TEST(Surface, RefusesPolygonsTooFarOutAndKeepsTheirVertices) {
  Surface surface;
  const auto far =
      surface.append(ObjectId{1}, box_mesh(2, 2, 2), [](const Eigen::Vector3f& p) { return Vec3(here(p) * 0x1p129); });
  ASSERT_FALSE(far.has_value());
  EXPECT_THAT(far.error(), HasSubstr("is not within 2^128 m"));
  EXPECT_TRUE(surface.soup().faces.empty());
  EXPECT_EQ(surface.soup().vertices.size(), 8u);
}

TEST(Surface, ItsTreeIsBuiltOnce) {
  Surface surface;
  ASSERT_TRUE(surface.append(ObjectId{1}, box_mesh(2, 2, 2), here).has_value());
  WideTree& tree = surface.tree();
  EXPECT_EQ(&tree, &surface.tree());
  EXPECT_EQ(&tree.soup(), &surface.soup());
}

}  // namespace peerd::collision::surface_test
