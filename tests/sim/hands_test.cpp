// configs/scenarios/hands.toml: an object changes hands while the session runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::hands_test {

using namespace testing_support;

const std::string kHands = PEERD_SOURCE_DIR "/configs/scenarios/hands.toml";

TEST(Hands, OneOwnerAtATimeAndTheSameForAll) {
  const auto world = must(config::load_world(PEERD_SOURCE_DIR "/configs/worlds/keys.wrl"));
  const ObjectId red = world.scene.find("RED").value();
  for (const char* seed : {"1", "2", "3"}) {
    const Ran ran = run_scenario(kHands, {"seed=" + std::string(seed)}).front();
    int checked = 0;
    EXPECT_EQ(ran.summary["counters"]["objects_given"], 15);
    // own, own and refusal by a; own, give and refusal by b and c: 1 b takes, 3 c asks and b gives, 5 a and c ask and
    // are refused, 7 c releases, 8 a takes, 10 b steals.
    EXPECT_EQ(ran.summary["counters"]["operations"], 10);
    for (const PeerLog& log : ran.logs) {
      for (const auto& sample : log.object_samples) {
        if (sample.object != red) continue;
        const double t = to_seconds(sample.at - *log.start);
        const PeerId owner = t < 3.0 ? PeerId{2} : t < 7.0 ? PeerId{3} : t < 10.0 ? PeerId{1} : PeerId{2};
        const bool is_settled = (t > 1.5 && t < 3.0) || (t > 4.0 && t < 7.0) || (t > 8.5 && t < 10.0) || t > 10.5;
        if (!is_settled) continue;
        ++checked;
        EXPECT_EQ(sample.owner, owner) << t << " s";
      }
    }
    EXPECT_GT(checked, 1000);
  }
}

// Without latency the new owner's first update is there before the operation takes effect, at a peer whose tick of that
// instant is still to come.
TEST(Hands, GiveAlikeWithoutLatency) {
  for (const char* latency_ms : {"0", "0.05"}) {
    const Ran ran = run_scenario(kHands, {"network.latency_ms=" + std::string(latency_ms)}).front();
    EXPECT_EQ(ran.summary["counters"]["objects_given"], 15) << latency_ms << " ms";
  }
}

TEST(Hands, NobodyStealsWhereTheWorldDoesNotAllowIt) {
  const auto world = must(config::load_world(PEERD_SOURCE_DIR "/configs/worlds/keys.wrl"));
  const ObjectId red = world.scene.find("RED").value();
  const Ran ran = run_scenario(kHands, {"replication.steal=false"}).front();
  EXPECT_EQ(ran.summary["counters"]["objects_given"], 12);
  EXPECT_EQ(ran.summary["counters"]["operations"], 9);
  int late = 0;
  for (const PeerLog& log : ran.logs) {
    for (const auto& sample : log.object_samples) {
      if (sample.object != red || to_seconds(sample.at - *log.start) < 11.0) continue;
      ++late;
      EXPECT_EQ(sample.owner, PeerId{1});
    }
  }
  EXPECT_GT(late, 100);
}

}  // namespace peerd::sim::hands_test
