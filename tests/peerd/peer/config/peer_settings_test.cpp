// [[peer.NAME.key]], [control] and the convergence of [replication].
#include <gtest/gtest.h>

#include "tests/peerd/peer/config/scenario_text.hpp"

namespace peerd::config::peer_settings_test {

class ConfigKeys : public testing_support::ScenarioText {
 protected:
  ConfigKeys() : ScenarioText("world = \"w.wrl\"\n[peer.a]\nid = 1\n") {}
};

TEST_F(ConfigKeys, AreReadByNameOrNumberAndSortedByTime) {
  const Scenario s = read(R"([[peer.a.key]]
at_s = 3
key = "ArrowUp"
shift = true
[[peer.a.key]]
at_s = 1.5
value = 16777235
state = 33554432
[[peer.a.key]]
at_s = 3
key = "Enter"
keypad = true
)");
  const auto& keys = s.runs.front().peers.front().keys;
  ASSERT_EQ(keys.size(), 3u);
  EXPECT_EQ(keys[0].at_s, 1.5);
  EXPECT_EQ(keys[0].key, (KeyEvent{16777235, 33554432})) << "as written: a sensor's comparison makes them one";
  EXPECT_EQ(keys[1].key, (KeyEvent{0x1013, 0x100})) << "of one time: as in the file";
  EXPECT_EQ(keys[2].key, (KeyEvent{0x1005, 0x4000}));
}

TEST_F(ConfigKeys, MayBeSetAsAList) {
  const Scenario s = read("", {R"(peer.a.key=[{at_s = 1, key = "a"}, {at_s = 2, key = "b"}])"});
  ASSERT_EQ(s.runs.size(), 1u) << "no sweep";
  EXPECT_EQ(s.runs.front().peers.front().keys.size(), 2u);
  EXPECT_EQ(s.runs.front().params["peer.a.key"][1]["key"], "b");
}

struct Wrong {
  const char *name, *text, *error;
};
class WrongKeys : public ConfigKeys, public testing::WithParamInterface<Wrong> {};
TEST_P(WrongKeys, AreOneSentenceAtTheirPlace) { expect_refused(GetParam().text, "", GetParam().error); }
INSTANTIATE_TEST_SUITE_P(
    Table, WrongKeys,
    testing::Values(
        Wrong{"UnknownName", "[[peer.a.key]]\nat_s = 1\nkey = \"ArowUp\"\n",
              ":6:7: error: peer.a.key.key: there is no key \"ArowUp\"; did you mean \"ArrowUp\"?"},
        Wrong{"NoTime", "[[peer.a.key]]\nkey = \"a\"\n", "peer.a.key.at_s is missing"},
        Wrong{"BeforeTheStart", "[[peer.a.key]]\nat_s = -1\nkey = \"a\"\n", "peer.a.key.at_s = -1 is out of range"},
        Wrong{"NoKey", "[[peer.a.key]]\nat_s = 1\n", "give either a key's name or its value"},
        Wrong{"Both", "[[peer.a.key]]\nat_s = 1\nkey = \"a\"\nvalue = 65\n", "give either a key's name or its value"},
        Wrong{"StateOfAName", "[[peer.a.key]]\nat_s = 1\nkey = \"a\"\nstate = 1\n",
              "peer.a.key.state belongs to value"},
        Wrong{"ShiftOfAValue", "[[peer.a.key]]\nat_s = 1\nvalue = 65\nshift = true\n",
              "its modifiers are numbers too, in state"},
        Wrong{"NoBool", "[[peer.a.key]]\nat_s = 1\nkey = \"a\"\nshift = 1\n", "peer.a.key.shift must be true or false"},
        Wrong{"UnknownMember", "[[peer.a.key]]\nat_s = 1\nkey = \"a\"\nshfit = true\n",
              ":7:1: error: unknown key peer.a.key.shfit; did you mean peer.a.key.shift?"},
        Wrong{"NoList", "[peer.a.key]\nat_s = 1\nkey = \"a\"\n", "write each as [[peer.a.key]]"},
        Wrong{"ListOfNumbers", "key = [1, 2]\n", "write each as [[peer.a.key]]"},
        Wrong{"ValueTooLarge", "[[peer.a.key]]\nat_s = 1\nvalue = 3000000000\n", "value = 3000000000 is out of range"},
        Wrong{"ControlIsNoString", "[control]\nsocket = 3\n", "control.socket must be a string"},
        Wrong{"ControlHasOneKey", "[control]\nsoket = \"a\"\n", "did you mean control.socket?"}),
    [](const auto& c) { return std::string(c.param.name); });

// Nodes that the file marks as remote converge, unless the configuration says a way for all.
TEST_F(ConfigKeys, ConvergenceIsOfAllNodesOrOfThoseThatTheFileMarks) {
  using enum replication::ConvergenceMethod;
  const auto methods = [&](std::vector<std::string> sets) {
    const config::ReplicationSettings r = read("", std::move(sets)).runs.front().replication;
    return std::pair(r.convergence.method, r.remote_convergence.method);
  };
  EXPECT_EQ(methods({}), std::pair(kJump, kParabola));
  EXPECT_EQ(methods({"replication.convergence=jump"}), std::pair(kJump, kJump));
  EXPECT_EQ(methods({"replication.convergence=cubic"}), std::pair(kCubic, kCubic));
}

TEST_F(ConfigKeys, TheControlSocketStandsBesideTheScenario) {
  EXPECT_FALSE(read("").runs.front().control.socket);
  EXPECT_EQ(read("[control]\nsocket = \"\"\n").runs.front().control.socket, "") << "none, and no default either";
  EXPECT_EQ(read("[control]\nsocket = \"{peer}.sock\"\n").runs.front().control.socket,
            (folder / "{peer}.sock").string());
  EXPECT_EQ(read("[control]\nsocket = \"/run/x.sock\"\n").runs.front().control.socket, "/run/x.sock");
}

}  // namespace peerd::config::peer_settings_test
