// replication.bounded_latency_ms and .._measured: all peers show all objects, own ones too, as they were published a
// bound ago.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <ostream>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::bounded_latency_test {

using namespace std::chrono_literals;

using testing_support::kEq47;

const std::string kHeadOn = PEERD_SOURCE_DIR "/configs/scenarios/head-on.toml";

std::uint64_t late_at(const replication::Peer& peer) {
  const auto& c = peer.counters();
  return c.updates_late + c.updates_missing + c.decisions_late;
}

// The picture that all peers show at the same session times, 60 times a second.
class Screens final : public PeersWatch {
 public:
  struct AtPeer {
    double worst_difference_m = 0.0;  // between what it and the owner show of an object
    std::uint64_t late = 0;           // what it has counted so far
  };

  [[nodiscard]] std::uint32_t rate_hz() const override { return 60; }
  void begin(SimTime start, HostTime) override { start_ = start; }
  void see(double, std::span<const SeenPeer> peers) override {
    SimTime t = SimTime::max();
    for (const SeenPeer& seen : peers) {
      const auto view = seen.node->advance_view(seen.host, last_);
      ASSERT_TRUE(view);
      t = std::min(t, *view);
    }
    if (last_ && t <= *last_) return;
    compare_bounds(t, peers);
    for (const SeenPeer& seen : peers) {
      const replication::Peer& peer = seen.node->peer();
      for (const auto& [object, owner] : peer.owners()) {
        if (owner == kNobody) continue;
        const auto of_owner = std::ranges::find(peers, owner, [](const SeenPeer& p) { return p.node->peer().id(); });
        compare(t, *seen.node, *of_owner->node, object);
      }
      by_peer[peer.id()].late = late_at(peer);
    }
    last_ = t;
    ++instants;
  }

  std::map<PeerId, AtPeer> by_peer;
  double worst_past_error_m = 0.0;  // of what owners show, against their objects' truth of then
  double shown_lag_m = 0.0;         // the greatest distance of an own object from where it is shown
  Duration least_bound = Duration::max(), most_bound{0};
  std::uint64_t bounds_differ = 0, jumps = 0, instants = 0;

 private:
  // At one session time all have one bound, and the time that is shown goes at most a tenth faster or slower.
  void compare_bounds(SimTime t, std::span<const SeenPeer> peers) {
    const Duration bound = *peers.front().node->bound(t);
    for (const SeenPeer& seen : peers) bounds_differ += *seen.node->bound(t) == bound ? 0 : 1;
    least_bound = std::min(least_bound, bound);
    most_bound = std::max(most_bound, bound);
    const Duration change = bound_ > bound ? bound_ - bound : bound - bound_;
    if (last_ && change > (t - *last_) / 10 + Duration{2}) ++jumps;
    bound_ = bound;
  }
  void compare(SimTime t, PeerNode& observer, PeerNode& owner, ObjectId object) {
    const Pose here = observer.shown(object, t), there = owner.shown(object, t);
    double& worst = by_peer[observer.peer().id()].worst_difference_m;
    worst = std::max(worst, (here.position - there.position).norm());
    if (here.orientation.coeffs() != there.orientation.coeffs()) {
      worst = std::max(worst, (here.orientation.coeffs() - there.orientation.coeffs()).norm());
    }
    if (&observer != &owner || t - bound_ < start_) return;
    const replication::Peer& peer = owner.peer();
    const Vec3 then = peer.truth(object, t - bound_).position;
    worst_past_error_m = std::max(worst_past_error_m, (there.position - then).norm());
    shown_lag_m = std::max(shown_lag_m, (there.position - peer.truth(object, t).position).norm());
  }

  SimTime start_{};
  std::optional<SimTime> last_;
  Duration bound_{0};
};

Screens watch(const std::string& file, const std::vector<std::string>& sets) {
  const config::Scenario scenario = testing_support::scenario_of(file, sets);
  EXPECT_EQ(scenario.runs.size(), 1u);
  const auto shared = must(share_world(scenario.world, scenario.reading, scenario.runs));
  Screens screens;
  (void)must(simulate(scenario.runs.front(), *shared, {}, {}, nullptr, nullptr, nullptr, {}, &screens));
  EXPECT_GT(screens.instants, 500u);
  return screens;
}

std::string set(const char* key, double value) { return std::string(key) + "=" + std::to_string(value); }

std::vector<std::string> eq47(double latency_ms, double bound_ms, double loss = 0.0, int seed = 1) {
  return {"replication.approach=dr+rcp+acpt",
          "replication.order=2",
          set("network.latency_ms", latency_ms),
          set("network.loss", loss),
          set("replication.bounded_latency_ms", bound_ms),
          "seed=" + std::to_string(seed)};
}
std::vector<std::string> head_on(const char* policy, double latency_ms, double bound_ms, double loss = 0.0,
                                 int seed = 1) {
  return {std::string("decisions.policy=") + policy,
          "decisions.compare=false",
          set("network.latency_ms", latency_ms),
          set("network.loss", loss),
          "network.jitter_ms=0",
          "network.reordering=0",
          set("replication.bounded_latency_ms", bound_ms),
          "seed=" + std::to_string(seed)};
}

void expect_one_picture(const Screens& screens) {
  for (const auto& [peer, seen] : screens.by_peer) {
    EXPECT_EQ(seen.late, 0u) << "peer " << peer.value;
    EXPECT_EQ(seen.worst_difference_m, 0.0) << "peer " << peer.value;
  }
  EXPECT_EQ(screens.bounds_differ, 0u);
  EXPECT_EQ(screens.jumps, 0u);
}

// The bound: the latency, a tick until an update goes out, and the same again.
constexpr double kTicks_ms = 35.0;

class AtLatency : public testing::TestWithParam<double> {};

// Own objects that were not delayed would be ahead of what others see by at least 8.4 m/s times the bound. The car is
// shown off its way by at most the threshold of 0.5 m and what a tick adds to it: at a corner it turns at once from
// 8.4 m/s to the one side to 8.4 m/s to the other.
TEST_P(AtLatency, AllScreensShowOneCarToTheLastBit) {
  const Screens screens = watch(kEq47, eq47(GetParam(), GetParam() + kTicks_ms));
  expect_one_picture(screens);
  EXPECT_GT(screens.shown_lag_m, 8.0 * 1e-3 * (GetParam() + kTicks_ms)) << "own objects are late, too";
  EXPECT_GT(screens.worst_past_error_m, 0.05) << "dead reckoning leaves an error";
  EXPECT_LT(screens.worst_past_error_m, 0.5 + 2.0 * 8.4 / 60.0);
}

// Cubes that weavers of another peer hit. The decider has to receive what the other owner has published before the
// contact, and all others the decision: that may take the latency twice. By `server` no owner decides, by `id` one of
// the two, and the other one's updates cross the decision.
TEST_P(AtLatency, NobodySeesADecisionOfTheServerCorrected) {
  expect_one_picture(watch(kHeadOn, head_on("server", GetParam(), 2.0 * GetParam() + kTicks_ms)));
}
TEST_P(AtLatency, NobodySeesADecisionOfAnOwnerCorrected) {
  expect_one_picture(watch(kHeadOn, head_on("id", GetParam(), 2.0 * GetParam() + kTicks_ms)));
}
INSTANTIATE_TEST_SUITE_P(Table, AtLatency, testing::Values(20.0, 100.0, 200.0));

// Whoever sees anything else than the owner has counted why, or the owner has, of a decision of another's. Without loss
// AtLatency sees no difference in the same scenarios.
class WithLoss : public testing::TestWithParam<int> {  // seeds
 protected:
  // Returns whether anything differed.
  static bool expect_counted(const std::string& file, const std::vector<std::string>& sets) {
    const Screens screens = watch(file, sets);
    std::uint64_t late = 0;
    bool differs = false;
    for (const auto& [peer, seen] : screens.by_peer) {
      late += seen.late;
      differs |= seen.worst_difference_m > 0.0;
    }
    if (differs) {
      EXPECT_GT(late, 0u);
    }
    return differs;
  }
};
TEST_P(WithLoss, WhatDiffersOfOneMoverIsCounted) {
  bool some_differ = false;
  for (const double latency_ms : {20.0, 100.0, 200.0}) {
    some_differ |= expect_counted(kEq47, eq47(latency_ms, latency_ms + kTicks_ms, 0.05, GetParam()));
  }
  EXPECT_TRUE(some_differ) << "nothing that this test is about was lost";
}
TEST_P(WithLoss, WhatDiffersOfThoseThatMeetIsCounted) {
  for (const char* policy : {"id", "server"}) {
    SCOPED_TRACE(policy);
    bool some_differ = false;
    for (const double latency_ms : {20.0, 100.0, 200.0}) {
      const double bound_ms = 2.0 * latency_ms + kTicks_ms;
      some_differ |= expect_counted(kHeadOn, head_on(policy, latency_ms, bound_ms, 0.01, GetParam()));
    }
    EXPECT_TRUE(some_differ) << "nothing that this test is about was lost";
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, WithLoss, testing::Values(1, 2, 3));

TEST(BoundedLatency, WhatComesAfterTheBoundIsCountedAndByHowMuch) {
  const auto sets = eq47(100.0, 60.0);
  const Screens screens = watch(kEq47, sets);
  for (const std::uint32_t observer : {2u, 3u}) {
    EXPECT_GT(screens.by_peer.at(PeerId{observer}).worst_difference_m, 0.1);
    EXPECT_GT(screens.by_peer.at(PeerId{observer}).late, 5u);
  }
  const auto ran = testing_support::run_scenario(kEq47, sets).front();
  EXPECT_GT(ran.summary["late"]["updates"], 10);
  EXPECT_EQ(ran.summary["late"]["updates_missing"], 0);
  EXPECT_GE(ran.summary["late"]["by_ms"], 40.0);
  EXPECT_LE(ran.summary["late"]["by_ms"], 40.0 + 17.0) << "an update may be of a tick before";
  EXPECT_EQ(ran.summary["shown_delay_ms"]["min"], 60.0);
  EXPECT_EQ(ran.summary["shown_delay_ms"]["max"], 60.0);
  EXPECT_GT(ran.view("c", "CAR")["view_difference_m"]["max"], 0.1);
}

// The report compares at the same session times.
TEST(BoundedLatency, TheReportSaysThatAllSeeTheSame) {
  const auto ran = testing_support::run_scenario(kEq47, eq47(100.0, 135.0)).front();
  EXPECT_EQ(ran.summary["late"]["updates"], 0);
  for (const auto& row : ran.summary["objects"]) EXPECT_EQ(row["view_difference_m"]["max"], 0.0) << row["path"];
  const double shown_error_m = ran.view("c", "CAR")["shown_error_m"]["mean"];  // at 8.4 to 12 m/s
  EXPECT_GT(shown_error_m, 8.4 * 0.135);
  EXPECT_LT(shown_error_m, 12.0 * 0.135);
  const auto without = testing_support::run_scenario(kEq47, eq47(100.0, 0.0)).front();
  EXPECT_FALSE(without.summary.contains("shown_delay_ms") || without.summary.contains("late"));
  EXPECT_FALSE(without.summary["counters"].contains("updates_late"));
  EXPECT_GT(without.view("c", "CAR")["view_difference_m"]["max"], 0.05);
}

std::string slow(const std::string& from, const std::string& to, int at_s, int latency_ms) {
  const std::string ms = std::to_string(latency_ms);
  return "event." + from + to + ms + "={at_s = " + std::to_string(at_s) + ", kind = \"network\", from = \"" + from +
         "\", to = \"" + to + "\", latency_ms = " + ms + "}";
}

// The link of one peer becomes slow at 7 s, and quick again at 12 s: all follow at one rate, at the same times.
TEST(BoundedLatency, AMeasuredBoundFollowsTheLatencyOnAllScreensAlike) {
  const Screens screens =
      watch(kEq47, {"replication.approach=dr+rcp+acpt", "replication.order=2", "network.latency_ms=20",
                    "replication.bounded_latency_measured=true", "duration_s=30", slow("a", "c", 7, 180),
                    slow("c", "a", 7, 180), slow("a", "c", 12, 20), slow("c", "a", 12, 20)});
  EXPECT_EQ(screens.bounds_differ, 0u);
  EXPECT_EQ(screens.jumps, 0u);
  EXPECT_EQ(screens.least_bound, 50ms + 35ms);
  EXPECT_EQ(screens.most_bound, 250ms + 35ms) << "180 ms and at least 25 ms, in steps of 50 ms";
  EXPECT_EQ(screens.by_peer.at(PeerId{2}).worst_difference_m, 0.0) << "its link stayed as it was";
  EXPECT_GT(screens.by_peer.at(PeerId{3}).late, 0u) << "until the bound had grown";
}

}  // namespace peerd::sim::bounded_latency_test
