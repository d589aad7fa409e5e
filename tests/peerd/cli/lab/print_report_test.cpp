#include "peerd/cli/lab/print_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/peerd/report_samples.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::print_report_test {

using testing::HasSubstr;
using testing::internal::CaptureStdout, testing::internal::GetCapturedStdout;

TEST(CommandLine, CanBeGivenToAShell) {
  const ScenarioOptions options{.scenario = "my scenarios/it's.toml",
                                .configs = {"configs/best.toml"},
                                .sets = {"network.latency_ms=5", "replication.order=[1, 2]"},
                                .seed = 7,
                                .out = "elsewhere"};
  EXPECT_EQ(command_line("sim", options),
            "peerd sim 'my scenarios/it'\\''s.toml' --config configs/best.toml --set network.latency_ms=5 "
            "--set 'replication.order=[1, 2]' --seed 7");
}

TEST(PrintReport, SaysByItsExitCodeWhetherExpectationsHeld) {
  const testing_support::ScratchFolder folder;
  const std::vector<measure::RunRecord> runs{measure::samples::zigzag_run(0.1)};
  const measure::ScenarioInfo info{"zigzag", "sim", 7, {}};
  config::Expectation expected{
      .name = "few", .that = "updates_sent", .object = "CAR", .where = nlohmann::ordered_json::object(), .runs = {0}};
  const auto print = [&](double at_most, bool json) {
    expected.at_most = at_most;
    CaptureStdout();
    const int code = print_report(info, runs, {&expected, 1}, folder / "out", json);
    return std::pair(code, GetCapturedStdout());
  };
  EXPECT_EQ(print(5, false).first, 0);
  const auto [code, text] = print(4, false);
  EXPECT_EQ(code, 1);
  EXPECT_THAT(text, HasSubstr("few"));
  const auto summary = nlohmann::json::parse(print(4, true).second);
  EXPECT_EQ(summary["expectations"][0]["held"], false);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/summary.json"));
}

}  // namespace peerd::print_report_test
