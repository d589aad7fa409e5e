// The approaches of others are configurations of the same peers: configs/baselines.
#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::baselines_test {

using testing_support::kEq47;
using testing_support::Ran;
using testing_support::run_scenario;

// eq47 at 100 ms. CAR does 8.5 m/s and belongs to a.
Ran run(const std::string& baseline, std::vector<std::string> sets = {}) {
  sets.push_back("network.latency_ms=100");
  auto runs = run_scenario(kEq47, sets, {PEERD_SOURCE_DIR "/configs/baselines/" + baseline + ".toml"});
  EXPECT_EQ(runs.size(), 1u);
  return std::move(runs.front());
}
double mean_m(const Ran& ran, const char* what) { return ran.view("b", "CAR")[what]["mean"].get<double>(); }
constexpr double kSpeed_m_s = 8.5;

TEST(Baselines, DeadReckoningKeepsToItsThreshold) {
  for (const char* name : {"dis", "npsnet", "position-history"}) {
    SCOPED_TRACE(name);
    const Ran ran = run(name);
    EXPECT_GT(ran.updates("CAR"), 5u);
    EXPECT_LT(ran.updates("CAR"), 60u);
    EXPECT_GT(mean_m(ran, "ghost_error_m"), 0.05);
    EXPECT_LT(mean_m(ran, "ghost_error_m"), 1.0);
    EXPECT_EQ(mean_m(ran, "view_difference_m"), mean_m(ran, "shown_error_m"));
  }
}

// States that go through one peer, as through a server, and are shown late enough to have two of them.
std::vector<std::string> relayed(std::vector<std::string> sets = {}) {
  for (const char* set : {"replication.order=2", "replication.snapshots_hz=20",
                          "replication.display_delay_measured=true", "relay.through=c"}) {
    sets.emplace_back(set);
  }
  return sets;
}

// The delay is the way there and back, 0.2 s, and an interval of 0.05 s; the oldest update waited for ticks besides, at
// most four.
TEST(Baselines, BehindARelayOthersAreSeenLateAndOnesOwnAtOnce) {
  const Ran ran = run("dis", relayed());
  EXPECT_NEAR(static_cast<double>(ran.updates("CAR")), 300, 5);
  EXPECT_GE(ran.summary["counters"]["updates_relayed"], 300);
  EXPECT_GT(mean_m(ran, "shown_error_m"), 0.245 * kSpeed_m_s);
  EXPECT_LT(mean_m(ran, "shown_error_m"), 0.32 * kSpeed_m_s);
  EXPECT_NEAR(mean_m(ran, "view_difference_m"), mean_m(ran, "shown_error_m"), 1e-3);
}

TEST(Baselines, WhereOwnObjectsAreDelayedTheOwnerWaitsAsWell) {
  const Ran ran = run("dis", relayed({"replication.delay_own=true", "relay.restamps=true"}));
  EXPECT_GT(mean_m(ran, "shown_error_m"), 0.24 * kSpeed_m_s);
  EXPECT_LT(mean_m(ran, "view_difference_m"), 0.13 * kSpeed_m_s) << "restamped: what is one way late looks prompt";
}

TEST(Baselines, WithStatesOfEachTickAllSeeTheSameLate) {
  const Ran ran = run(
      "dis", {"replication.snapshots_hz=60", "replication.display_delay_measured=true", "replication.delay_own=true"});
  EXPECT_NEAR(static_cast<double>(ran.updates("CAR")), 900, 5);
  EXPECT_NEAR(mean_m(ran, "shown_error_m"), 0.117 * kSpeed_m_s, 0.02 * kSpeed_m_s);
  EXPECT_LT(mean_m(ran, "view_difference_m"), 0.02);
}

// A user whose own input waits as long as the network takes sees the same as the others; dead reckoning can do that,
// too.
TEST(Baselines, LocalLagHidesLatency) {
  const Ran at_once = run("dis"), late = run("dis", {"replication.display_delay_ms=150", "replication.delay_own=true"});
  EXPECT_LT(mean_m(late, "view_difference_m"), 0.7 * mean_m(at_once, "view_difference_m"));
  EXPECT_GT(mean_m(late, "shown_error_m"), 0.14 * kSpeed_m_s);
}

}  // namespace peerd::sim::baselines_test
