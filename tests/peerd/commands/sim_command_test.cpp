#include "peerd/commands/sim_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "peerd/commands/scenario_options.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::sim_command_test {

using testing::HasSubstr;
using testing::internal::CaptureStderr, testing::internal::CaptureStdout;
using testing::internal::GetCapturedStderr, testing::internal::GetCapturedStdout;

class SimCommand : public testing::Test {
 protected:
  SimCommand() {
    folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { children Shape { geometry Box { } } }\n");
    options.scenario = folder.write("s.toml", R"(world = "w.wrl"
duration_s = 0.5
[peer.a]
id = 1
owns = ["CAR"]
[peer.a.motion.CAR]
x = "t"
[peer.b]
id = 2
)");
    options.out = folder / "out";
  }
  int run() {
    CaptureStdout();
    CaptureStderr();
    const int code = run_sim(options);
    out = GetCapturedStdout();
    err = GetCapturedStderr();
    return code;
  }
  testing_support::ScratchFolder folder;
  ScenarioOptions options;
  std::string out, err;
};

TEST_F(SimCommand, WritesAReportAndPrintsItsTable) {
  EXPECT_EQ(run(), 0) << err;
  EXPECT_THAT(out, HasSubstr("times real time"));
  EXPECT_THAT(out, HasSubstr("CAR"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/report.html"));
}

TEST_F(SimCommand, JsonIsTheSummaryAndNothingElse) {
  options.json = true;
  options.sets = {"replication.order=[1, 2]"};
  EXPECT_EQ(run(), 0) << err;
  const auto summary = nlohmann::json::parse(out);
  EXPECT_EQ(summary["mode"], "sim");
  EXPECT_EQ(summary["runs"].size(), 2u);
  EXPECT_EQ(out, testing_support::text_of(folder / "out/summary.json"));
}

TEST_F(SimCommand, OldNamesOfKeysWarnAndGiveTheSameNumbers) {
  options.json = true;
  options.sets = {"replication.piggyback_fraction=0.5"};
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(err.find("warning"), std::string::npos);
  auto now = nlohmann::json::parse(out);
  options.sets = {"replication.along_at=0.5"};
  EXPECT_EQ(run(), 0);
  EXPECT_THAT(err, HasSubstr("warning: --set replication.along_at is now called replication.piggyback_fraction\n"));
  EXPECT_EQ(nlohmann::json::parse(out)["runs"], now["runs"]);
}

TEST_F(SimCommand, ASweepsCapturesStandInAFolderForEachRun) {
  options.sets = {"replication.order=[1, 2]"};
  options.captures = folder / "captures";
  EXPECT_EQ(run(), 0) << err;
  for (const char* file : {"run-001/a.pcapng", "run-001/b.pcapng", "run-002/a.pcapng", "run-002/b.pcapng"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "captures" / file)) << file;
  }
}

TEST_F(SimCommand, AMissedExpectationIsOne) {
  options.sets = {"expect.e={that = \"updates_sent\", at_least = 1000}"};
  EXPECT_EQ(run(), 1);
  EXPECT_THAT(out, HasSubstr("updates_sent"));
}

TEST_F(SimCommand, AWrongScenarioIsTwo) {
  options.sets = {"duration_s=abc"};
  EXPECT_EQ(run(), 2);
  EXPECT_THAT(err, HasSubstr("duration_s must be a number"));
}

}  // namespace peerd::sim_command_test
