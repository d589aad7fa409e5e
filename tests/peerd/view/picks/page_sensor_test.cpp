#include "peerd/view/picks/page_sensor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::page_sensor_test {

using peerd::testing_support::scene_of;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

SensorReading reading_of(const std::string& text, const std::string& def = "S") {
  const Scene scene = scene_of(text);
  const auto node = std::ranges::find(scene.document->nodes, def, &vrml::Node::def);
  return read_sensor(scene, static_cast<std::uint32_t>(node - scene.document->nodes.begin()));
}
std::vector<std::string> targets_of(const SensorReading& reading) {
  std::vector<std::string> out;
  for (const auto& [event, path, field, node] : reading.sensor.targets) out.push_back(event + " " + path + "." + field);
  return out;
}

TEST(PageSensor, KnowsWhichTypesAPageWorks) {
  for (const char* type : {"TouchSensor", "PlaneSensor", "CylinderSensor", "SphereSensor", "ProximitySensor"}) {
    EXPECT_TRUE(is_page_sensor(type)) << type;
  }
  for (const char* type : {"VisibilitySensor", "TimeSensor", "KeySensor", "Transform", ""}) {
    EXPECT_FALSE(is_page_sensor(type)) << type;
  }
}

// A page makes an edit of a sensor's event: it knows the field by the node's path or name.
TEST(PageSensor, HasTheFieldsToWhichItsRoutesLead) {
  const SensorReading reading = reading_of(R"(
Group { children [ DEF S TouchSensor { } Group { children DEF L PointLight { } } ] } DEF T TimeSensor { }
ROUTE S.touchTime TO T.startTime ROUTE S.isActive TO L.on ROUTE S.isActive TO T.enabled ROUTE T.isActive TO L.on)");
  EXPECT_THAT(targets_of(reading), ElementsAre("touchTime T.startTime", "isActive L.on", "isActive T.enabled"));
  EXPECT_EQ(reading.worked.size(), 3u);
  EXPECT_THAT(reading.left_out, IsEmpty());
  EXPECT_EQ(reading.sensor.kind, SensorKind::kTouch);
  EXPECT_THAT(reading.sensor.numbers, IsEmpty());
  EXPECT_FALSE(reading.sensor.auto_offset);
}

TEST(PageSensor, HasItsOwnNumbers) {
  using Floats = std::vector<float>;
  EXPECT_THAT(reading_of("DEF S PlaneSensor { minPosition 0 -1 maxPosition 0 1 offset 1 2 3 }").sensor.numbers,
              ElementsAre(Pair("min", Floats{0, -1}), Pair("max", Floats{0, 1}), Pair("offset", Floats{1, 2, 3})));
  EXPECT_THAT(reading_of("DEF S CylinderSensor { minAngle -2 offset 0.5 }").sensor.numbers,
              ElementsAre(Pair("disk_angle_rad", Floats{0.262F}), Pair("min", Floats{-2}), Pair("max", Floats{-1}),
                          Pair("offset", Floats{0.5})));
  EXPECT_THAT(reading_of("DEF S SphereSensor { offset 1 0 0 2 }").sensor.numbers,
              ElementsAre(Pair("offset", Floats{1, 0, 0, 2})));
  EXPECT_THAT(reading_of("DEF S ProximitySensor { size 4 5 6 }").sensor.numbers,
              ElementsAre(Pair("center", Floats{0, 0, 0}), Pair("size", Floats{4, 5, 6})));
  EXPECT_FALSE(reading_of("DEF S SphereSensor { enabled FALSE }").sensor.enabled);
}

// The next drag, whoever makes it, begins where the last one ended.
TEST(PageSensor, ADraggedOneKeepsItsOffsetByAnEdit) {
  const std::string knob = " DEF K Transform { } ROUTE S.";
  EXPECT_THAT(targets_of(reading_of("DEF S PlaneSensor { }" + knob + "translation_changed TO K.translation")),
              ElementsAre("translation_changed K.translation", "offset S.offset"));
  EXPECT_THAT(targets_of(reading_of("DEF S CylinderSensor { }" + knob + "rotation_changed TO K.set_rotation")),
              ElementsAre("rotation_changed K.rotation", "offset S.offset"));
  EXPECT_THAT(targets_of(reading_of("DEF S SphereSensor { }" + knob + "trackPoint_changed TO K.translation")),
              ElementsAre("trackPoint_changed K.translation", "offset S.offset"));
  EXPECT_THAT(
      targets_of(reading_of("DEF S SphereSensor { autoOffset FALSE }" + knob + "rotation_changed TO K.rotation")),
      ElementsAre("rotation_changed K.rotation"));
  EXPECT_THAT(targets_of(reading_of("DEF S SphereSensor { }")), IsEmpty()) << "it does nothing";
  EXPECT_THAT(targets_of(reading_of(
                  "DEF S CylinderSensor { } DEF C CylinderSensor { } ROUTE S.offset_changed TO C.set_offset")),
              ElementsAre("offset C.offset", "offset S.offset"));
}

TEST(PageSensor, SaysWhyARouteDoesNothing) {
  struct Case {
    const char *name, *text, *why;
  };
  for (const Case& c : {
           Case{"Over", "DEF S TouchSensor { } DEF L PointLight { } ROUTE S.isOver TO L.on",
                "its isOver would be an edit for each movement of the pointer"},
           Case{"Place", "DEF S ProximitySensor { } DEF K Transform { } ROUTE S.position_changed TO K.translation",
                "its position_changed would be an edit for each movement of the viewer"},
           Case{"Orientation",
                "DEF S ProximitySensor { } DEF K Transform { } ROUTE S.orientation_changed TO K.rotation",
                "its orientation_changed would be an edit for each movement of the viewer"},
           Case{"EventIn", "DEF S TouchSensor { } DEF V Viewpoint { } ROUTE S.isActive TO V.set_bind",
                "its isActive leads to what no edit can set"},
           Case{"Unnamed",
                "DEF S ProximitySensor { } DEF T TimeSensor { } DEF T TimeSensor { } ROUTE S.enterTime TO T.startTime",
                "its enterTime leads to what no edit can set"},
       }) {
    const SensorReading reading = reading_of(c.text);
    EXPECT_THAT(reading.left_out, ElementsAre(c.why)) << c.name;
    EXPECT_THAT(reading.sensor.targets, IsEmpty()) << c.name;
    EXPECT_THAT(reading.worked, IsEmpty()) << c.name;
  }
}

}  // namespace peerd::view::page_sensor_test
