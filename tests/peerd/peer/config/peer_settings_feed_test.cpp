// `outside = true` and [peer.NAME.feed].
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/lab/sim/simulation.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "tests/must.hpp"
#include "tests/peerd/peer/config/scenario_text.hpp"

namespace peerd::config::peer_settings_feed_test {

using testing::HasSubstr;

class ConfigFeed : public testing_support::ScenarioText {
 protected:
  ConfigFeed() : ScenarioText("world = \"w.wrl\"\n[peer.a]\nid = 1\nowns = [\"CAR\"]\n") {
    folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { children Shape { geometry Box { } } }\n");
  }
};

TEST_F(ConfigFeed, SaysWhatAProgramMovesAndWhereItSpeaks) {
  const Scenario s = read("[peer.a.motion.CAR]\noutside = true\n[peer.a.feed]\nudp = \"127.0.0.1:0\"\nstale_s = 2\n");
  const PeerSettings& a = s.runs.front().peers.front();
  EXPECT_TRUE(std::holds_alternative<motion::ExternalProgram>(a.motion.at("CAR").kind));
  EXPECT_EQ(a.feed.udp, "127.0.0.1:0");
  EXPECT_EQ(a.feed.stale_s, 2.0);
}

TEST_F(ConfigFeed, ByDefaultThereIsNoPort) {
  const Scenario s = read("[peer.a.motion.CAR]\noutside = true\n");
  EXPECT_EQ(s.runs.front().peers.front().feed.udp, "");
}

TEST_F(ConfigFeed, FalseLeavesAFormula) {
  const Scenario s = read("[peer.a.motion.CAR]\noutside = false\nx = \"t\"\n");
  EXPECT_EQ(std::get<motion::MotionFormula>(s.runs.front().peers.front().motion.at("CAR").kind).x, "t");
}

struct Wrong {
  const char *name, *text, *error;
};
class WrongFeed : public ConfigFeed, public testing::WithParamInterface<Wrong> {};
TEST_P(WrongFeed, IsOneSentenceAtItsPlace) { expect_refused(GetParam().text, "", GetParam().error); }
INSTANTIATE_TEST_SUITE_P(
    Table, WrongFeed,
    testing::Values(Wrong{"FormulaToo", "[peer.a.motion.CAR]\noutside = true\nx = \"t\"\n",
                          "peer.a.motion.CAR.x: outside = true leaves all to a program"},
                    Wrong{"NoBool", "[peer.a.motion.CAR]\noutside = 1\n", "must be true or false"},
                    Wrong{"Misspelt", "[peer.a.motion.CAR]\noutside = true\n[peer.a.feed]\nupd = \"1\"\n",
                          "did you mean peer.a.feed.udp?"},
                    Wrong{"StaleAtOnce", "[peer.a.motion.CAR]\noutside = true\n[peer.a.feed]\nstale_s = 0\n",
                          "peer.a.feed.stale_s = 0 is out of range"}),
    [](const auto& c) { return std::string(c.param.name); });

TEST_F(ConfigFeed, ASimulationHasNoProgramOutside) {
  const Scenario s = read("[peer.a.motion.CAR]\noutside = true\n");
  EXPECT_THAT(error_of(sim::simulate(s.runs.front(), **share_world(s.world))),
              IsError(2, HasSubstr("peer.a leaves \"CAR\" to a program outside, which runs in real time")));
}

TEST_F(ConfigFeed, APortNeedsSomethingToMove) {
  const Scenario s = read("[peer.a.feed]\nudp = \"1\"\n");
  EXPECT_THAT(error_of(sim::simulate(s.runs.front(), **share_world(s.world))).text,
              HasSubstr("peer.a.feed.udp: no program moves anything here"));
}

}  // namespace peerd::config::peer_settings_feed_test
