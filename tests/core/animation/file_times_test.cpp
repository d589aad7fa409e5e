#include "core/animation/file_times.hpp"

#include <gmock/gmock.h>

#include "core/animation/network_reader.hpp"
#include "core/edit/scene_editor.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/writer/writer.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::file_times_test {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// LIFT goes 8 m along x in the first half of a cycle of 4 s, and comes back in the second.
std::string lift_with(const std::string& times) {
  return "DEF CLOCK TimeSensor { cycleInterval 4 " + times +
         " }\nDEF PATH PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 0 0 0, 8 0 0, 0 0 0 ] }\n"
         "DEF LIFT Transform { }\n"
         "ROUTE CLOCK.fraction_changed TO PATH.set_fraction ROUTE PATH.value_changed TO LIFT.set_translation\n";
}
double lift_at(const Scene& scene, double t) {
  PredefinedMotion motion(scene);
  return motion.rigid_pose(scene.find("LIFT").value(), t).position.x();
}

// A case has where LIFT is at 1 s, 3 s and 101 s, and words of the warning.
struct Case {
  const char* name;
  const char* times;
  double x[3];
  std::vector<const char*> warning;
};
class FileTimes : public testing::TestWithParam<Case> {};
TEST_P(FileTimes, CountFrom1970) {
  const Case& c = GetParam();
  const Scene scene = scene_of(lift_with(c.times));
  EXPECT_DOUBLE_EQ(lift_at(scene, 1.0), c.x[0]);
  EXPECT_DOUBLE_EQ(lift_at(scene, 3.0), c.x[1]);
  EXPECT_DOUBLE_EQ(lift_at(scene, 101.0), c.x[2]);
  const auto problems = problems_of(lift_with(c.times));
  ASSERT_EQ(problems.size(), c.warning.empty() ? 0u : 1u);
  for (const char* const words : c.warning) EXPECT_THAT(problems[0], HasSubstr(words));
}
INSTANTIATE_TEST_SUITE_P(
    Table, FileTimes,
    testing::Values(
        Case{"IdleLoop", "loop TRUE stopTime 1", {0, 0, 0}, {"warning 2:1: stopTime 1 counts", "does not move LIFT;"}},
        Case{"OneRun", "startTime 1", {0, 0, 0}, {"startTime 1 counts", "does not move LIFT;"}},
        Case{"Touched", "stopTime 1", {0, 0, 0}, {}}, Case{"Default", "", {0, 0, 0}, {}},
        Case{"Loop", "loop TRUE", {4, 4, 4}, {}},
        Case{"LateLoop", "loop TRUE startTime 2", {4, 4, 4}, {"startTime 2 counts", "runs", "moves LIFT;"}},
        Case{"StopBeforeStart", "loop TRUE startTime 2 stopTime 1", {4, 4, 4}, {"startTime 2 counts", "moves LIFT;"}},
        Case{"EarlyLoop", "loop TRUE startTime -1 stopTime -2", {4, 4, 4}, {"startTime -1 counts", "moves LIFT;"}},
        Case{"OverBefore", "loop TRUE startTime -2 stopTime -1", {0, 0, 0}, {}},
        Case{"LastPast", "loop TRUE stopTime 999999999", {0, 0, 0}, {"stopTime 999999999 counts"}},
        Case{"FirstFuture", "loop TRUE stopTime 1e9", {4, 4, 4}, {}},
        Case{"Never", "loop TRUE startTime 1e12", {0, 0, 0}, {}},
        Case{"Disabled", "loop TRUE enabled FALSE stopTime 1", {0, 0, 0}, {}}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(FileTimes, CountFromTheBeginningWhereTheWorldSaysSo) {
  const std::string text = "Group { children WorldInfo { worldTimes TRUE } }\n" + lift_with("loop TRUE startTime 2");
  const Scene scene = scene_of(text);
  EXPECT_THAT(problems_of(text), IsEmpty());
  EXPECT_DOUBLE_EQ(lift_at(scene, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(lift_at(scene, 3.0), 4.0);
  EXPECT_DOUBLE_EQ(lift_at(scene, 6.5), 2.0);
  EXPECT_DOUBLE_EQ(lift_at(scene_of("WorldInfo { worldTimes FALSE }\n" + lift_with("loop TRUE startTime 2")), 1.0),
                   4.0);
}

// A clock whose events start another one moves all that is behind both.
TEST(FileTimes, EachNodeThatMovesOtherwiseIsNamed) {
  const std::string text = lift_with("loop TRUE stopTime 1") +
                           "DEF B TimeSensor { } DEF Q CoordinateInterpolator { }\n"
                           "ROUTE CLOCK.cycleTime TO B.set_startTime ROUTE B.fraction_changed TO Q.set_fraction\n"
                           "Shape { geometry IndexedLineSet { coord DEF SAIL Coordinate { } } }\n"
                           "ROUTE Q.value_changed TO SAIL.set_point\n";
  EXPECT_THAT(problems_of(text), testing::Contains(HasSubstr("does not move LIFT and SAIL;")));
  EXPECT_THAT(problems_of("TimeSensor { loop TRUE stopTime 1 }"), IsEmpty()) << "it moves nothing";
  EXPECT_THAT(problems_of(lift_with("loop TRUE enabled FALSE stopTime 1") +
                          "DEF A TimeSensor { loop TRUE } ROUTE A.isActive TO CLOCK.enabled\n"),
              ElementsAre(HasSubstr("does not move LIFT;")));
}

// A stopTime of the file must not end a run that begins before that instant of the session.
TEST(FileTimes, ARunThatATouchBeginsIsNotEndedByTheFile) {
  const Scene file = scene_of(lift_with("stopTime 3"));
  const vrml::Node& clock = file.document->nodes[vrml::nodes_of_type(*file.document, "TimeSensor").at(0)];
  const animation::TimeSensorFields fields = vrml::sensor_fields_of(clock);
  animation::TimeSensorState touched = animation::read_sensor(fields, 0.0);
  EXPECT_EQ(animation::set(touched, animation::SensorInput::kStartTime, 2.0, 2.0), animation::SetResult::kSet);
  ASSERT_TRUE(animation::starts(touched, 2.0));
  animation::start(touched, 2.0);
  EXPECT_EQ(touched.end_s, 6.0);
}

// Times that edits set, or that are in a text added to a running world, count from the world's beginning. A file that
// is written of such a world has worldTimes TRUE, and reads back the same.
TEST(FileTimes, ThoseSetAtRunTimeAreSessionTime) {
  const Scene file = scene_of(lift_with("loop TRUE stopTime 1"));
  SceneEditor editor(file);
  const std::uint32_t clock = vrml::nodes_of_type(*file.document, "TimeSensor").at(0);
  ASSERT_TRUE(editor.set(file.document->ids.id_of(clock), "startTime", "2", {}).has_value());
  const std::string added = "#VRML V2.0 utf8\nDEF LATER TimeSensor { startTime 5 }\n";
  ASSERT_TRUE(editor.add(added, {}, {ObjectId(1, 7), NodeId(1, 7)}, {}).has_value());
  const auto edited = editor.finish();
  ASSERT_TRUE(edited.has_value());
  EXPECT_DOUBLE_EQ(lift_at(*edited, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(lift_at(*edited, 3.0), 4.0);
  const std::string text = write_world(*edited)->text;
  EXPECT_THAT(text, AllOf(HasSubstr("WorldInfo {\n  worldTimes TRUE\n}\n"), HasSubstr("startTime 5")));
  const ReadResult again = read_world(text);
  ASSERT_TRUE(again.scene);
  EXPECT_DOUBLE_EQ(lift_at(*again.scene, 3.0), 4.0);
  EXPECT_EQ(write_world(*again.scene)->text, text);
}

TEST(FileTimes, OfAFileAsItWasReadNeedNoSuchWord) {
  const std::string text = write_world(scene_of(lift_with("loop TRUE startTime 1 stopTime 3")))->text;
  EXPECT_THAT(text, testing::Not(HasSubstr("WorldInfo")));
  const ReadResult again = read_world(text);
  EXPECT_THAT(lines_of(again), IsEmpty());
  EXPECT_DOUBLE_EQ(lift_at(*again.scene, 1.0), 0.0);
}

}  // namespace peerd::file_times_test
