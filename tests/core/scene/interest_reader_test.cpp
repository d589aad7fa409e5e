#include "core/scene/interest_reader.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::interest_reader_test {

using testing::ElementsAre;

TEST(KeySensors, AreRead) {
  const Scene scene = scene_of(R"(
    KeySensor { keyValue 65 keyState 3 recipient "G/CAR" value 1 -2 3 absoluteValue TRUE consume FALSE enabled FALSE }
    DEF G Group { children DEF CAR Transform { } }
    KeySensor { recipient "CAR" })");
  ASSERT_EQ(scene.key_sensors.size(), 2u);
  const KeySensor& a = scene.key_sensors[0];
  EXPECT_EQ(a.recipient, ObjectId{1});
  EXPECT_EQ(a.key_value, 65);
  EXPECT_EQ(a.key_state, 3);
  EXPECT_EQ(a.value, Vec3(1, -2, 3));
  EXPECT_TRUE(a.absolute);
  EXPECT_FALSE(a.consume);
  EXPECT_FALSE(a.enabled);
  const KeySensor& b = scene.key_sensors[1];
  EXPECT_FALSE(b.absolute);
  EXPECT_TRUE(b.consume);
  EXPECT_TRUE(b.enabled);
  EXPECT_EQ(scene.document->nodes[b.node].type->name, "KeySensor");
}

TEST(KeySensors, ReportWhatTheyCannotMove) {
  EXPECT_THAT(problems_of("KeySensor { }\nKeySensor { recipient \"CRA\" }\nKeySensor { recipient \"G\" }\nDEF CAR "
                          "Transform { } DEF G Group { }"),
              ElementsAre("warning 2:1: this KeySensor has no recipient: it moves nothing",
                          "3:23: no node of the scene is named 'CRA', did you mean 'CAR'?",
                          "4:23: 'G' is no Transform: it has no velocity that a key can change"));
}

TEST(KeySensors, InAProtoMoveItsOwnTransform) {
  const Scene scene = scene_of(R"(
    PROTO Car [ field SFInt32 key 0 ] { DEF BODY Transform { children KeySensor { keyValue IS key recipient "BODY" value 0 0 1 } } }
    DEF BODY Transform { } Car { key 1 } DEF C Car { key 2 })");
  ASSERT_EQ(scene.key_sensors.size(), 2u);
  EXPECT_EQ(scene.key_sensors[0].recipient, ObjectId{1});
  EXPECT_EQ(scene.key_sensors[1].recipient, ObjectId{2});
  EXPECT_EQ(scene.key_sensors[1].key_value, 2);
}

}  // namespace peerd::vrml::interest_reader_test
