// Chaos as a person sees it, with a simulation that fails where the test says so.
#include "peerd/cli/lab/chaos_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/lab/chaos/chaos_run.hpp"

namespace peerd::chaos_command_test {

using chaos::ChaosPlan;
using chaos::ChaosReport;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::internal::CaptureStderr, testing::internal::CaptureStdout;
using testing::internal::GetCapturedStderr, testing::internal::GetCapturedStdout;

class ChaosCommand : public testing::Test {
 protected:
  int run() {
    CaptureStdout();
    CaptureStderr();
    const int code = run_chaos_seeds(options, [&](const ChaosPlan& plan) {
      ++runs;
      ChaosReport report;
      report.seed = plan.seed;
      const bool has_edit = std::ranges::any_of(plan.edits, [](const auto& edit) { return edit.number == 3; });
      if (plan.seed == 5 && has_edit) report.violations.push_back("at 1.000 s: edit 3");
      return report;
    });
    out = GetCapturedStdout();
    err = GetCapturedStderr();
    return code;
  }
  ChaosOptions options;
  std::string out, err;
  int runs = 0;
};

TEST_F(ChaosCommand, AViolationIsPrintedWithASmallerRunThatFails) {
  options.seeds = "4..6";
  EXPECT_EQ(run(), 1);
  EXPECT_THAT(out, AllOf(HasSubstr("seed 4: good"), HasSubstr("seed 5: VIOLATED"), HasSubstr("seed 6: good")));
  EXPECT_THAT(out, AllOf(HasSubstr("at 1.000 s: edit 3"), HasSubstr("again: peerd sim --chaos 5\n"),
                         HasSubstr("1 of 3 seeds with a violation")));
  const auto smaller = out.find("smaller, with 2 peers, 0 faults and 1 edit ");
  ASSERT_NE(smaller, std::string::npos) << out;
  const std::string line = out.substr(smaller, out.find('\n', smaller) - smaller);
  EXPECT_THAT(line, HasSubstr("peerd sim --chaos 5 --chaos-seconds 22 --chaos-peers 2 --chaos-without f"));
  chaos::ChaosLimits limits{.seconds = 22.0, .peers = 2};
  ASSERT_TRUE(chaos::read_without(line.substr(line.rfind(' ') + 1), limits));
  const ChaosPlan plan = chaos::draw_plan(5, limits);
  EXPECT_TRUE(plan.faults.empty());
  ASSERT_EQ(plan.edits.size(), 1U);
  EXPECT_EQ(plan.edits[0].number, 3U);
}

TEST_F(ChaosCommand, NobodyLooksForASmallerRunUnasked) {
  options.seeds = "5";
  options.shrinks = false;
  EXPECT_EQ(run(), 1);
  EXPECT_EQ(runs, 1);
  EXPECT_THAT(out, Not(HasSubstr("smaller")));
}

TEST_F(ChaosCommand, InJsonEachRunIsALineAndTheRestIsElsewhere) {
  options.seeds = "5";
  options.count = 2;
  options.json = true;
  EXPECT_EQ(run(), 1);
  const auto first = nlohmann::json::parse(out.substr(0, out.find('\n')));
  EXPECT_EQ(first["seed"], 5);
  EXPECT_EQ(first["violations"].size(), 1U);
  EXPECT_EQ(std::ranges::count(out, '\n'), 2);
  EXPECT_THAT(err, AllOf(HasSubstr("again: "), HasSubstr("smaller, ")));
}

TEST_F(ChaosCommand, WhatIsNoSeedOrNoListIsNamed) {
  for (const char* const seeds : {"x", "-1", "5..4", "1..", "1..2..3"}) {
    options.seeds = seeds;
    EXPECT_EQ(run(), 2);
    EXPECT_THAT(err, HasSubstr(fmt::format("--chaos {}: write a seed", seeds)));
  }
  options.seeds = "1..2";
  options.count = 2;
  EXPECT_EQ(run(), 2) << "two ways to say how many";
  options.count = 1;
  options.without = "f3,";
  EXPECT_EQ(run(), 2);
  EXPECT_THAT(err, HasSubstr("--chaos-without f3,: write a list"));
  EXPECT_EQ(runs, 0);
}

}  // namespace peerd::chaos_command_test
