#include "peerd/view/picks/hierarchy_level.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include <nlohmann/json.hpp>

#include "core/box.hpp"
#include "tests/must.hpp"
#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::hierarchy_level_test {

using peerd::testing_support::scene_of;
using testing::HasSubstr;
using testing::SizeIs;

std::pair<Vec3, Vec3> bounds_of(const HierarchyLevel& level) {
  Vec3 lo = Vec3::Constant(1e9), hi = -lo;
  for (const auto& volume : level.volumes) {
    for (const auto& face : volume) {
      for (const Vec3& corner : face) {
        lo = lo.cwiseMin(corner);
        hi = hi.cwiseMax(corner);
      }
    }
  }
  return {lo, hi};
}

// A box of a scaled Transform beside a sphere, below a node that is turned in the world: volumes are in the node's
// frame.
const char* const kWorld = R"(
DEF A Transform { translation 100 0 0 rotation 0 1 0 1 children [
  Transform { translation 2 0 0 scale 1 3 1 children Shape { geometry Box { size 1 1 1 } } }
  Transform { translation -2 0 0 children Shape { geometry Sphere { radius 0.5 } } }
  Shape { geometry Text { string "no polygons" } }
  Collision { collide FALSE children Shape { geometry Box { size 50 50 50 } } } ] }
DEF NONE Transform { children Shape { geometry PointSet { } } })";

TEST(HierarchyLevel, TheRootHoldsTheWholeObjectInItsFrame) {
  const Scene scene = scene_of(kWorld);
  const auto root = must(hierarchy_level(scene, *scene.find("A"), 0));
  ASSERT_THAT(root.volumes, SizeIs(1));
  EXPECT_FALSE(root.is_last);
  const auto [lo, hi] = bounds_of(root);
  EXPECT_NEAR(lo.x(), -2.5, 0.02);
  EXPECT_NEAR(hi.x(), 2.5, 1e-5);
  EXPECT_NEAR(lo.y(), -1.5, 1e-5);
  EXPECT_NEAR(hi.y(), 1.5, 1e-5);
}

// Each level refines the one above: more volumes, none outside of the root; and there is a last one.
TEST(HierarchyLevel, LevelsRefineEachOtherDownToTheLeaves) {
  const Scene scene = scene_of(kWorld);
  const auto root = must(hierarchy_level(scene, *scene.find("A"), 0));
  const auto [lo, hi] = bounds_of(root);
  std::size_t before = 1;
  bool ended = false;
  for (std::uint32_t level = 1; level <= kLevels && !ended; ++level) {
    const auto next = must(hierarchy_level(scene, *scene.find("A"), level));
    EXPECT_GE(next.volumes.size() + next.left_out, before);
    EXPECT_LE(next.volumes.size(), kVolumes);
    before = next.volumes.size() + next.left_out;
    const auto [inner_lo, inner_hi] = bounds_of(next);
    EXPECT_TRUE(((inner_lo - lo).array() > -1e-4).all() && ((hi - inner_hi).array() > -1e-4).all());
    ended = next.is_last;
  }
  EXPECT_TRUE(ended);
  EXPECT_GT(before, 100u) << "a sphere has many triangles";
}

TEST(HierarchyLevel, SaysWhyThereIsNone) {
  const Scene scene = scene_of(std::string(kWorld) +
                               "DEF BIG Transform { children Shape { geometry ElevationGrid { xDimension 200 "
                               "zDimension 200 height [" +
                               [] {
                                 std::string zeros;
                                 for (int i = 0; i < 40000; ++i) zeros += "0 ";
                                 return zeros;
                               }() +
                               "] } } }");
  EXPECT_EQ(hierarchy_level(scene, *scene.find("NONE"), 0).error(), "it has no polygons that collide");
  EXPECT_THAT(hierarchy_level(scene, *scene.find("BIG"), 0).error(), HasSubstr("more than 20000 triangles"));
}

TEST(HierarchyLevel, AsJsonHasFacesOfFlatCoordinates) {
  const Scene scene = scene_of("DEF A Shape { geometry Box { size 2 2 2 } }");
  const auto json = to_json(must(hierarchy_level(scene, *scene.find("A"), 0)));
  ASSERT_THAT(json["volumes"], SizeIs(1));
  EXPECT_GE(json["volumes"][0].size(), 6u);
  for (const auto& face : json["volumes"][0]) {
    EXPECT_EQ(face.size() % 3, 0u);
    for (const auto& x : face) EXPECT_LE(std::abs(x.get<double>()), 1.0001);
  }
  EXPECT_EQ(json["triangles"], 12);
}

}  // namespace peerd::view::hierarchy_level_test
