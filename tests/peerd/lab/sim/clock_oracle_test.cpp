#include "peerd/lab/sim/clock_oracle.hpp"

#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::clock_oracle_test {

std::vector<PeerLog> logs(std::vector<std::string> sets) {
  const std::string file = PEERD_SOURCE_DIR "/tests/sim/worlds/meeting.toml";
  sets.push_back("duration_s=4");
  const config::Scenario scenario = testing_support::scenario_of(file, std::move(sets));
  return must(simulate(scenario.runs.front(), *must(share_world(scenario.world))));
}

TEST(ClockOracle, TheLeaderHasNoErrorAndAFollowersIsSmallWhateverItsHostsClock) {
  const auto all = logs({"network.latency_ms=20", "network.jitter_ms=0", "peer.b.clock_offset_s=3"});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_FALSE(all[0].clock_error) << "it followed nobody";
  ASSERT_TRUE(all[1].clock_error);
  const PeerLog::ClockError& error = *all[1].clock_error;
  EXPECT_GT(error.samples, 200u) << "one for each tick";
  EXPECT_LE(error.p99, error.max);
  EXPECT_LT(error.max, std::chrono::milliseconds(1)) << "both ways take the same time";
  EXPECT_LE(error.bound_median, error.bound_max);
  EXPECT_EQ(error.beyond_bound, 0u);
}

TEST(ClockOracle, AOneSidedDelayIsAnErrorOfItsHalf) {
  const auto all = logs({"network.latency_ms=0", "network.jitter_ms=0", "network.link.a.b.latency_ms=80",
                         "network.link.b.a.latency_ms=0"});
  ASSERT_TRUE(all[1].clock_error);
  EXPECT_NEAR(to_seconds(all[1].clock_error->max), 0.040, 0.005);
  EXPECT_EQ(all[1].clock_error->beyond_bound, 0u) << "the bound covers it";
}

}  // namespace peerd::sim::clock_oracle_test
