#include "core/motion/viewpoint_nodes.hpp"

#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd::viewpoint_nodes_test {

std::optional<Vec3> place_of(const std::string& text) {
  const auto viewpoint = bound_viewpoint(scene_of(text));
  return viewpoint ? std::optional(viewpoint->in_world.position) : std::nullopt;
}

struct Case {
  const char* name;
  std::string text;
  std::optional<Vec3> place;
};
class BoundViewpoint : public testing::TestWithParam<Case> {};
TEST_P(BoundViewpoint, IsTheFirstInTheWorld) { EXPECT_EQ(place_of(GetParam().text), GetParam().place); }
INSTANTIATE_TEST_SUITE_P(
    Worlds, BoundViewpoint,
    testing::Values(
        Case{"NoViewpoint", "Group { }", std::nullopt}, Case{"Default", "Viewpoint { }", Vec3(0, 0, 10)},
        Case{"FirstOfTwo", "Group { } Viewpoint { position 1 2 3 } Viewpoint { position 4 5 6 }", Vec3(1, 2, 3)},
        Case{"DepthFirst",
             "Group { children [ Shape { } Transform { translation 1 0 0 children Viewpoint { position 0 1 0 } } ] } "
             "Viewpoint { position 4 5 6 }",
             Vec3(1, 1, 0)},
        Case{"BehindASubtree",
             "Transform { translation 1 0 0 children [ Group { children Shape { } } Viewpoint { position 0 0 0 } "
             "Group { children Viewpoint { } } ] }",
             Vec3(1, 0, 0)},
        Case{"WhatASwitchHasChosen",
             "Switch { whichChoice 1 choice [ Group { children Viewpoint { position 9 9 9 } } "
             "Group { children Viewpoint { position 1 1 1 } } ] }",
             Vec3(1, 1, 1)},
        Case{"LevelZero",
             "LOD { level [ Group { } Group { children Viewpoint { position 9 9 9 } } ] } Viewpoint { position 1 0 0 }",
             Vec3(1, 0, 0)},
        Case{"Used", "Transform { translation 0 7 0 children DEF V Viewpoint { position 0 0 1 } } USE V",
             Vec3(0, 7, 1)}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(BoundViewpointNode, SaysWhereItStandsAndHowWideItSees) {
  const Scene scene =
      scene_of("DEF CAR Transform { rotation 0 1 0 1.5707964 children Viewpoint { position 0 0 -2 fieldOfView 1.5 } }");
  const auto viewpoint = bound_viewpoint(scene);
  ASSERT_TRUE(viewpoint);
  EXPECT_EQ(viewpoint->parent, scene.find("CAR"));
  EXPECT_FLOAT_EQ(static_cast<float>(viewpoint->field_of_view), 1.5f);
  EXPECT_LT((viewpoint->in_world.position - Vec3(-2, 0, 0)).norm(), 1e-6);
  EXPECT_LT((viewpoint->in_world.orientation * Vec3(0, 0, -1) - Vec3(-1, 0, 0)).norm(), 1e-6);
}

}  // namespace peerd::viewpoint_nodes_test
