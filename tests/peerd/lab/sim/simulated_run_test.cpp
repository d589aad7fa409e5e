#include "peerd/lab/sim/simulated_run.hpp"

#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::simulated_run_test {

const std::string kMeeting = PEERD_SOURCE_DIR "/tests/sim/worlds/meeting.toml";

measure::RunRecord run(std::vector<std::string> sets) {
  const config::Scenario scenario = testing_support::scenario_of(kMeeting, std::move(sets));
  return must(simulated_run(scenario.runs.front(), *must(share_world(scenario.world))));
}

TEST(SimulatedRun, ComparesWithTheTruthWhereAsked) {
  const measure::RunRecord record = run({"decisions.compare=true"});
  ASSERT_TRUE(record.wrong);
  EXPECT_GT(record.wrong->truth, 0u) << "LEFT meets RIGHT";
}

TEST(SimulatedRun, JudgesAreasOfInterest) { EXPECT_TRUE(run({"peer.a.interest_radius_m=50"}).interest); }

}  // namespace peerd::sim::simulated_run_test
