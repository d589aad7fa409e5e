#include "collision/scene/joined_soup.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd::collision::joined_soup_test {

using testing::HasSubstr;

constexpr const char* kWorld = R"(
DEF A Transform { translation 10 0 0 rotation 0 1 0 1 children [
  Transform { translation 2 0 0 scale 1 3 1 children Shape { geometry Box { size 1 1 1 } } }
  Shape { geometry Text { string "no polygons" } }
  Collision { collide FALSE children Shape { geometry Box { size 50 50 50 } } } ] }
DEF B Transform { translation 0 5 0 children Shape { geometry Box { size 2 2 2 } } }
DEF NONE Transform { children Shape { geometry PointSet { } } })";

TEST(JoinedSoup, OfAnObjectIsInItsFrame) {
  const Scene scene = scene_of(kWorld);
  const auto soup = joined_soup(scene, scene.find("A"), 100);
  ASSERT_TRUE(soup) << soup.error();
  EXPECT_EQ(soup->faces.size(), 12u);
  EXPECT_NEAR((soup->box.lo - Vec3(1.5, -1.5, -0.5)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((soup->box.hi - Vec3(2.5, 1.5, 0.5)).norm(), 0.0, 1e-6);
}

TEST(JoinedSoup, OfTheSceneNumbersPolygonsThrough) {
  const Scene scene = scene_of(kWorld);
  const auto soup = joined_soup(scene, std::nullopt, 100);
  ASSERT_TRUE(soup) << soup.error();
  EXPECT_EQ(soup->faces.size(), 24u);
  EXPECT_EQ(soup->faces.front().polygon, 0u);
  EXPECT_EQ(soup->faces.back().polygon, 11u);
  EXPECT_NEAR(soup->box.hi.y(), 6.0, 1e-6);
  EXPECT_GT(soup->box.hi.x(), 11.0);
}

TEST(JoinedSoup, SaysWhatItHasNot) {
  const Scene scene = scene_of(kWorld);
  const auto none = joined_soup(scene, scene.find("NONE"), 100);
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->faces.empty());
  EXPECT_THAT(joined_soup(scene, std::nullopt, 23).error(), HasSubstr("more than 23 triangles"));
}

}  // namespace peerd::collision::joined_soup_test
