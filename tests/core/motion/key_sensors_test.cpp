#include "core/motion/key_sensors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/reader.hpp"

namespace peerd::key_sensors_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr KeyEvent kA{'A', 0}, kB{'B', 0}, kUp{0x1013, 0};

class KeySensorsTest : public testing::Test {
 protected:
  // Makes a world of these nodes and ROUTEs beside a Transform CAR.
  void read(const std::string& nodes) {
    result = read_world("#VRML V2.0 utf8\nDEF CAR Transform { }\nDEF T TimeSensor { }\n" + nodes);
    ASSERT_TRUE(result.scene) << result.diagnostics.front().message;
    sensors.emplace(*result.scene);
  }
  std::vector<std::string> warnings() const {
    std::vector<std::string> texts;
    for (const Diagnostic& d : result.diagnostics) texts.push_back(d.message);
    return texts;
  }
  std::vector<std::size_t> hits(const KeyEvent& key) { return sensors->press(key).hits; }

  ReadResult result;
  std::optional<KeySensors> sensors;
};

std::string sensor(const std::string& name, const KeyEvent& key, const std::string& more = "consume FALSE") {
  return "DEF " + name + " KeySensor { recipient \"CAR\" keyValue " + std::to_string(key.value) + " keyState " +
         std::to_string(key.state) + " " + more + " }\n";
}
std::string route(const std::string& from, const std::string& to) { return "ROUTE " + from + " TO " + to + "\n"; }

TEST_F(KeySensorsTest, OnlyTheKeyAndItsStateHit) {
  read(sensor("X", {0x1013, 0x100}));
  EXPECT_THAT(hits({0x1013, 0x100}), ElementsAre(0));
  EXPECT_THAT(hits({0x1013, 0}), IsEmpty());
  EXPECT_THAT(hits({0x1013, 0x300}), IsEmpty());
  EXPECT_THAT(hits({0x1012, 0x100}), IsEmpty());
  EXPECT_FALSE(sensors->press(kA).consumed);
}

TEST_F(KeySensorsTest, AWorldMayBeWrittenInTheNumbersOfALaterQt) {
  read(sensor("X", {0x01000013, 0x02000000}) + sensor("Y", {0x1013, 0x0100}));
  EXPECT_THAT(hits({0x1013, 0x100}), ElementsAre(0, 1));
  EXPECT_THAT(hits({0x01000013, 0x02000000}), ElementsAre(0, 1));
}

TEST_F(KeySensorsTest, AKeyMayHaveItsName) {
  read("KeySensor { recipient \"CAR\" key \"shift+ArrowUp\" } KeySensor { recipient \"CAR\" key \"Space\" }");
  EXPECT_THAT(hits({0x1013, 0x100}), ElementsAre(0));
  EXPECT_THAT(hits(kUp), IsEmpty());
  EXPECT_THAT(hits({' ', 0}), ElementsAre(1));
}

TEST_F(KeySensorsTest, ANameOfNoKeyIsNoKey) {
  read("KeySensor { recipient \"CAR\" key \"ArowUp\" }");
  EXPECT_THAT(hits(kUp), IsEmpty());
  EXPECT_THAT(hits({0, 0}), IsEmpty());
  EXPECT_THAT(key_of(result.scene->key_sensors[0]).error(), HasSubstr("did you mean \"ArrowUp\"?"));
}

// A key that goes down sets in motion what its release stops.
TEST_F(KeySensorsTest, APressAndAReleaseAreTwoKeys) {
  read(sensor("GO", kUp) + sensor("STOP", {kUp.value, 0x100}, "onRelease TRUE absoluteValue TRUE"));
  EXPECT_THAT(hits(kUp), ElementsAre(0));
  EXPECT_THAT(hits({kUp.value, 0, true}), ElementsAre(1)) << "whatever is held down then";
  EXPECT_THAT(hits({kUp.value, 0x200, true}), ElementsAre(1));
  EXPECT_THAT(hits({'A', 0, true}), IsEmpty());
}

TEST_F(KeySensorsTest, AreAskedInFileOrderUntilOneConsumes) {
  read(sensor("FIRST", kA) + "Group { children " + sensor("SECOND", kA, "consume TRUE") + "}\n" + sensor("THIRD", kA) +
       sensor("OTHER", kB));
  const KeySensors::Outcome a = sensors->press(kA);
  EXPECT_THAT(a.hits, ElementsAre(0, 1));
  EXPECT_TRUE(a.consumed);
  const KeySensors::Outcome b = sensors->press(kB);
  EXPECT_THAT(b.hits, ElementsAre(3));
  EXPECT_FALSE(b.consumed);
}

TEST_F(KeySensorsTest, ConsumeIsTheDefaultAndADisabledSensorConsumesNothing) {
  read(sensor("OFF", kA, "enabled FALSE") + sensor("ON", kA, "") + sensor("NEVER", kA));
  EXPECT_THAT(hits(kA), ElementsAre(1));
}

TEST_F(KeySensorsTest, KeyHitEnablesAndDisablesOthers) {
  read(sensor("START", kA) + sensor("STOP", kB) + sensor("GO", kUp, "enabled FALSE") +
       route("START.keyHit", "GO.set_enabled") + route("STOP.keyHit", "GO.disable"));
  EXPECT_THAT(hits(kUp), IsEmpty());
  EXPECT_THAT(hits(kA), ElementsAre(0));
  EXPECT_THAT(hits(kUp), ElementsAre(2));
  EXPECT_THAT(hits(kUp), ElementsAre(2)) << "and stays so";
  EXPECT_THAT(hits(kB), ElementsAre(1));
  EXPECT_THAT(hits(kUp), IsEmpty());
}

TEST_F(KeySensorsTest, TwoOnOneKeyTakeTurns) {
  read(sensor("GO", kA) + sensor("HALT", kA, "consume FALSE enabled FALSE") + route("GO.keyHit", "HALT.enabled") +
       route("GO.keyHit", "GO.disable") + route("HALT.keyHit", "GO.enabled") + route("HALT.keyHit", "HALT.disable"));
  for (int round = 0; round < 3; ++round) {
    EXPECT_THAT(hits(kA), ElementsAre(0)) << "who gets it is decided before what it changes";
    EXPECT_THAT(hits(kA), ElementsAre(1));
  }
}

TEST_F(KeySensorsTest, DisableIsTheOppositeOfEnabled) {
  read(sensor("SWITCH", kA) + sensor("X", kUp, "consume FALSE enabled FALSE") + sensor("Y", kUp) + sensor("BACK", kB) +
       route("SWITCH.keyHit", "X.enabled") + route("BACK.keyHit", "X.disable") +
       route("X.enabled_changed", "Y.disable"));
  EXPECT_THAT(hits(kUp), ElementsAre(2));
  EXPECT_THAT(hits(kA), ElementsAre(0));
  EXPECT_THAT(hits(kUp), ElementsAre(1)) << "disable TRUE";
  EXPECT_THAT(hits(kB), ElementsAre(3));
  EXPECT_THAT(hits(kUp), ElementsAre(2)) << "disable FALSE";
}

TEST_F(KeySensorsTest, OfSeveralEventsTheShortestWayCountsAndThenTheLastRoute) {
  read(sensor("HIT", kA) + sensor("X", kUp) + sensor("Y", kUp) + sensor("Z", kUp) + route("HIT.keyHit", "X.disable") +
       route("X.enabled", "Y.enabled") +                                      // Y FALSE, over two ROUTEs
       route("HIT.keyHit", "Y.enabled") +                                     // Y TRUE, over one: counts
       route("HIT.keyHit", "Z.enabled") + route("HIT.keyHit", "Z.disable"));  // the last: FALSE
  EXPECT_THAT(hits(kA), ElementsAre(0));
  EXPECT_FALSE(sensors->enabled(1));
  EXPECT_TRUE(sensors->enabled(2));
  EXPECT_FALSE(sensors->enabled(3));
}

TEST_F(KeySensorsTest, ALoopEndsAfterOneEventEach) {
  read(sensor("HIT", kA) + sensor("X", kUp) + sensor("Y", kUp) + route("HIT.keyHit", "X.disable") +
       route("X.enabled", "Y.disable") + route("Y.enabled", "X.enabled"));
  EXPECT_THAT(hits(kA), ElementsAre(0));
  EXPECT_FALSE(sensors->enabled(1));
  EXPECT_TRUE(sensors->enabled(2));
  EXPECT_THAT(hits(kUp), ElementsAre(2));
}

TEST_F(KeySensorsTest, ManyInAChainAreTold) {
  constexpr int kLinks = 2000;
  std::string world = sensor("HIT", kA);
  for (int i = 0; i < kLinks; ++i) world += sensor("S" + std::to_string(i), kB);
  world += route("HIT.keyHit", "S0.disable");
  for (int i = 1; i < kLinks; ++i) {
    world += route("S" + std::to_string(i - 1) + ".enabled", "S" + std::to_string(i) + ".enabled");
  }
  read(world);
  EXPECT_EQ(hits(kB).size(), kLinks);
  EXPECT_EQ(hits(kA).size(), 1u);
  EXPECT_THAT(hits(kB), IsEmpty());
}

// ---- what the reader says of them ----

TEST_F(KeySensorsTest, ARouteToSomethingElseIsWarnedOf) {
  read(sensor("X", kA) + route("X.keyHit", "T.enabled"));
  ASSERT_EQ(warnings().size(), 1u);
  EXPECT_THAT(warnings()[0], HasSubstr("this ROUTE to a TimeSensor is not run"));
  EXPECT_EQ(result.diagnostics[0].severity, Severity::kWarning);
  EXPECT_EQ(result.diagnostics[0].where.line, 5u);
  EXPECT_THAT(hits(kA), ElementsAre(0));
}

TEST_F(KeySensorsTest, ARouteFromSomethingElseIsWarnedOf) {
  read(sensor("X", kA) + route("T.isActive", "X.enabled"));
  ASSERT_EQ(warnings().size(), 1u);
  EXPECT_THAT(warnings()[0], HasSubstr("this ROUTE from a TimeSensor is not run"));
}

TEST_F(KeySensorsTest, WithoutARecipientItMustAtLeastTellOthers) {
  read("DEF ALONE KeySensor { keyValue 66 }\nDEF TELLS KeySensor { keyValue 65 recipient \"\" }\n" + sensor("X", kUp) +
       route("TELLS.keyHit", "X.disable"));
  ASSERT_EQ(warnings().size(), 1u);
  EXPECT_THAT(warnings()[0], HasSubstr("no recipient"));
  EXPECT_FALSE(result.scene->key_sensors[1].recipient);
  EXPECT_THAT(hits(kA), ElementsAre(1));
  EXPECT_THAT(hits(kUp), IsEmpty());
}

TEST(KeySensors, OfAWorldWithoutAnyHearNothing) {
  KeySensors sensors{Scene{}};
  EXPECT_THAT(sensors.press(kA).hits, IsEmpty());
}

}  // namespace peerd::key_sensors_test
