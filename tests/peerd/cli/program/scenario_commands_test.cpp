#include <gmock/gmock.h>

#include <string>

#include <nlohmann/json.hpp>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::scenario_commands_test {

using testing::HasSubstr;
using testing_support::kMovingBox;
using testing_support::kStillWorld;
using testing_support::Program;
using testing_support::Said;

TEST_F(Program, MotionsWithoutEffectAreNamed) {
  folder.write("w.wrl", std::string(kStillWorld) + "DEF FLOOR Transform { }\n");
  folder.write("s.toml", std::string(kMovingBox) + "[motion.FLOOR]\nx = \"t\"\n");
  const Said said = run("sim s.toml");
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.err, HasSubstr("s.toml:8:1: warning: motion.FLOOR has no effect: no peer owns what it names"));
  EXPECT_THAT(said.out, HasSubstr("0 s of 1 run in "));
}

TEST_F(Program, RunsAtOnceGiveTheBytesOfRunsInTurn) {
  const std::string sweep = "sim " PEERD_SOURCE_DIR "/configs/scenarios/eq47.toml --set duration_s=3 --json --jobs ";
  const Said in_turn = run(sweep + "1 --out in-turn"), at_once = run(sweep + "4 --out at-once");
  ASSERT_EQ(in_turn.exit_code, 0) << in_turn.err;
  EXPECT_EQ(at_once.exit_code, 0) << at_once.err;
  EXPECT_EQ(in_turn.out, at_once.out);
  EXPECT_GT(nlohmann::json::parse(in_turn.out)["runs"].size(), 4u);
  for (const char* file : {"summary.json", "errors.csv", "traffic.csv", "report.html"}) {
    const std::string name = file;
    EXPECT_EQ(testing_support::text_of(folder / ("in-turn/" + name)),
              testing_support::text_of(folder / ("at-once/" + name)))
        << name;
  }
}

TEST_F(Program, ComparesSystemsInARowForEach) {
  const std::string baselines = PEERD_SOURCE_DIR "/configs/baselines/";
  const Said said = run("compare " PEERD_SOURCE_DIR "/configs/scenarios/eq47.toml --set duration_s=4 --with " +
                        baselines + "lockstep.toml --with " + baselines + "dis.toml --out compared --json");
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const auto json = nlohmann::json::parse(said.out);
  ASSERT_EQ(json["systems"].size(), 3u);
  EXPECT_EQ(json["systems"][0]["system"], "peerd") << "the scenario as it is";
  EXPECT_EQ(json["systems"][1]["system"], "lockstep");
  EXPECT_EQ(json["systems"][1]["view_difference_m"], 0.0);
  EXPECT_GT(json["systems"][2]["view_difference_m"], 0.0);
  EXPECT_THAT(testing_support::text_of(folder / "compared/compare.html"), HasSubstr("lockstep"));
  EXPECT_EQ(nlohmann::json::parse(testing_support::text_of(folder / "compared/compare.json")), json);
}

// The program is in its build, and finds what its sources have.
TEST_F(Program, ComparesByNameFromABuild) {
  const Said said = run("compare eq47 --set duration_s=2 --with server --out named --json");
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const auto json = nlohmann::json::parse(said.out);
  ASSERT_EQ(json["systems"].size(), 2u);
  EXPECT_EQ(json["systems"][1]["system"], "server");
  const Said all = run("compare eq47 --set duration_s=1 --out all --json");
  ASSERT_EQ(all.exit_code, 0) << all.err;
  EXPECT_GT(nlohmann::json::parse(all.out)["systems"].size(), 5u) << "all that there are";
}

TEST_F(Program, OtherSystemsAreSimulatedAlone) {
  const Said said =
      run("run -c " PEERD_SOURCE_DIR "/configs/scenarios/eq47.toml --peer a --set baseline.system=lockstep");
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_THAT(said.err, HasSubstr("peerd sim"));
}

}  // namespace peerd::scenario_commands_test
