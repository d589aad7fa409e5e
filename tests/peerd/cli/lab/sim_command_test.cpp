#include "peerd/cli/lab/sim_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <thread>

#include <nlohmann/json.hpp>

#include "peerd/cli/lab/scenario_options.hpp"
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

TEST_F(SimCommand, NamesWhatDoesNothingAndReportsIt) {
  folder.write("w.wrl",
               "#VRML V2.0 utf8\nDEF CAR Transform { children Shape { geometry Box { } } }\nDEF CLOCK TimeSensor { "
               "}\nROUTE CAR.notColliding TO CLOCK.enabled\n");
  EXPECT_EQ(run(), 0) << err;
  EXPECT_THAT(err, HasSubstr("w.wrl:4:11: warning: no peer runs this ROUTE from notColliding"));
  const auto summary = nlohmann::json::parse(testing_support::text_of(folder / "out/summary.json"));
  EXPECT_THAT(summary["warnings"].dump(), HasSubstr("this ROUTE from notColliding"));
}

TEST_F(SimCommand, HasNoServersBetweenItsPeers) {
  options.sets = {"network.via=nats"};
  EXPECT_EQ(run(), 2);
  EXPECT_THAT(err, HasSubstr("network.via: servers stand between real peers alone"));
}

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

TEST_F(SimCommand, CountsOneRunAsOne) {
  EXPECT_EQ(run(), 0) << err;
  EXPECT_THAT(out, HasSubstr("s of 1 run in "));
  EXPECT_THAT(out, testing::Not(HasSubstr("errors.csv has"))) << "it has all";
}

TEST_F(SimCommand, SamplesBoundTheFilesAndNotTheNumbers) {
  options.json = true;
  EXPECT_EQ(run(), 0) << err;
  const std::string all = out;
  const auto rows = [&](const char* file) {
    return std::ranges::count(testing_support::text_of(folder / "out" / file), '\n') - 1;
  };
  EXPECT_EQ(rows("errors.csv"), 31) << "60 a second";
  options.samples = "8";
  EXPECT_EQ(run(), 0) << err;
  EXPECT_EQ(out, all);
  EXPECT_EQ(rows("errors.csv"), 8);
  EXPECT_LE(rows("traffic.csv"), 8);
  options.samples = "none";
  EXPECT_EQ(run(), 0) << err;
  EXPECT_EQ(out, all);
  EXPECT_EQ(rows("errors.csv"), 0);
  options.json = false;
  EXPECT_EQ(run(), 0) << err;
  EXPECT_THAT(out, HasSubstr("errors.csv has 0 of 31 samples"));
  EXPECT_THAT(testing_support::text_of(folder / "out/report.html"), HasSubstr("errors.csv has 0 of 31 samples"));
  options.samples = "some";
  EXPECT_EQ(run(), 2);
}

// The capture shows how far the simulation is, so that nothing depends on how fast this computer is.
TEST_F(SimCommand, ASignalInTheMiddleOfARunLeavesWhatThereIs) {
  options.sets = {"duration_s=100000", "replication.order=[1, 2]", "expect.e={that = \"updates_sent\", at_least = 1}"};
  options.captures = folder / "captures";
  const auto capture = folder / "captures/run-001/a.pcapng";
  std::jthread killer([&] {
    std::error_code none_yet;
    while (!std::filesystem::exists(capture) || std::filesystem::file_size(capture, none_yet) < 200'000) {
      std::this_thread::yield();
    }
    kill(getpid(), SIGINT);
  });
  EXPECT_EQ(run(), 130);
  EXPECT_THAT(err, HasSubstr("stopped by SIGINT, in run 1 at "));
  EXPECT_THAT(out, HasSubstr("warning: stopped by SIGINT, in run 1 at "));
  EXPECT_THAT(out, HasSubstr("1 of 2 runs is not in here"));
  const auto summary = nlohmann::json::parse(testing_support::text_of(folder / "out/summary.json"));
  EXPECT_EQ(summary["stopped"], true);
  ASSERT_EQ(summary["runs"].size(), 1u);
  const double stopped_at_s = summary["runs"][0]["stopped_at_s"].get<double>();
  EXPECT_GT(stopped_at_s, 0.0);
  EXPECT_LT(stopped_at_s, 100000.0);
  EXPECT_NEAR(summary["runs"][0]["objects"][0]["samples"].get<double>(), 60.0 * stopped_at_s, 2.0);
  EXPECT_FALSE(summary.contains("expectations")) << "they are about the whole";
  EXPECT_THAT(testing_support::text_of(folder / "out/report.html"), HasSubstr("stopped by SIGINT"));
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
