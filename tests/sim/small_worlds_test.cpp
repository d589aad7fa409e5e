// Small worlds: a body that turns, a ball at a wall, balls that nobody owns, a car in a street.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::small_worlds_test {

using testing::HasSubstr;
using testing_support::Ran;
using testing_support::run_scenario;

const std::string kWorlds = PEERD_SOURCE_DIR "/tests/sim/worlds/";

double worst_angle_rad(const Ran& ran) {
  double worst = 0;
  for (const auto& s : ran.record.ghost_samples) {
    worst = std::max(worst, angle_between(s.truth.orientation, s.ghost.orientation));
  }
  return worst;
}

TEST(Turner, ASteadyTurnIsDeadReckonedExactly) {
  const Ran ran = run_scenario(kWorlds + "turner.toml").front();
  ASSERT_GT(ran.record.ghost_samples.size(), 500u);
  const auto& first = ran.record.ghost_samples.front();
  const auto& later = ran.record.ghost_samples[60];
  EXPECT_GT(angle_between(first.truth.orientation, later.truth.orientation), 1.0) << "it does turn";
  EXPECT_LT(worst_angle_rad(ran), 1e-3);
  EXPECT_LE(ran.updates("TURNER"), 3u) << "one in five seconds is all that it takes";
  EXPECT_LT(ran.mean_error_m("b", "TURNER"), 1e-6) << "it stays where it is";
}

TEST(Turner, AnUnsteadyTurnIsHeldToTheAngleThreshold) {
  const auto swing = [](const std::string& threshold_deg) {
    return run_scenario(kWorlds + "turner.toml", {"peer.a.motion.TURNER.angle=sin(2*t)", "network.latency_ms=5",
                                                  "replication.angle_threshold_deg=" + threshold_deg})
        .front();
  };
  const Ran fine = swing("1"), coarse = swing("10");
  constexpr double kDegree = std::numbers::pi / 180;
  // One tick and the latency add at most twice the spin of 2 rad/s for 17 + 5 ms.
  EXPECT_LT(worst_angle_rad(fine), 1 * kDegree + 0.09);
  EXPECT_GT(worst_angle_rad(coarse), 9 * kDegree);
  EXPECT_LT(worst_angle_rad(coarse), 10 * kDegree + 0.09);
  EXPECT_GT(fine.updates("TURNER"), coarse.updates("TURNER") + 5);
}

// A sphere is a mesh of many polygons and isn't a convex piece.
TEST(Ball, BouncesOffTheWallAsTheBoxDoes) {
  const auto shared = must(share_world(kWorlds + "ball.wrl"));
  EXPECT_THAT(shared->model->unsupported, testing::IsEmpty());
  const Ran ran = run_scenario(kWorlds + "ball.toml").front();
  const auto id = [&](const char* path) {
    return std::ranges::find(ran.record.objects, path, &measure::ObjectInfo::path)->object;
  };
  for (const char* name : {"BALL", "BOX"}) {
    std::size_t hits = 0;
    for (const auto& c : ran.record.contacts) hits += c.collider == id(name) && c.kind == "owner";
    EXPECT_EQ(hits, 1u) << name;
    for (const auto& s : ran.record.ghost_samples) {
      if (s.object != id(name)) continue;
      EXPECT_LT(s.ghost.position.x(), 18.51) << "20 - 0.5 - 1: " << name;
    }
  }
  EXPECT_EQ(ran.summary["counters"]["contact_searches_unsupported"], 0);
}

// Whoever strikes a ball of nobody's decides, and all agree, whatever the policy and the network.
TEST(Struck, BallsOfNobodyHaveOneOutcome) {
  for (const std::string policy : {"id", "velocity", "field-of-view", "expected-error", "server"}) {
    for (const std::string latency_ms : {"0", "50", "200"}) {
      SCOPED_TRACE(policy + " at " + latency_ms + " ms");
      const std::vector<std::string> sets{"decisions.policy=" + policy, "decisions.server=c",
                                          "network.latency_ms=" + latency_ms, "network.loss=0.05"};
      const Ran ran = run_scenario(kWorlds + "struck.toml", sets).front();
      std::map<PeerId, std::vector<double>> times_s;  // by peer: of contacts with an outcome for all
      for (const auto& c : ran.record.contacts) {
        if (c.kind == "decided" || c.kind == "applied") times_s[c.peer].push_back(c.t_s);
      }
      for (auto& [peer, times] : times_s) std::ranges::sort(times);
      EXPECT_GE(times_s[PeerId{1}].size(), 2u);
      EXPECT_EQ(times_s[PeerId{2}], times_s[PeerId{1}]);
      EXPECT_EQ(times_s[PeerId{3}], times_s[PeerId{1}]);
      EXPECT_EQ(run_scenario(kWorlds + "struck.toml", sets).front().summary["counters"], ran.summary["counters"]);
    }
  }
}

// A long wall's sphere contains places where the wall is not: these cost no update.
TEST(Street, AlongAWallOnlySpheresRaiseTraffic) {
  const auto ran = run_scenario(kWorlds + "street.toml");
  ASSERT_EQ(ran.size(), 2u);
  const std::size_t spheres = ran[0].updates("CAR"), surfaces = ran[1].updates("CAR");
  EXPECT_GT(spheres, 5 * surfaces);
  EXPECT_LT(surfaces, 12u);
  EXPECT_GT(ran[1].summary["counters"]["proximity_refined"], 400);
}

}  // namespace peerd::sim::small_worlds_test
