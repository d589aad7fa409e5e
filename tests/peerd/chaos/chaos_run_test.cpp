// Peers in one world while everything fails that can: what must hold does, for these seeds.
#include "peerd/chaos/chaos_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace peerd::chaos::chaos_run_test {

// Runs of 22 s and up to five peers instead of 60 s and nine, so that 60 seeds take less than a minute.
ChaosLimits short_run() {
  ChaosLimits limits;
  limits.seconds = 22.0;
  limits.peers = 5;
  return limits;
}

class Chaos : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Chaos, testing::Range(std::uint64_t{1}, std::uint64_t{61}),
                         testing::PrintToStringParamName());

// Seeds whose violations are not mended yet. A seed that holds again must leave this list.
//  7: a peer never has an outcome of a contact that the others have.
// 14: a text of 60 kB reaches nobody whole within 10 s after its author was back.
bool is_open(std::uint64_t seed) { return seed == 7 || seed == 14; }

TEST_P(Chaos, NothingThatMustHoldIsViolated) {
  const ChaosPlan plan = draw_plan(GetParam(), short_run());
  const ChaosReport report = run_chaos(plan);
  EXPECT_EQ(report.violations.empty(), !is_open(GetParam()))
      << testing::PrintToString(report.violations) << "peerd sim " << options_of(GetParam(), plan.limits);
  EXPECT_GT(report.operations, 0u);
  EXPECT_GT(report.datagrams, 1000u);
}

TEST(ChaosRun, OneSeedIsOneTrace) {
  const ChaosReport a = run_chaos(draw_plan(3, short_run())), b = run_chaos(draw_plan(3, short_run()));
  EXPECT_EQ(a.trace_hash, b.trace_hash);
  EXPECT_EQ(a.branches, b.branches);
  EXPECT_NE(a.trace_hash, run_chaos(draw_plan(4, short_run())).trace_hash);
}

TEST(ChaosRun, AnEditLessIsAnotherTrace) {
  ChaosLimits limits = short_run();
  const ChaosPlan whole = draw_plan(3, limits);
  limits.without_edits.insert(whole.edits.at(0).number);
  EXPECT_NE(run_chaos(whole).trace_hash, run_chaos(draw_plan(3, limits)).trace_hash);
}

}  // namespace peerd::chaos::chaos_run_test
