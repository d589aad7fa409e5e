#include "peerd/view/frames/driven_looks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::driven_looks_test {

using peerd::testing_support::scene_of;
using testing::ElementsAre;
using testing::FloatEq;

std::uint32_t node_of(const Scene& scene, std::string_view def) {
  for (std::uint32_t i = 0; i < scene.document->nodes.size(); ++i) {
    if (scene.document->nodes[i].def == def) return i;
  }
  return vrml::NodeRef::kNull;
}

std::vector<float> value_at(DrivenLooks& looks, std::uint32_t look, double t_s) {
  std::vector<float> out;
  looks.value(look, t_s, out);
  return out;
}

const char* const kWorld = R"(
DEF T TimeSensor { loop TRUE cycleInterval 2 }
DEF COLOURS ColorInterpolator { key [0 0.5 1] keyValue [1 0 0, 0 1 0, 1 0 0] }
DEF AMOUNTS ScalarInterpolator { key [0 1] keyValue [0 1] }
Shape { appearance Appearance { material DEF M Material { diffuseColor 0.2 0.3 0.4 } } geometry Box { } }
DEF L PointLight { intensity 0.5 }
ROUTE T.fraction_changed TO COLOURS.set_fraction
ROUTE T.fraction_changed TO AMOUNTS.set_fraction
ROUTE COLOURS.value_changed TO M.diffuseColor
ROUTE AMOUNTS.value_changed TO M.transparency
ROUTE AMOUNTS.value_changed TO M.shininess
ROUTE AMOUNTS.value_changed TO L.intensity
ROUTE T.isActive TO L.on
)";

TEST(DrivenLooks, FollowWorldTime) {
  const Scene scene = scene_of(kWorld);
  DrivenLooks looks(scene.document);
  EXPECT_EQ(looks.count(), 4u) << "nobody shows a shininess that changes";
  const auto diffuse = looks.find(node_of(scene, "M"), "diffuseColor");
  const auto intensity = looks.find(node_of(scene, "L"), "intensity");
  const auto on = looks.find(node_of(scene, "L"), "on");
  ASSERT_TRUE(diffuse && intensity && on);
  EXPECT_FALSE(looks.find(node_of(scene, "M"), "shininess"));
  EXPECT_FALSE(looks.find(node_of(scene, "L"), "color"));
  EXPECT_THAT(value_at(looks, *diffuse, 0.5), ElementsAre(FloatEq(1), FloatEq(1), FloatEq(0)))
      << "half way of hue, saturation and value";
  EXPECT_THAT(value_at(looks, *diffuse, 1.0), ElementsAre(FloatEq(0), FloatEq(1), FloatEq(0)));
  EXPECT_THAT(value_at(looks, *intensity, 1.5), ElementsAre(FloatEq(0.75F)));
  EXPECT_THAT(value_at(looks, *on, 1.5), ElementsAre(1.0F));
}

TEST(DrivenLooks, AreThoseOfTheFileBeforeTheWorldIsRead) {
  const Scene scene = scene_of(kWorld);
  DrivenLooks looks(scene.document);
  EXPECT_THAT(value_at(looks, *looks.find(node_of(scene, "M"), "diffuseColor"), -1.0),
              ElementsAre(FloatEq(0.2F), FloatEq(0.3F), FloatEq(0.4F)));
  EXPECT_THAT(value_at(looks, *looks.find(node_of(scene, "L"), "intensity"), -1.0), ElementsAre(0.5F));
  EXPECT_THAT(value_at(looks, *looks.find(node_of(scene, "L"), "on"), -1.0), ElementsAre(1.0F));
}

// A field to which no TimeSensor leads is not known to all peers alike, and so it stays.
TEST(DrivenLooks, AreNoneWithoutATimeSensor) {
  const Scene scene = scene_of(
      "DEF K TouchSensor { } DEF S Switch { choice Shape { } } DEF L DirectionalLight { } ROUTE K.isOver TO L.on");
  DrivenLooks looks(scene.document);
  EXPECT_EQ(looks.count(), 0u);
  EXPECT_FALSE(looks.find(node_of(scene, "L"), "on"));
}

}  // namespace peerd::view::driven_looks_test
