#include "core/scene/scene_statistics.hpp"

#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd::scene_statistics_test {

TEST(SceneStatistics, CountWhatIsThere) {
  const SceneStatistics s = statistics_of(scene_of(R"(
    DEF A Transform { velocityVector 1 0 0 children DEF BOX Shape { geometry Box {} } }
    DEF B Transform { children [ USE BOX DEF C Group { children Shape { geometry Text { string "far" } } } ] }
    Switch { whichChoice 0 choice [ Group {} Shape { geometry Sphere {} } ] }
    DEF CLOCK TimeSensor {}
    DEF TURN PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 0 0 ] }
    ROUTE CLOCK.fraction_changed TO TURN.set_fraction
    ROUTE TURN.value_changed TO B.set_translation
    CollisionInterest { objectPath "A" interests [ "B" ] })"));
  EXPECT_EQ(s.instances, 9U);
  EXPECT_EQ(s.shapes, 4U);
  EXPECT_EQ(s.groups, 5U);
  EXPECT_EQ(s.shapes_not_colliding, 1U);
  EXPECT_EQ(s.depth, 3U);
  EXPECT_EQ(s.geometries, 3U);
  EXPECT_EQ(s.geometries_without_surface, 1U);
  EXPECT_EQ(s.polygons, 6U + 288U);
  EXPECT_EQ(s.polygons_instanced, 12U + 288U);
  EXPECT_EQ(s.triangles, 12U + 528U);
  EXPECT_EQ(s.triangles_instanced, 24U + 528U);
  EXPECT_EQ(s.collision_interests, 1U);
  EXPECT_EQ(s.interests, 1U);
  EXPECT_EQ(s.routes, 2U);
  EXPECT_EQ(s.moving_objects, 1U);
}

TEST(SceneStatistics, OfNothingAreNothing) {
  const SceneStatistics s = statistics_of(Scene{});
  EXPECT_EQ(s.nodes + s.instances + s.depth + s.geometries, 0U);
}

}  // namespace peerd::scene_statistics_test
