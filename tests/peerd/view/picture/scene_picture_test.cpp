#include "peerd/view/picture/scene_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::scene_picture_test {

using peerd::testing_support::picture_of_text;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> left_out(const ScenePicture& drawn) {
  std::vector<std::string> out;
  for (const Undrawn& u : drawn.undrawn) out.push_back(u.path + " " + u.what + ": " + u.why);
  return out;
}

// All that is not drawn, or otherwise than the standard says, is named with its place.
TEST(ScenePicture, NamesWhatItLeavesOut) {
  struct Case {
    const char *name, *text, *line;
  };
  for (const Case& c : {
           Case{"Text",
                "DEF S Shape { appearance Appearance { texture PixelTexture { image 1 1 1 0 } } geometry Text { string "
                "\"a\" } }",
                "S Text: its texture"},
           Case{"LOD",
                "DEF L LOD { range 5 level [ Shape { geometry Box { } } DEF G Group { children PointLight { } } ] }",
                "L/G PointLight: it is in a level beyond the first"},
           Case{"Pixels", "DEF S Shape { appearance Appearance { texture PixelTexture { } } geometry Box { } }",
                "S texture: PixelTexture: it has no pixels"},
           Case{"Sensor", "DEF T Transform { children [ VisibilitySensor { } Shape { geometry Box { } } ] }",
                "T VisibilitySensor: no viewer works it"},
           Case{"Over",
                "DEF G Group { children DEF K TouchSensor { } } DEF T TimeSensor { } ROUTE K.isOver TO T.enabled",
                "G TouchSensor: its isOver would be an edit for each movement of the pointer"},
           Case{"Sound", "Sound { source AudioClip { url \"a.wav\" } }", " Sound: no viewer plays it"},
           Case{"Texture",
                "DEF S Shape { appearance Appearance { texture ImageTexture { url \"a.png\" } } geometry Box { } }",
                "S texture: ImageTexture: \"a.png\": it is not looked for"},
           Case{"Movie",
                "DEF S Shape { appearance Appearance { texture MovieTexture { url \"a.mpg\" } } geometry Box { } }",
                "S texture: MovieTexture"},
           Case{"Colours",
                "DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } "
                "coordIndex [0 1 2] color Color { color [1 0 0, 0 1 0] } } }",
                "S IndexedFaceSet: its colours: they do not match its polygons"},
           Case{"Normals",
                "DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } "
                "coordIndex [0 1 2] normal Normal { vector [0 0 0, 0 0 1, 0 0 1] } } }",
                "S IndexedFaceSet: its normals: vector 0 has no length"},
           Case{"FewNormals",
                "DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } "
                "coordIndex [0 1 2] normal Normal { vector [0 0 1, 0 0 1] } } }",
                "S IndexedFaceSet: its normals: they do not match its polygons"},
           Case{"Area",
                "DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 2 0 0] } "
                "coordIndex [0 1 2] } }",
                "S IndexedFaceSet: 1 polygon without area"},
           Case{"Route",
                "DEF T TimeSensor { loop TRUE } DEF I ColorInterpolator { key [0 1] keyValue [0 0 0, 1 1 1] } "
                "Shape { appearance Appearance { material DEF M Material { } } geometry Box { } } "
                "ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO M.set_specularColor",
                "M Material: no ROUTE changes its specularColor"},
           Case{"Light", "DEF G Group { children DirectionalLight { } }",
                "G DirectionalLight: it shines on everything, not only on its siblings"},
       }) {
    EXPECT_THAT(left_out(picture_of_text(c.text)), ElementsAre(c.line)) << c.name;
  }
}

TEST(ScenePicture, CountsWhatItLeavesOutBeyondAThousandOfAKind) {
  std::string text;
  for (int i = 0; i < 1500; ++i) text += "Sound { location " + std::to_string(i) + " 0 0 }\n";
  const ScenePicture drawn = picture_of_text(text);
  ASSERT_EQ(drawn.undrawn.size(), 1001u);
  EXPECT_EQ(drawn.undrawn.front().count, 1u);
  EXPECT_EQ(drawn.undrawn.back().count, 500u);
}

TEST(ScenePicture, DrawsWhatIsInTheWorld) {
  const ScenePicture drawn = picture_of_text(R"(
Switch { whichChoice 1 choice [ DEF A Shape { geometry Box { } } DEF B Shape { geometry Cone { } } ] }
Switch { choice DEF C Shape { geometry Box { } } }
Collision { proxy DEF D Shape { geometry Box { } } children DEF E Shape { geometry Sphere { } } })");
  EXPECT_THAT(drawn.shape_paths, ElementsAre("0/B", "2/E"));
  EXPECT_THAT(drawn.undrawn, IsEmpty());
}

TEST(ScenePicture, GroupsWhatTheViewerDecidesOf) {
  const ScenePicture drawn = picture_of_text(R"(
DEF L LOD { center 1 2 3 range [5 9] level [ DEF A Shape { geometry Box { } } DEF B Group { children Shape { geometry Cone { } } } ] }
DEF ONE LOD { range 5 level DEF C Shape { geometry Box { } } }
DEF CAR Transform { translation 5 0 0 velocityVector 1 0 0 children Transform { translation 0 1 0 children
  DEF BOARD Billboard { axisOfRotation 0 0 0 children DEF LINK Anchor { url ["#V" "b.wrl"] description "to V" children Shape { geometry Box { } } } } } }
DEF S Switch { whichChoice 1 choice [ Shape { geometry Box { } } Shape { geometry Cone { } } ] })");
  using enum DrawnGroup::Kind;
  EXPECT_THAT(drawn.undrawn, IsEmpty());
  ASSERT_EQ(drawn.groups.size(), 4u);
  EXPECT_THAT(drawn.group_paths, ElementsAre("L", "L", "CAR/0/BOARD", "CAR/0/BOARD/LINK"));
  EXPECT_EQ(drawn.groups[0].kind, kLevel);
  EXPECT_THAT(drawn.groups[0].ranges_m, ElementsAre(5.0F, 9.0F));
  EXPECT_EQ(drawn.groups[0].center, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(drawn.groups[1].number, 1u);
  EXPECT_EQ(drawn.groups[1].count, 2u);
  EXPECT_EQ(drawn.groups[2].kind, kBillboard);
  EXPECT_EQ(drawn.groups[2].axis, Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(drawn.groups[2].node_from_group.translation(), Vec3(0, 1, 0)) << "in the frame of the car";
  EXPECT_EQ(drawn.groups[3].kind, kAnchor);
  EXPECT_EQ(drawn.groups[3].above, 2u);
  EXPECT_THAT(drawn.groups[3].urls, ElementsAre("#V", "b.wrl"));
  EXPECT_THAT(drawn.shape_paths, ElementsAre("L/A", "L/B/0", "ONE/C", "CAR/0/BOARD/LINK/0", "S/1"));
  EXPECT_EQ(drawn.shapes[0].group, 0u);
  EXPECT_EQ(drawn.shapes[1].group, 1u);
  EXPECT_EQ(drawn.shapes[2].group, std::nullopt);
  EXPECT_EQ(drawn.shapes[3].group, 3u);
  EXPECT_EQ(drawn.shapes[4].group, std::nullopt);
}

TEST(ScenePicture, HasTexts) {
  const ScenePicture drawn = picture_of_text(R"(
DEF S Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } } geometry Text {
  string ["one" "two"] length [0 3] maxExtent 7 fontStyle FontStyle { family "SANS" style "BOLD" size 2 spacing 1.5 justify ["MIDDLE" "END"] horizontal FALSE } } }
Shape { geometry Text { } } Shape { geometry Text { string "" } })");
  EXPECT_THAT(drawn.undrawn, IsEmpty());
  ASSERT_EQ(drawn.shapes.size(), 1u) << "an empty one is none";
  ASSERT_EQ(drawn.shapes[0].text, 0u);
  EXPECT_EQ(drawn.shapes[0].mesh, DrawnShape::kNoMesh);
  const DrawnText& text = drawn.texts.at(0);
  EXPECT_THAT(text.lines, ElementsAre("one", "two"));
  EXPECT_THAT(text.lengths_m, ElementsAre(0.0F, 3.0F));
  EXPECT_THAT(text.justify, ElementsAre("MIDDLE", "END"));
  EXPECT_THAT(text.families, ElementsAre("SANS"));
  EXPECT_EQ(text.style, "BOLD");
  EXPECT_EQ(text.max_extent_m, 7.0F);
  EXPECT_EQ(text.spacing, 1.5F);
  EXPECT_FALSE(text.horizontal);
  EXPECT_EQ(text.material.diffuse, (Color{1, 0, 0}));
}

TEST(ScenePicture, HasTheSensorsThatAPageWorks) {
  const ScenePicture drawn = picture_of_text(R"(
DEF CAR Transform { translation 5 0 0 velocityVector 1 0 0 children Transform { translation 0 1 0 children [
  DEF TOUCH TouchSensor { } Shape { geometry Box { } } ] } }
DEF OFF Group { children DEF DEAD TouchSensor { enabled FALSE } } Group { children TouchSensor { } }
DEF NEAR Group { children DEF PROXIMITY ProximitySensor { size 1 2 3 } }
DEF T TimeSensor { } DEF L PointLight { }
ROUTE TOUCH.touchTime TO T.startTime ROUTE DEAD.touchTime TO T.startTime ROUTE PROXIMITY.isActive TO L.on)");
  EXPECT_THAT(drawn.undrawn, IsEmpty());
  ASSERT_EQ(drawn.sensors.size(), 2u) << "one that is off, or leads nowhere, does nothing";
  EXPECT_THAT(drawn.sensor_paths, ElementsAre("CAR/0", "NEAR"));
  EXPECT_EQ(drawn.sensors[0].what.kind, view::SensorKind::kTouch);
  EXPECT_EQ(drawn.sensors[0].node_from_sensor.translation(), Vec3(0, 1, 0)) << "in the frame of the car";
  EXPECT_THAT(drawn.sensors[0].previews, IsEmpty());
  EXPECT_EQ(drawn.sensors[1].what.kind, view::SensorKind::kProximity);
}

TEST(ScenePicture, HasASensorInEachPlaceWhereTheFileUsesIt) {
  const ScenePicture drawn = picture_of_text(R"(
DEF A Transform { translation 1 0 0 children DEF HALL ProximitySensor { size 1 2 3 } }
DEF B Transform { translation 7 0 0 children USE HALL } DEF L PointLight { } DEF K Transform { }
ROUTE HALL.isActive TO L.on ROUTE HALL.position_changed TO K.translation)");
  EXPECT_THAT(left_out(drawn),
              ElementsAre("A ProximitySensor: its position_changed would be an edit for each movement of the viewer"));
  EXPECT_THAT(drawn.sensor_paths, ElementsAre("A", "B"));
  ASSERT_EQ(drawn.sensors.size(), 2u);
  EXPECT_EQ(drawn.sensors[0].what.node, drawn.sensors[1].what.node);
  EXPECT_EQ(drawn.sensors[1].what.targets.size(), 1u);
  EXPECT_EQ(drawn.sensors[0].node_from_sensor.translation(), Vec3(1, 0, 0));
  EXPECT_EQ(drawn.sensors[1].node_from_sensor.translation(), Vec3(7, 0, 0));
}

// While a sensor is dragged, the page draws what its ROUTEs move where they will move it.
TEST(ScenePicture, SaysWhatADragMoves) {
  const ScenePicture drawn = picture_of_text(R"(
DEF CAR Transform { translation 5 0 0 velocityVector 1 0 0 children [
  DEF TURN CylinderSensor { }
  Transform { translation 0 1 0 children DEF WHEEL Transform { translation 1 0 0 center 0 0 2 rotation 0 1 0 0.5 children Shape { geometry Box { } } } } ] }
DEF DRAG Group { children [ DEF PLANE PlaneSensor { } DEF KNOB Transform { translation 1 2 3 children Shape { geometry Box { } } } ] }
DEF TWICE Transform { scale 2 2 2 children USE KNOB } DEF L PointLight { }
ROUTE TURN.rotation_changed TO WHEEL.rotation ROUTE TURN.rotation_changed TO CAR.rotation
ROUTE PLANE.translation_changed TO KNOB.translation ROUTE PLANE.translation_changed TO L.location)");
  EXPECT_THAT(drawn.undrawn, IsEmpty());
  ASSERT_EQ(drawn.sensors.size(), 2u);
  ASSERT_EQ(drawn.sensors[0].previews.size(), 1u) << "the car moves by itself";
  const DrawnSensor::Preview& wheel = drawn.sensors[0].previews[0];
  EXPECT_EQ(wheel.path, "CAR/1/WHEEL");
  EXPECT_EQ(wheel.node, drawn.sensors[0].node);
  EXPECT_EQ(drawn.sensors[0].what.targets.at(wheel.target).path, "WHEEL");
  EXPECT_TRUE(wheel.node_from_frame.translation().isApprox(Vec3(1, 1, 2))) << wheel.node_from_frame.translation();
  EXPECT_THAT(wheel.from, ElementsAre(0.0F, 1.0F, 0.0F, 0.5F));
  const auto& knobs = drawn.sensors[1].previews;
  ASSERT_EQ(knobs.size(), 2u) << "the file uses it twice";
  EXPECT_EQ(knobs[0].path, "DRAG/KNOB");
  EXPECT_EQ(knobs[0].node_from_frame.matrix(), Eigen::Affine3d::Identity().matrix());
  EXPECT_THAT(knobs[0].from, ElementsAre(1.0F, 2.0F, 3.0F));
  EXPECT_EQ(knobs[1].path, "TWICE/KNOB");
  EXPECT_EQ(knobs[1].node_from_frame(0, 0), 2.0);
}

TEST(ScenePicture, SaysWhenADragMovesMoreThanIsShown) {
  std::string text = "DEF PLANE PlaneSensor { } DEF KNOB Transform { children Shape { geometry Box { } } }\n";
  for (int i = 0; i < 150; ++i) text += "Group { children USE KNOB }\n";
  const ScenePicture drawn = picture_of_text(text + "ROUTE PLANE.translation_changed TO KNOB.translation");
  EXPECT_EQ(drawn.sensors.at(0).previews.size(), 100u);
  EXPECT_THAT(left_out(drawn),
              ElementsAre(" PlaneSensor: a drag is shown in 100 places, and not in all that it moves"));
}

// Forms that move say what their vertices are; a Material that is driven is nobody else's.
TEST(ScenePicture, NumbersFormsAndLooks) {
  const ScenePicture drawn = picture_of_text(R"(
DEF T TimeSensor { loop TRUE }
DEF WAVE CoordinateInterpolator { key [0 1] keyValue [0 0 0, 1 0 0, 1 1 0, 0 1 0, 0 0 1, 1 0 1, 1 1 1, 0 1 1] }
DEF HUE ColorInterpolator { key [0 1] keyValue [0 0 0, 1 1 1] }
DEF GROW PositionInterpolator { key [0 1] keyValue [1 1 1, 2 2 2] }
Shape { appearance Appearance { material DEF M Material { } }
        geometry IndexedFaceSet { coord DEF C Coordinate { point [0 0 0, 1 0 0, 1 1 0, 0 1 0] } coordIndex [3 2 1 0] } }
DEF X Transform { children Shape { appearance Appearance { material Material { } } geometry Box { } } }
ROUTE T.fraction_changed TO WAVE.set_fraction ROUTE WAVE.value_changed TO C.point
ROUTE T.fraction_changed TO HUE.set_fraction ROUTE HUE.value_changed TO M.diffuseColor
ROUTE T.fraction_changed TO GROW.set_fraction ROUTE GROW.value_changed TO X.scale)");
  EXPECT_THAT(drawn.undrawn, IsEmpty());
  ASSERT_EQ(drawn.shapes.size(), 2u);
  const DrawnGeometry& flag = drawn.geometries[drawn.meshes[drawn.shapes[0].mesh].geometry];
  EXPECT_EQ(flag.form, 0u);
  EXPECT_THAT(flag.points, ElementsAre(3u, 2u, 1u, 0u));
  EXPECT_EQ(drawn.materials[drawn.meshes[drawn.shapes[0].mesh].material].driven.color, 0u);
  EXPECT_EQ(drawn.shapes[0].form, std::nullopt);
  EXPECT_EQ(drawn.shapes[1].form, 0u);
  EXPECT_EQ(drawn.geometries[drawn.meshes[drawn.shapes[1].mesh].geometry].form, std::nullopt);
  EXPECT_EQ(drawn.materials[drawn.meshes[drawn.shapes[1].mesh].material].driven.color, std::nullopt);
}

}  // namespace peerd::view::scene_picture_test
