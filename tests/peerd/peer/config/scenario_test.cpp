#include "peerd/peer/config/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/peer/config/scenario_text.hpp"

namespace peerd::config::scenario_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::ScratchFolder;

constexpr const char* kTwoPeers = R"(world = "some.wrl"
duration_s = 4

[replication]
order = 1

[network]
latency_ms = 5
jitter_ms = 1

[network.link.a.b]
loss = 0.25

[peer.zoe]
id = 3
[peer.a]
id = 1
owns = ["CAR"]
[peer.a.motion.CAR]
x = "t"
[peer.b]
id = 2
owns = ["CUBE"]
)";

class ScenarioTest : public testing_support::ScenarioText {
 protected:
  static std::vector<std::string> params(const Scenario& scenario) {
    std::vector<std::string> texts;
    for (const RunSettings& run : scenario.runs) texts.push_back(run.params.dump());
    return texts;
  }
};

TEST_F(ScenarioTest, PhysicsStandsInPlaceOfFormulas) {
  const std::string text = R"(world = "some.wrl"
[peer.a]
id = 1
owns = ["BALL", "BOX"]
[peer.a.motion.BALL]
physics = { velocity = [1, 2, 3], acceleration = [0, -9.81, 0], angular_velocity = [7, 8, 9], at_s = 1.5 }
[peer.a.motion.BOX]
physics = { }
)";
  const RunSettings run = read(text).runs.front();
  const auto launch = [](const RunSettings& r, const char* name) {
    return std::get<replication::Launch>(r.peers[0].motion.at(name).kind);
  };
  const replication::Launch ball = launch(run, "BALL");
  EXPECT_EQ(ball.velocity, Vec3(1, 2, 3));
  EXPECT_EQ(ball.acceleration, Vec3(0, -9.81, 0));
  EXPECT_EQ(ball.angular_velocity, Vec3(7, 8, 9));
  EXPECT_EQ(ball.after, from_seconds(1.5));
  const replication::Launch box = launch(run, "BOX");
  EXPECT_FALSE(box.velocity.has_value());
  EXPECT_FALSE(box.acceleration.has_value());
  EXPECT_EQ(box.after, Duration{0});
  const auto swept = only(read(text, {"peer.a.motion.BALL.physics.velocity=[4, 5, 6]"}).runs);
  EXPECT_EQ(launch(swept, "BALL").velocity, Vec3(4, 5, 6));
  EXPECT_THAT(error(text, {"peer.a.motion.BALL.x=t"}), HasSubstr("peer.a.motion.BALL.x"));
  EXPECT_THAT(error(text, {"peer.a.motion.BALL.physics.speed=1"}), HasSubstr("peer.a.motion.BALL.physics.speed"));
  EXPECT_THAT(error(text, {"peer.a.motion.BALL.physics.angular_velocity=[1e4, 1, 0]"}),
              HasSubstr("peer.a.motion.BALL.physics.angular_velocity: a body turns by at most 1e4 rad/s"));
  EXPECT_THAT(error(text, {"peer.a.motion.BALL.physics.at_s=-1"}), HasSubstr("peer.a.motion.BALL.physics.at_s"));
}

TEST_F(ScenarioTest, ReadsWhatTheFileSays) {
  const Scenario s = read(kTwoPeers);
  EXPECT_EQ(s.name, "my");
  EXPECT_EQ(s.world, folder / "some.wrl") << "beside the scenario";
  EXPECT_EQ(s.seed, 1u);
  ASSERT_EQ(s.runs.size(), 1u);
  const RunSettings& run = s.runs.front();
  EXPECT_EQ(run.duration_s, 4.0);
  EXPECT_EQ(run.replication.policy.order, replication::ModelOrder::kFirst);
  ASSERT_EQ(run.peers.size(), 3u);
  EXPECT_EQ(run.peers[0].name, "a") << "by id";
  EXPECT_EQ(run.peers[1].name, "b");
  EXPECT_EQ(run.peers[2].name, "zoe");
  ASSERT_EQ(run.peers[0].owns.size(), 1u);
  EXPECT_EQ(run.peers[0].owns[0].text, "CAR");
  EXPECT_THAT(run.peers[0].owns[0].at, testing::EndsWith("my.toml:18:9: "));
  EXPECT_EQ(std::get<motion::MotionFormula>(run.peers[0].motion.at("CAR").kind).x, "t");
}

TEST_F(ScenarioTest, ModelsAndBudget) {
  const auto plain = read("world = \"w\"\n[peer.a]\nid = 1").runs.front().replication.policy;
  EXPECT_FALSE(plain.models) << "the models are those of `order`, as in the thesis";
  EXPECT_EQ(plain.wanted_error_m, 0.0);
  EXPECT_EQ(plain.copies, 1u);
  const Scenario s =
      read("world = \"w\"\n[peer.a]\nid = 1", {"replication.model=best", R"(replication.models=["second", "sliding"])",
                                               "replication.wanted_error_m=0.25", "replication.update_copies=3"});
  ASSERT_EQ(s.runs.size(), 1u) << "a list of models is one value";
  const auto& policy = s.runs.front().replication.policy;
  ASSERT_TRUE(policy.models);
  EXPECT_THAT(policy.models->allowed, ElementsAre(false, true, false, false, false, false, true));
  EXPECT_EQ(policy.wanted_error_m, 0.25);
  EXPECT_EQ(policy.copies, 3u);
}

TEST_F(ScenarioTest, Defaults) {
  const RunSettings run = read("world = \"w\"\n[peer.a]\nid = 1").runs.front();
  EXPECT_EQ(run.duration_s, 15.0);
  EXPECT_EQ(run.seed, 1u);
  EXPECT_TRUE(run.replication.policy.predict_collisions);
  EXPECT_TRUE(run.replication.policy.track_proximity);
  EXPECT_EQ(run.replication.policy.order, replication::ModelOrder::kSecond);
  EXPECT_FALSE(run.replication.policy.error_threshold_m) << "each object's own distanceThreshold";
  EXPECT_EQ(run.replication.policy.tight_threshold_m, 0.01);
  EXPECT_NEAR(run.replication.policy.angle_threshold_rad, 0.05235987755983, 1e-12);
  EXPECT_EQ(run.replication.policy.time_threshold, std::chrono::seconds(5));
  EXPECT_EQ(run.replication.policy.close_proximity_s, 0.5);
  EXPECT_EQ(run.replication.tick_hz, 60u);
  EXPECT_FALSE(run.peers.front().tick_hz);
  EXPECT_EQ(run.peers.front().clock_offset_s, 0.0);
  EXPECT_EQ(run.network.latency_ms, 0.0);
  EXPECT_EQ(run.transport.port, std::nullopt);
  EXPECT_EQ(run.transport.ttl, 1u);
  EXPECT_EQ(run.transport.dscp, 0u);
  EXPECT_EQ(run.transport.group_pool, 0u);
  EXPECT_EQ(run.transport.receive_buffer_bytes, 1024u * 1024);
  EXPECT_EQ(run.transport.busy_poll_us, 0u);
  EXPECT_EQ(run.transport.multicast, net::kMulticastAuto);
  EXPECT_TRUE(run.transport.peers.empty());
}

TEST_F(ScenarioTest, TransportSaysHowToReachTheOthers) {
  const RunSettings run = read(R"(world = "w"
[peer.a]
id = 1
[transport]
dscp = 46
group_pool = 64
receive_buffer_bytes = 4096
busy_poll_us = 50
multicast = "never"
peers = ["192.0.2.1:4000", "host.example:4001"])")
                              .runs.front();
  EXPECT_EQ(run.transport.dscp, 46u);
  EXPECT_EQ(run.transport.group_pool, 64u);
  EXPECT_EQ(run.transport.receive_buffer_bytes, 4096u);
  EXPECT_EQ(run.transport.busy_poll_us, 50u);
  EXPECT_EQ(run.transport.multicast, net::kMulticastNever);
  EXPECT_THAT(run.transport.peers, ElementsAre("192.0.2.1:4000", "host.example:4001"));
}

TEST_F(ScenarioTest, AListOfSeedsIsOneValueAndSweepsNothing) {
  const Scenario s = read("world = \"w\"\n[peer.a]\nid = 1", {R"(transport.peers=["192.0.2.1:1", "192.0.2.2:2"])"});
  ASSERT_EQ(s.runs.size(), 1u);
  EXPECT_THAT(s.runs.front().transport.peers, ElementsAre("192.0.2.1:1", "192.0.2.2:2"));
}

TEST_F(ScenarioTest, ApproachesSwitchPredictionAndTracking) {
  const auto policy = [&](const std::string& approach) {
    const auto p = read(kTwoPeers, {"replication.approach=" + approach}).runs.front().replication.policy;
    return std::pair(p.predict_collisions, p.track_proximity);
  };
  EXPECT_EQ(policy("dr"), std::pair(false, false));
  EXPECT_EQ(policy("dr+rcp"), std::pair(true, false));
  EXPECT_EQ(policy("dr+rcp+acpt"), std::pair(true, true));
}

TEST_F(ScenarioTest, ALinkTableGoesOverTheNetworksAndHoldsOneWay) {
  const RunSettings run = read(kTwoPeers).runs.front();
  EXPECT_EQ(link(run, "a", "b").loss, 0.25);
  EXPECT_EQ(link(run, "a", "b").latency_ms, 5.0) << "what the link does not say is the network's";
  EXPECT_EQ(link(run, "a", "b").jitter_ms, 1.0);
  EXPECT_EQ(link(run, "b", "a").loss, 0.0);
  EXPECT_EQ(link(run, "a", "zoe").loss, 0.0);
}

// ---- sweeps ----

constexpr const char* kSweep = R"(
[sweep]
"replication.order" = [1, 2]
"network.latency_ms" = [5, 100, 200]
)";

TEST_F(ScenarioTest, SweepsInAlphabeticalOrderAndTheLastKeyVariesFastest) {
  const Scenario s = read(std::string(kTwoPeers) + kSweep);
  EXPECT_THAT(params(s), ElementsAre(R"({"network.latency_ms":5,"replication.order":1})",
                                     R"({"network.latency_ms":5,"replication.order":2})",
                                     R"({"network.latency_ms":100,"replication.order":1})",
                                     R"({"network.latency_ms":100,"replication.order":2})",
                                     R"({"network.latency_ms":200,"replication.order":1})",
                                     R"({"network.latency_ms":200,"replication.order":2})"));
  EXPECT_EQ(s.runs[3].network.latency_ms, 100.0);
  EXPECT_EQ(s.runs[3].replication.policy.order, replication::ModelOrder::kSecond);
  EXPECT_EQ(link(s.runs[3], "a", "b").latency_ms, 100.0) << "a link follows the network's swept value";
}

TEST_F(ScenarioTest, ASetValueEndsThatKeysSweep) {
  const Scenario s = read(std::string(kTwoPeers) + kSweep, {"network.latency_ms=7", "peer.a.clock_offset_s=3"});
  EXPECT_THAT(params(s), ElementsAre(R"({"replication.order":1,"network.latency_ms":7,"peer.a.clock_offset_s":3})",
                                     R"({"replication.order":2,"network.latency_ms":7,"peer.a.clock_offset_s":3})"));
  EXPECT_EQ(s.runs[1].network.latency_ms, 7.0);
  EXPECT_EQ(s.runs[1].peers[0].clock_offset_s, 3.0);
}

TEST_F(ScenarioTest, ASetListSweeps) {
  const Scenario s =
      read(std::string(kTwoPeers) + kSweep, {"network.latency_ms=1", "replication.order=1", "seed=[4, 9]"});
  ASSERT_EQ(s.runs.size(), 2u);
  EXPECT_EQ(s.runs[0].seed, 4u);
  EXPECT_EQ(s.runs[1].seed, 9u);
  const Scenario replaced = read(std::string(kTwoPeers) + kSweep, {"network.latency_ms=[1, 2]", "replication.order=1"});
  EXPECT_EQ(replaced.runs.size(), 2u) << "in place of the file's list";
}

// The parameters name what ran; `peerd scenario` hands them on to its processes word for word.
TEST_F(ScenarioTest, AListAmongTheParametersStaysAList) {
  EXPECT_THAT(params(read(kTwoPeers, {"peer.zoe.owns=[\"X\", \"Y\"]"})),
              ElementsAre(R"({"network.latency_ms":5,"peer.zoe.owns":["X","Y"],"replication.order":1})"));
  const RunSettings run = read(kTwoPeers, {"peer.a.motion.CAR.axis=[0, 0, 1]"}).runs.front();
  EXPECT_THAT(std::get<motion::MotionFormula>(run.peers[0].motion.at("CAR").kind).axis, ElementsAre(0, 0, 1));
}

TEST_F(ScenarioTest, TheLaterSetWins) {
  EXPECT_EQ(read(kTwoPeers, {"duration_s=2", "duration_s=3"}).runs.front().duration_s, 3.0);
}

TEST_F(ScenarioTest, TheSeedOfTheRequestWins) {
  request.seed = 99;
  const Scenario s = read(std::string("seed = 5\n") + kTwoPeers);
  EXPECT_EQ(s.seed, 99u);
  EXPECT_EQ(s.runs.front().seed, 99u);
}

TEST_F(ScenarioTest, ConfigsAreMergedInOrder) {
  request.configs = {folder.write("one.toml", "duration_s = 7\n[network]\nlatency_ms = 50\n[replication]\norder = 2"),
                     folder.write("two.toml", "duration_s = 8\n[peer.late]\nid = 9")};
  const Scenario s = read(kTwoPeers);
  EXPECT_EQ(s.name, "my");
  const RunSettings& run = s.runs.front();
  EXPECT_EQ(run.duration_s, 8.0);
  EXPECT_EQ(run.network.latency_ms, 50.0);
  EXPECT_EQ(run.network.jitter_ms, 1.0) << "of the scenario still";
  EXPECT_EQ(run.replication.policy.order, replication::ModelOrder::kSecond);
  EXPECT_EQ(run.peers.back().name, "late");
  EXPECT_EQ(read(kTwoPeers, {"duration_s=9"}).runs.front().duration_s, 9.0) << "--set goes over --config";
}

TEST_F(ScenarioTest, AConfigsMistakeIsFoundInIt) {
  request.configs = {folder.write("over.toml", "\n[network]\nlatncy_ms = 50")};
  EXPECT_THAT(error(kTwoPeers), HasSubstr("over.toml:3:1: error: unknown key network.latncy_ms; did you mean "
                                          "network.latency_ms?"));
}

TEST_F(ScenarioTest, RealRunsDropTheSimulatedNetworksKeys) {
  request.real = true;
  const Scenario s = read(std::string(kTwoPeers) + kSweep);
  EXPECT_THAT(params(s), ElementsAre(R"({"replication.order":1})", R"({"replication.order":2})"));
}

TEST_F(ScenarioTest, APeerOfItsOwnTakesTheValuesOutsideOfTheSweep) {
  request.real = true;
  request.sweep = false;
  const Scenario s = read(std::string(kTwoPeers) + "[sweep]\n\"replication.order\" = [2, 1]\n\"duration_s\" = [1, 2]");
  ASSERT_EQ(s.runs.size(), 1u);
  EXPECT_EQ(s.runs.front().duration_s, 4.0);
}

TEST_F(ScenarioTest, WithoutAFileEverythingComesFromSets) {
  request.sets = {"world=\"/w.wrl\"", "peer.me.id=4"};
  const auto s = must(read_scenario(request));
  EXPECT_EQ(s.world, "/w.wrl");
  EXPECT_EQ(s.runs.front().peers.front().name, "me");
}

// ---- what is refused ----

struct Bad {
  const char* name;
  const char* find;  // in kTwoPeers, replaced by
  const char *replacement, *where, *sentence;
};
class ScenarioRefusal : public ScenarioTest, public testing::WithParamInterface<Bad> {};
TEST_P(ScenarioRefusal, SaysWhereAndWhat) {
  std::string text = kTwoPeers;
  const auto at = text.find(GetParam().find);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string(GetParam().find).size(), GetParam().replacement);
  expect_refused(text, GetParam().where, GetParam().sentence);
}
INSTANTIATE_TEST_SUITE_P(
    Table, ScenarioRefusal,
    testing::Values(
        Bad{"UnknownTopKey", "duration_s", "durations", "2:1: ", "unknown key durations; did you mean duration_s?"},
        Bad{"UnknownReplicationKey", "order", "ordr",
            "5:1: ", "unknown key replication.ordr; did you mean replication.order?"},
        Bad{"UnknownLinkKey", "loss", "lost",
            "12:1: ", "unknown key network.link.a.b.lost; did you mean network.link.a.b.loss?"},
        Bad{"UnknownPeerKey", "id = 2\nowns", "id = 2\nown",
            "23:1: ", "unknown key peer.b.own; did you mean peer.b.owns?"},
        Bad{"NameWithABlank", "peer.zoe", "peer.\"z o\"", "14:1: ", "the peer's name \"z o\""},
        Bad{"NameWithASlash", "peer.zoe", "peer.\"z/o\"", "14:1: ", "no blank and no slash"},
        Bad{"UnknownMotionKey", "x = \"t\"", "xx = \"t\"", "20:1: ", "unknown key peer.a.motion.CAR.xx"},
        Bad{"NoWorld", "world = \"some.wrl\"", "", "", "world is missing"},
        Bad{"NoId", "id = 3", "", "", "peer.zoe.id is missing"},
        Bad{"IdZero", "id = 3", "id = 0", "15:6: ", "peer.zoe.id = 0 is out of range"},
        Bad{"NoSuchModel", "order = 1", "order = 1\nmodels = [\"first\", \"fifth\"]",
            "6:10: ", "replication.models: no model is called \"fifth\""},
        Bad{"NoSuchChoice", "order = 1", "model = \"worst\"", "5:9: ", "replication.model"},
        Bad{"NoCopyAtAll", "order = 1", "update_copies = 0", "5:17: ", "replication.update_copies"},
        Bad{"OrderThree", "order = 1", "order = 3", "5:9: ", "replication.order = 3 is out of range: 1 to 2"},
        Bad{"BurstOfLessThanOne", "loss = 0.25", "loss = 0.25\nloss_burst = 0.5",
            "13:14: ", "network.link.a.b.loss_burst: a run is 1 datagram or more"},
        Bad{"BurstTooShortForItsLoss", "loss = 0.25", "loss = 0.75\nloss_burst = 2",
            "13:14: ", "no more than loss_burst / (loss_burst + 1)"},
        Bad{"LossAboveOne", "0.25", "1.25", "12:8: ", "network.link.a.b.loss = 1.25 is out of range: 0 to 1"},
        Bad{"NegativeLatency", "latency_ms = 5", "latency_ms = -5",
            "8:14: ", "network.latency_ms = -5 is out of range"},
        Bad{"UnknownPeerInALink", "link.a.b", "link.a.nobody", "11:", "the scenario has no peer \"nobody\""},
        Bad{"LinkIsNoTable", "[network.link.a.b]\nloss = 0.25", "link.a = 3", "11:10: ", "network.link.FROM.TO"},
        Bad{"SameIdTwice", "id = 2", "id = 1", "", "peer a has that id too"},
        Bad{"AxisZero", "x = \"t\"", "axis = [0, 0, 0]", "20:8: ", "peer.a.motion.CAR.axis must not be zero"},
        Bad{"AxisNearlyZero", "x = \"t\"", "axis = [1e-200, 0, 0]", "20:8: ", "axis must not be zero"},
        Bad{"SpinAxisZero", "x = \"t\"", "spin_axis = [0, 0, 0]", "20:13: ", "spin_axis must not be zero"},
        Bad{"TwoKindsOfMotion", "x = \"t\"", "walk = {within_m = [0, 0, 20, 20]}\ntrack = \"t.csv\"",
            "20:8: ", "peer.a.motion.CAR.walk: the object is moved by track already"},
        Bad{"FormulaBesideAWalk", "x = \"t\"", "walk = {within_m = [0, 0, 20, 20]}\nx = \"t\"",
            "21:1: ", "unknown key peer.a.motion.CAR.x"},
        Bad{"FaceForwardOfAFormula", "x = \"t\"", "face_forward = true",
            "20:1: ", "unknown key peer.a.motion.CAR.face_forward"},
        Bad{"WaypointsBackwards", "x = \"t\"", "waypoints = [[0, 0, 0, 0], [1, 2, 3, 4],\n[1, 0, 0, 0]]",
            "21:1: ", "peer.a.motion.CAR.waypoints: each time must be later"},
        Bad{"WaypointOfThree", "x = \"t\"", "waypoints = [[0, 0, 0]]", "20:14: ", "a list of lists of 4 numbers"},
        Bad{"NoWaypoint", "x = \"t\"", "waypoints = []", "20:13: ", "a list of lists of 4 numbers"},
        Bad{"LoopThatDoesNotClose", "x = \"t\"", "waypoints = [[0, 0, 0, 0], [1, 2, 3, 4], [2, 0, 0, 1]]\nloop = true",
            "20:42: ", "let the last row be the first place again"},
        Bad{"WalkOnALine", "x = \"t\"", "walk = {within_m = [0, 0, 20, 5]}", "20:20: ", "at least 10 m apart"},
        Bad{"WalkNowhere", "x = \"t\"", "walk = {}", "20:8: ", "peer.a.motion.CAR.walk.within_m is missing"},
        Bad{"FlockInAPlane", "x = \"t\"", "flock = {within_m = [0, 0, 0, 9, 0, 9]}",
            "20:21: ", "the lower corner first"},
        Bad{"DriveWithoutBlocks", "x = \"t\"", "drive = {blocks = 0}", "20:19: ", "drive.blocks = 0 is out of range"},
        Bad{"UnknownDriveKey", "x = \"t\"", "drive = {block = 3}", "20:10: ", "did you mean"},
        Bad{"MotionIsNoTable", "[peer.zoe]", "[motion]\nCAR = 3\n[peer.zoe]", "15:7: ", "motion.CAR must be a table"},
        Bad{"BeforeStart", "x = \"t\"", "before_start = \"wait\"", "20:16: ", "must be one of \"run\", \"hold\""},
        Bad{"BusyPollNegative", "[peer.zoe]", "[transport]\nbusy_poll_us = -1\n[peer.zoe]",
            "15:16: ", "transport.busy_poll_us = -1 is out of range: 0 to 1000000"},
        Bad{"BusyPollOfMoreThanASecond", "[peer.zoe]", "[transport]\nbusy_poll_us = 1000001\n[peer.zoe]",
            "15:16: ", "transport.busy_poll_us = 1000001 is out of range: 0 to 1000000"},
        Bad{"DurationZero", "duration_s = 4", "duration_s = 0",
            "2:14: ", "duration_s = 0 is out of range: 0.1 to 1000000"},
        Bad{"Malformed", "[replication]", "[replication", "4:", ""}),
    [](const auto& c) { return std::string(c.param.name); });

TEST_F(ScenarioTest, ABadSweepIsRefused) {
  EXPECT_THAT(error(std::string(kTwoPeers) + "[sweep]\n\"replication.order\" = []"),
              HasSubstr("sweep: \"replication.order\" must be a list of at least one value"));
  EXPECT_THAT(error(std::string(kTwoPeers) + "[sweep]\n\"replication.order\" = 2"), HasSubstr("must be a list"));
  EXPECT_THAT(error(std::string("sweep = 3\n") + kTwoPeers), HasSubstr("sweep must be a table of lists"));
  EXPECT_THAT(error(std::string(kTwoPeers) + "[sweep]\n\"replication.ordr\" = [1]"),
              HasSubstr("unknown key replication.ordr; did you mean replication.order?"));
  EXPECT_THAT(error(std::string(kTwoPeers) + "[sweep]\n\"replication.order\" = [1, 5]"),
              HasSubstr("replication.order = 5 is out of range: 1 to 2"));
  std::string many = "0";
  for (int i = 1; i < 400; ++i) many += ", " + std::to_string(i);
  EXPECT_THAT(error(std::string(kTwoPeers) + "[sweep]\nseed = [" + many + "]\n\"network.latency_ms\" = [" + many + "]"),
              HasSubstr("more than 100000 runs"));
}

// Each table of the language has a number and a word here.
TEST_F(ScenarioTest, WhateverIsNotSharedIsSwept) {
  const std::string more = R"([[peer.a.key]]
at_s = 1
key = "w"
[peer.b.viewpoint]
angle_deg = 5
[motion."B*".walk]
within_m = [0, 0, 20, 20]
[regions]
counts = [8, 1, 8]
[sweep]
seed = [3, 4]
"decisions.policy" = ["id", "velocity"]
"motion.B*.walk.speed_m_s" = [1, 2]
"network.link.a.b.loss" = [0.1, 0.2]
"peer.a.key.0.at_s" = [1, 2]
"peer.a.motion.CAR.x" = ["t", "2*t"]
"peer.b.interest_radius_m" = [10, 20]
"peer.b.viewpoint.angle_deg" = [1, 2]
"regions.cell_m" = [10, 20]
"regions.counts.0" = [4, 8]
"relay.restamps" = [true, false]
"replication.model" = ["order", "best"]
)";
  const Scenario s = read(kTwoPeers + more);
  ASSERT_EQ(s.runs.size(), 1u << 12);
  const RunSettings &first = s.runs.front(), &last = s.runs.back();
  EXPECT_EQ(last.peers[0].keys[0].at_s, 2);
  EXPECT_EQ(std::get<motion::MotionFormula>(last.peers[0].motion.at("CAR").kind).x, "2*t");
  EXPECT_EQ(std::get<motion::WalkSettings>(last.motion.at("B*").kind).speed_m_s, 2);
  EXPECT_EQ(link(last, "a", "b").loss, 0.2);
  EXPECT_EQ(last.peers[1].interest_radius_m, 20);
  EXPECT_EQ(last.peers[1].viewpoint->angle_deg, 2);
  EXPECT_EQ(last.replication.regions.regions[0], 8u);
  EXPECT_EQ(last.replication.decisions.policy, replication::DecisionPolicy::kVelocity);
  EXPECT_TRUE(last.replication.policy.models);
  EXPECT_EQ(first.seed, 3u);
  EXPECT_EQ(last.seed, 4u);
  EXPECT_EQ(first.peers[0].keys[0].at_s, 1);
}

// A key that all runs share would have the last run's value in all of them.
TEST_F(ScenarioTest, WhatAllRunsShareIsNotSwept) {
  EXPECT_THAT(error(std::string(kTwoPeers) + "[sweep]\nworld = [\"a.wrl\", \"b.wrl\"]"),
              HasSubstr("all runs of a sweep share it"));
  EXPECT_THAT(error(std::string(kTwoPeers) + "[sweep]\nrepeat = [2, 3]"), HasSubstr("every combination is repeated"));
  EXPECT_THAT(error(kTwoPeers, {"expect.x.at_most=[1, 2]"}), HasSubstr("an expectation says by `where`"));
}

TEST_F(ScenarioTest, RepeatsEverythingWithSeedsThatFollow) {
  const std::string text =
      "repeat = 3\nseed = 7\n" + std::string(kTwoPeers) + "[sweep]\n\"replication.order\" = [1, 2]";
  const Scenario s = read(text);
  EXPECT_EQ(s.repeat, 3u);
  std::vector<std::uint64_t> seeds;
  for (const RunSettings& run : s.runs) seeds.push_back(run.seed);
  EXPECT_THAT(seeds, ElementsAre(7, 8, 9, 7, 8, 9));
  EXPECT_EQ(s.runs[2].params, s.runs[0].params) << "a seed is no parameter";
  request.repeat = 2;
  EXPECT_EQ(read(text).runs.size(), 4u) << "the request's wins";
  request.sweep = false;
  EXPECT_EQ(read(text).runs.size(), 1u) << "one peer runs once";
  request = {};
  EXPECT_THAT(error(text + "\nseed = [1, 2]"), HasSubstr("seeds are repeat's already"));
  EXPECT_THAT(error(text, {"seed=9223372036854775806"}), HasSubstr("above 2^63 - 1"));
}

TEST_F(ScenarioTest, ABadSetIsRefused) {
  EXPECT_THAT(error(kTwoPeers, {"network.latency_ms"}), HasSubstr("write it as KEY=VALUE"));
  EXPECT_THAT(error(kTwoPeers, {"network.latncy_ms=3"}), HasSubstr("did you mean network.latency_ms?"));
  EXPECT_THAT(error(kTwoPeers, {"duration_s.x=3"}), HasSubstr("duration_s is a value, not a table"));
  EXPECT_THAT(error(kTwoPeers, {"peer.a.id=\"one\""}), HasSubstr("peer.a.id must be a number"));
}

// ---- the world behind it ----

TEST(LoadWorld, TellsWorldsApartByTheirBytesAndFindsObjects) {
  const ScratchFolder folder;
  const char* text = "#VRML V2.0 utf8\nDEF CAR Transform { }\nDEF CUBE Transform { children DEF LAMP Group { } }\n";
  const auto one = must(load_world(folder.write("one.wrl", text)));
  EXPECT_EQ(load_world(folder.write("same.wrl", text))->hash, one.hash);
  EXPECT_NE(load_world(folder.write("other.wrl", std::string(text) + "\n"))->hash, one.hash);
  EXPECT_EQ(*find_object(one.scene, "CUBE", "x"), ObjectId{1});
  EXPECT_EQ(error_of(find_object(one.scene, "CUBA", "peer.a.owns")).text,
            "error: peer.a.owns: the world has no object \"CUBA\"; did you mean \"CUBE\"?");
}

TEST_F(ScenarioTest, Decisions) {
  using replication::DecisionPolicy;
  const replication::DecisionSettings none = read(kTwoPeers).runs[0].replication.decisions;
  EXPECT_EQ(none.policy, DecisionPolicy::kId);
  EXPECT_FALSE(none.lookback);
  EXPECT_TRUE(none.repeat);
  EXPECT_TRUE(none.fallback);
  const char* const words[] = {"id", "velocity", "field-of-view", "expected-error", "server"};
  for (std::uint8_t i = 0; i < 5; ++i) {
    const auto run = read(kTwoPeers, {std::string("decisions.policy=") + words[i], "decisions.server=zoe"}).runs[0];
    EXPECT_EQ(static_cast<int>(run.replication.decisions.policy), i + 1);
    EXPECT_EQ(run.replication.decisions.server, PeerId{3});
    EXPECT_FALSE(run.compare_outcomes);
  }
  const auto set = read(kTwoPeers, {"decisions.repeat=false", "decisions.fallback=false", "decisions.lookback_ms=150",
                                    "decisions.compare=true"})
                       .runs[0];
  EXPECT_FALSE(set.replication.decisions.repeat);
  EXPECT_FALSE(set.replication.decisions.fallback);
  EXPECT_EQ(set.replication.decisions.lookback, std::chrono::milliseconds(150));
  EXPECT_TRUE(set.compare_outcomes);
  EXPECT_THAT(error(kTwoPeers, {"decisions.policy=luck"}), HasSubstr("decisions.policy"));
  EXPECT_THAT(error(kTwoPeers, {"decisions.policy=server"}), HasSubstr("decisions.server"));
  EXPECT_THAT(error(kTwoPeers, {"decisions.server=nobody"}), HasSubstr("no peer \"nobody\""));
  EXPECT_THAT(error(kTwoPeers, {"decisions.lookback_ms=2001"}), HasSubstr("decisions.lookback_ms"));
}

TEST_F(ScenarioTest, Viewpoints) {
  const auto run = read(kTwoPeers, {"peer.a.viewpoint.object=CAR", "peer.a.viewpoint.position=[1, 2, 3]",
                                    "peer.a.viewpoint.angle_deg=90", "peer.a.viewpoint.field_of_view_deg=60"})
                       .runs.at(0);
  ASSERT_TRUE(run.peers[0].viewpoint);
  EXPECT_EQ(run.peers[0].viewpoint->object, "CAR");
  EXPECT_THAT(run.peers[0].viewpoint->position, ElementsAre(1, 2, 3));
  EXPECT_EQ(run.peers[0].viewpoint->angle_deg, 90);
  EXPECT_EQ(run.peers[0].viewpoint->field_of_view_deg, 60);
  EXPECT_FALSE(run.peers[1].viewpoint);
  EXPECT_THAT(error(kTwoPeers, {"peer.a.viewpoint.axis=[0, 0, 0]"}), HasSubstr("must not be zero"));
  EXPECT_THAT(error(kTwoPeers, {"peer.a.viewpoint.field_of_view_deg=180"}), HasSubstr("field_of_view_deg"));
}

TEST_F(ScenarioTest, RegionsAreOffUntilACellIsGiven) {
  const auto off = read(kTwoPeers).runs.front();
  EXPECT_EQ(off.replication.regions.cell_m, 0.0);
  EXPECT_EQ(off.peers.front().interest_radius_m, std::nullopt);
  const auto on =
      read(kTwoPeers, {"regions.cell_m=75", "regions.counts=[4, 2, 16]", "regions.margin_m=2.5", "regions.stay_s=3",
                       "regions.lookahead_s=0.5", "regions.fastest_m_s=9", "peer.a.interest_radius_m=120"})
          .runs.front();
  const replication::RegionSettings& r = on.replication.regions;
  EXPECT_EQ(r.cell_m, 75.0);
  EXPECT_EQ(r.regions, (std::array<std::uint32_t, 3>{4, 2, 16})) << "one list, not a sweep";
  EXPECT_EQ(r.hysteresis.margin_m, 2.5);
  EXPECT_EQ(r.hysteresis.stay, std::chrono::seconds(3));
  EXPECT_EQ(r.lookahead, std::chrono::milliseconds(500));
  EXPECT_EQ(r.fastest_m_s, 9.0);
  EXPECT_EQ(on.peers.front().interest_radius_m, 120.0);
}

TEST_F(ScenarioTest, RegionsThatCannotBeAreRefused) {
  EXPECT_THAT(error(kTwoPeers, {"regions.cell_m=0.5"}),
              HasSubstr("regions.cell_m must be 0 (not cut) or at least 1 m"));
  EXPECT_THAT(error(kTwoPeers, {"regions.counts=[0, 1, 1]"}), HasSubstr("regions.counts must be whole numbers"));
  EXPECT_THAT(error(kTwoPeers, {"regions.counts=[2.5, 1, 1]"}), HasSubstr("regions.counts must be whole numbers"));
  EXPECT_THAT(error(kTwoPeers, {"regions.counts=[256, 2, 256]"}), HasSubstr("at most 65536"));
  EXPECT_THAT(error(kTwoPeers, {"regions.margin_m=0"}), HasSubstr("regions.margin_m"));
  EXPECT_THAT(error(kTwoPeers, {"peer.a.interest_radius_m=-1"}), HasSubstr("interest_radius_m"));
  EXPECT_THAT(error(kTwoPeers, {"regions.cell_m=75", "relay.through=b"}), HasSubstr("leave out one of the two"));
}

TEST_F(ScenarioTest, NamesTheSettingsOfTheNetworkThatAreNotDefaults) {
  EXPECT_EQ(network_settings(read(kTwoPeers).runs.front()).dump(),
            R"({"network.latency_ms":5.0,"network.jitter_ms":1.0,"network.link.a.b.loss":0.25})");
  EXPECT_EQ(network_settings(read("world = \"w.wrl\"\n[peer.a]\nid = 1\n").runs.front()).dump(), "{}");
}

TEST_F(ScenarioTest, PeersOfOneIslandAreNearEachOther) {
  const std::string text =
      "world = \"w.wrl\"\n[network]\nlatency_ms = 60\nloss = 0.01\n[[network.island]]\npeers = [\"a*\"]\nlatency_ms = "
      "2\n"
      "[[network.island]]\npeers = [\"b\", \"c\"]\nlatency_ms = 3\nloss = 0\n[network.link.b.c]\njitter_ms = 7\n"
      "[peer.a1]\nid = 1\n[peer.a2]\nid = 2\n[peer.b]\nid = 3\n[peer.c]\nid = 4\n[peer.d]\nid = 5\n";
  const RunSettings run = read(text).runs.front();
  EXPECT_EQ(link(run, "a1", "a2").latency_ms, 2.0);
  EXPECT_EQ(link(run, "a2", "a1").loss, 0.01) << "what an island leaves out is the network's";
  EXPECT_EQ(link(run, "a1", "b").latency_ms, 60.0);
  EXPECT_EQ(link(run, "d", "b").latency_ms, 60.0);
  EXPECT_EQ(link(run, "c", "b").latency_ms, 3.0);
  EXPECT_EQ(link(run, "b", "c").latency_ms, 3.0) << "what a link leaves out is its island's";
  EXPECT_EQ(link(run, "b", "c").jitter_ms, 7.0);
  EXPECT_EQ(links_of(run).size(), 4u);
  EXPECT_EQ(network_settings(run).dump(),
            R"({"network.latency_ms":60.0,"network.loss":0.01,"network.island.0.latency_ms":2.0,)"
            R"("network.island.1.latency_ms":3.0,"network.island.1.loss":0.0,"network.link.b.c.latency_ms":3.0,)"
            R"("network.link.b.c.jitter_ms":7.0,"network.link.b.c.loss":0.0})");
  const std::string peers = "[peer.a]\nid = 1\n[peer.b]\nid = 2\n", begin = "world = \"w.wrl\"\n";
  EXPECT_THAT(error(begin + "[[network.island]]\npeers = [\"x*\"]\n" + peers, {}), HasSubstr("no peer \"x*\""));
  EXPECT_THAT(error(begin + "[[network.island]]\nlatency_ms = 1\n" + peers, {}), HasSubstr("peers is missing"));
  EXPECT_THAT(error(begin + "[[network.island]]\npeers = [\"a\"]\n[[network.island]]\npeers = [\"*\"]\n" + peers, {}),
              HasSubstr("peer \"a\" is on another island, too"));
}

}  // namespace peerd::config::scenario_test
