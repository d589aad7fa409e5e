#include "peerd/peer/node/key_report.hpp"

#include <gtest/gtest.h>

#include "core/scene/reader.hpp"

namespace peerd::key_report_test {

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { children Shape { geometry Box { } } }
DEF PUSH KeySensor { recipient "A" keyValue 65 value 2 0 0 }
KeySensor { keyValue 65 }
)";

struct KeyReportTest : testing::Test {
  // One report of a key that two sensors got.
  KeyReportTest() {
    report.key = {'A', 0};
    report.hits = 2;
    KeyReport::Change change;
    change.recipient = *scene.find("A");
    change.velocity_world = {2, 0, -0.5};
    report.changes = {change};
  }
  std::vector<std::string> lines() const {
    std::vector<std::string> all;
    for (const LogLine& line : describe(report, scene)) {
      all.push_back(std::to_string(static_cast<int>(line.level)) + " " + line.text);
    }
    return all;
  }
  using Lines = std::vector<std::string>;

  Scene scene = read_world(kWorld).scene.value();
  KeyReport report;
};

TEST_F(KeyReportTest, IsDoneWhereASensorGotTheKeyAndEveryChangeWasMade) {
  EXPECT_TRUE(report.done());
  report.changes.emplace_back().refused = "no";
  EXPECT_FALSE(report.done());
  report.changes.clear();
  EXPECT_TRUE(report.done()) << "sensors without a recipient change nothing";
  report.hits = 0;
  EXPECT_FALSE(report.done());
  report.hits = 1;
  report.refused = "too early";
  EXPECT_FALSE(report.done());
}

TEST_F(KeyReportTest, SensorsAreNamedByDefOrByIndex) {
  EXPECT_EQ(name_of_sensor(scene, 0), "PUSH");
  EXPECT_EQ(name_of_sensor(scene, 1), "KeySensor 1");
}

TEST_F(KeyReportTest, EachChangeHasALine) {
  EXPECT_EQ(lines(), Lines{"1 A: PUSH changes the velocity of A by (2, 0, -0.5) m/s"});
  report.changes[0].absolute = true;
  EXPECT_EQ(lines(), Lines{"1 A: PUSH sets the velocity of A to (2, 0, -0.5) m/s"});
  report.changes[0].refused = "no peer runs it";
  EXPECT_EQ(lines(), Lines{"2 A: PUSH does not move A: no peer runs it"});
}

TEST_F(KeyReportTest, AReportWithoutChangesHasOneLine) {
  report.changes.clear();
  EXPECT_EQ(lines(), Lines{"1 A: 2 KeySensors got it"});
  report.hits = 0;
  EXPECT_EQ(lines(), Lines{"1 A: no enabled KeySensor listens to it"});
  report.refused = "too early";
  EXPECT_EQ(lines(), Lines{"2 A does nothing: too early"});
}

}  // namespace peerd::key_report_test
