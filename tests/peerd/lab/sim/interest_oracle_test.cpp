#include "peerd/lab/sim/interest_oracle.hpp"

#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::interest_oracle_test {

measure::InterestRecord interest(std::vector<std::string> sets) {
  const std::string file = PEERD_SOURCE_DIR "/tests/sim/worlds/street.toml";
  sets.insert(sets.end(), {"duration_s=4", "network.jitter_ms=0", "replication.proximity=surfaces"});
  const config::Scenario scenario = testing_support::scenario_of(file, std::move(sets));
  std::optional<measure::InterestRecord> found;
  must(simulate(scenario.runs.front(), *must(share_world(scenario.world)), {}, {}, &found));
  return found.value();
}

TEST(InterestOracle, AsksOnlyWhereAPeerHasAnArea) {
  config::RunSettings run;
  run.peers.resize(2);
  EXPECT_FALSE(InterestOracle::has_areas(run));
  run.peers[1].interest_radius_m = 5.0;
  EXPECT_TRUE(InterestOracle::has_areas(run));
}

TEST(InterestOracle, NothingIsMissingWhereEverythingGoesToEverybody) {
  const auto found = interest({"network.latency_ms=100", "peer.b.interest_radius_m=1000"});
  EXPECT_GT(found.samples, 200u);
  EXPECT_EQ(found.missing_samples, 0u);
  EXPECT_EQ(found.gaps, 0u);
  EXPECT_EQ(found.latency_ms, 100.0);
  EXPECT_GE(found.longest_outdated_ms, 50.0) << "an update is under way for 100 ms";
  EXPECT_LE(found.longest_outdated_ms, 100.0 + 1e3 / 60);
  ASSERT_EQ(found.peers.size(), 1u) << "a has no area";
  EXPECT_EQ(found.peers.front().objects, 1.0) << "CAR, all the time";
  EXPECT_GT(found.peers.front().interest_bytes, 0u);
}

TEST(InterestOracle, WhatIsFarAwayIsNotInTheArea) {
  const auto found =
      interest({"network.latency_ms=5", "peer.b.interest_radius_m=0", "peer.b.viewpoint={position = [0, 5000, 0]}"});
  EXPECT_EQ(found.samples, 0u);
  EXPECT_EQ(found.peers.front().objects, 0.0);
  EXPECT_EQ(found.peers.front().interest_bytes, 0u);
  EXPECT_GT(found.peers.front().received_bytes, 0u) << "without regions it comes nevertheless";
}

}  // namespace peerd::sim::interest_oracle_test
