// Peers whose contacts another engine finds, at ticks: [collision] engine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::engines_test {

using testing::Each;
using testing::SizeIs;
using testing_support::Ran;
using testing_support::run_scenario;

const std::string kMeeting = PEERD_SOURCE_DIR "/tests/sim/worlds/meeting.toml";
const std::string kHeadOn = PEERD_SOURCE_DIR "/configs/scenarios/head-on.toml";

// When the peers' decision says that the two cubes met, as each peer has it [s].
std::vector<double> decided_at(const Ran& ran) {
  std::vector<double> times;
  for (const measure::ContactRow& c : ran.record.contacts) {
    if (c.kind == "decided" || c.kind == "applied") times.push_back(c.t_s);
  }
  return times;
}

// The cubes touch after 19 m at 3 m/s: 6.3333 s, between the ticks 316 and 317 of 50 Hz.
TEST(EnginesOfPeers, FindTheContactAtTheNextTick) {
  constexpr double kTrue_s = 19.0 / 3.0;
  for (const char* engine : {"ours", "obb", "kdop,k=14", "i-collide"}) {
    const Ran ran =
        run_scenario(kMeeting, {"replication.tick_hz=50", std::string("collision.engine=\"") + engine + "\""}).front();
    const std::vector<double> times = decided_at(ran);
    ASSERT_THAT(times, SizeIs(testing::Ge(2u))) << engine;
    if (std::string(engine) == "ours") {
      for (const double t : times) EXPECT_NEAR(t, kTrue_s, 1e-6);
    } else {
      EXPECT_THAT(times, Each(testing::DoubleNear(6.34, 1e-8))) << engine;
    }
  }
}

// Peers with ticks of their own ask at the session's.
TEST(EnginesOfPeers, AskAtTheTicksOfTheSession) {
  const Ran ran = run_scenario(kMeeting, {"replication.tick_hz=50", "peer.a.tick_hz=144", "peer.b.tick_hz=30",
                                          "collision.engine=\"obb\""})
                      .front();
  EXPECT_THAT(decided_at(ran), testing::Contains(testing::DoubleNear(6.34, 1e-8)).Times(testing::Ge(2u)));
}

TEST(EnginesOfPeers, LeaveOneOutcomeForAll) {
  for (const Ran& ran :
       run_scenario(kHeadOn, {"collision.engine=\"obb\"", "decisions.policy=\"id\"", "network.latency_ms=100",
                              "network.loss=0", "decisions.compare=false"})) {
    const auto& collisions = ran.summary["collisions"];
    EXPECT_GE(collisions["decided"], 10);
    EXPECT_EQ(collisions["disagreed"], 0);
    EXPECT_EQ(collisions["missed"], 0);
    for (const double t_s : decided_at(ran)) {
      const double ticks = 60.0 * t_s;
      EXPECT_NEAR(ticks, std::round(ticks), 1e-6);
    }
  }
}

}  // namespace peerd::sim::engines_test
