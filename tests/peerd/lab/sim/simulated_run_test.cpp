#include "peerd/lab/sim/simulated_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "peerd/lab/cluster/result_bytes.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::simulated_run_test {

const std::string kMeeting = PEERD_SOURCE_DIR "/tests/sim/worlds/meeting.toml";

measure::RunRecord run(std::vector<std::string> sets, const Progress& progress = {}) {
  const config::Scenario scenario = testing_support::scenario_of(kMeeting, std::move(sets));
  return must(simulated_run(scenario.runs.front(), *must(share_world(scenario.world)), {}, {}, nullptr, {}, progress));
}

TEST(SimulatedRun, ComparesWithTheTruthWhereAsked) {
  const measure::RunRecord record = run({"decisions.compare=true"});
  ASSERT_TRUE(record.wrong);
  EXPECT_GT(record.wrong->truth, 0u) << "LEFT meets RIGHT";
}

TEST(SimulatedRun, JudgesAreasOfInterest) { EXPECT_TRUE(run({"peer.a.interest_radius_m=50"}).interest); }

// A signal that comes while the last updates still arrive leaves a whole run, with all of its traffic.
TEST(SimulatedRun, IsNotStoppedAfterItsEnd) {
  std::vector<bool> answers;
  const measure::RunRecord record = run({"duration_s=2"}, [&](std::optional<double> run_s) {
    answers.push_back(!run_s || *run_s < 2.0);
    return answers.back();
  });
  ASSERT_FALSE(answers.back()) << "it lingers";
  EXPECT_FALSE(record.stopped);
  EXPECT_TRUE(cluster::to_bytes({record, {}}) == cluster::to_bytes({run({"duration_s=2"}), {}}));
}

TEST(SimulatedRun, IsStoppedWhereTheComparisonIs) {
  double latest_s = 0.0;
  const auto until_the_second_run = [&](std::optional<double> run_s) {
    latest_s = std::max(latest_s, run_s.value_or(0.0));
    return latest_s < 2.0 || run_s >= 2.0;
  };
  const measure::RunRecord record = run({"duration_s=2", "decisions.compare=true"}, until_the_second_run);
  EXPECT_TRUE(record.stopped);
  EXPECT_EQ(record.duration_s, 2.0);
  EXPECT_FALSE(record.wrong);
}

}  // namespace peerd::sim::simulated_run_test
