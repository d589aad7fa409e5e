// Areas of interest over regions, as the simulator's oracle sees them: nothing in them is ever missing for longer than
// one latency and one tick, and little comes that is not in them.
#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::flock_regions_test {

const std::string kFlock = PEERD_SOURCE_DIR "/configs/scenarios/flock-regions.toml";
const std::filesystem::path kBest = PEERD_SOURCE_DIR "/configs/best.toml";
constexpr double kTick_ms = 1000.0 / 60.0;

struct Seen {
  measure::InterestRecord interest;
  std::vector<PeerLog> logs;
  [[nodiscard]] double received_over_interest() const {
    double received = 0.0, wanted = 0.0;
    for (const measure::PeerInterest& p : interest.peers) {
      received += static_cast<double>(p.received_bytes);
      wanted += static_cast<double>(p.interest_bytes);
    }
    return received / wanted;
  }
};

Seen see(std::vector<std::string> sets) {
  const config::Scenario scenario = testing_support::scenario_of(kFlock, sets, {kBest});
  const auto shared = must(share_world(scenario.world));
  if (scenario.runs.size() != 1) throw std::runtime_error("one run was meant");
  std::optional<measure::InterestRecord> interest;
  Seen seen;
  seen.logs = must(simulate(scenario.runs.front(), *shared, {}, {}, &interest));
  seen.interest = interest.value();
  return seen;
}

class FlockOverRegions : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Latencies_ms, FlockOverRegions, testing::Values(5, 100, 500),
                         testing::PrintToStringParamName());

TEST_P(FlockOverRegions, NothingIsMissingAndLittleComesForNothing) {
  const double latency_ms = GetParam();
  const Seen seen = see({"network.latency_ms=" + std::to_string(GetParam())});  // all of its 60 s
  ASSERT_EQ(seen.interest.peers.size(), 8u);
  EXPECT_GT(seen.interest.samples, 8u * 60 * 30 * 48) << "its own flock, at least";
  EXPECT_LE(seen.interest.longest_missing_ms, latency_ms + kTick_ms);
  EXPECT_LE(seen.interest.longest_outdated_ms, latency_ms + kTick_ms);
  EXPECT_LE(seen.received_over_interest(), 1.3);
  for (const measure::PeerInterest& p : seen.interest.peers) {
    SCOPED_TRACE(p.peer.value);
    EXPECT_GT(p.joins, 5u);
    EXPECT_GT(p.leaves, 5u);
    EXPECT_LE(p.joins_in_a_second, 8u);
    EXPECT_LT(p.groups, 32.0) << "fewer than half of 64";
  }
  for (const PeerLog& log : seen.logs) EXPECT_LT(log.groups_joined, 40u) << "at most at a time";
}

TEST(FlockOverRegions, ABroadcastBringsMuchMore) {
  const Seen regions = see({"network.latency_ms=100"}),  // all of its 60 s
      broadcast = see({"network.latency_ms=100", "regions.cell_m=0"});
  EXPECT_EQ(broadcast.interest.longest_missing_ms, 0.0);
  EXPECT_EQ(broadcast.interest.samples, regions.interest.samples) << "the same areas, the same flights";
  EXPECT_GT(broadcast.received_over_interest(), 1.3 * regions.received_over_interest());
  EXPECT_EQ(broadcast.logs.front().groups_joined, 1u);
  EXPECT_FALSE(broadcast.logs.front().counters.contains("regions_joined"));
  EXPECT_TRUE(regions.logs.front().counters.contains("regions_joined"));
}

TEST(FlockOverRegions, AtATwentiethLostNothingIsMissingForLongerThanAHello) {
  const Seen seen = see({"network.latency_ms=100", "network.loss=0.05", "duration_s=15"});
  EXPECT_LE(seen.interest.longest_missing_ms, 100.0 + 250.0 + kTick_ms);
  EXPECT_LT(static_cast<double>(seen.interest.missing_samples), 1e-4 * static_cast<double>(seen.interest.samples));
}

// The oracle can see a gap: here peers look no time ahead while states take two latencies.
TEST(FlockOverRegions, WithoutLookingAheadThereAreGaps) {
  const Seen seen = see({"network.latency_ms=500", "regions.lookahead_s=0", "regions.margin_m=0.01", "duration_s=15"});
  EXPECT_GT(seen.interest.longest_missing_ms, 500.0 + kTick_ms);
  EXPECT_GT(seen.interest.gaps, 0u);
}

TEST(FlockOverRegions, TheSameSeedGivesTheSame) {
  const std::vector<std::string> sets{"network.latency_ms=40", "network.jitter_ms=30", "network.loss=0.1",
                                      "duration_s=3"};
  const Seen a = see(sets), b = see(sets);
  for (std::size_t i = 0; i < a.logs.size(); ++i) EXPECT_EQ(a.logs[i].counters, b.logs[i].counters);
  EXPECT_EQ(a.received_over_interest(), b.received_over_interest());
}

}  // namespace peerd::sim::flock_regions_test
