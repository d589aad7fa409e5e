// Keys at one peer, and what its control interface says of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "peerd/control/answer.hpp"
#include "peerd/node/peer_node.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::peer_node_keys_test {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { velocityVector 1 0 0 children Shape { geometry Box { } } }
Transform { rotation 0 1 0 1.5707963 scale 2 2 2 children DEF TURNED Transform { children Shape { geometry Box { } } } }
DEF DRIVEN Transform { children Shape { geometry Box { } } }
DEF FREE Transform { children Shape { geometry Box { } } }
DEF MORE KeySensor { recipient "A" keyValue 65 value 2 0 0 consume FALSE }
KeySensor { recipient "DRIVEN" keyValue 65 value 2 0 0 consume FALSE }
DEF SET KeySensor { recipient "A" keyValue 66 value 0 5 0 absoluteValue TRUE }
DEF NEVER KeySensor { recipient "A" keyValue 66 value 0 100 0 }
DEF TURN KeySensor { recipient "TURNED" keyValue 67 value 0 0 1 }
DEF TABLE Transform { children DEF ON_TABLE Transform { children Shape { geometry Box { } } } }
CollisionInterest { objectPath "TABLE/ON_TABLE" interests "FREE" }
DEF CLOCK TimeSensor { loop TRUE startTime 0 cycleInterval 4 }
DEF HALF_TURN OrientationInterpolator { key [ 0 1 ] keyValue [ 0 1 0 0, 0 1 0 3.14159 ] }
ROUTE CLOCK.fraction_changed TO HALF_TURN.set_fraction
ROUTE HALF_TURN.value_changed TO TABLE.rotation
DEF PUSH KeySensor { recipient "ON_TABLE" keyValue 71 value 0 0 1 absoluteValue TRUE }
DEF LOOSE KeySensor { recipient "FREE" keyValue 68 value 0 0 1 }
DEF WARP KeySensor { recipient "A" keyValue 69 value 6e5 0 0 }
DEF FAR KeySensor { recipient "A" keyValue 70 value 3e38 0 0 absoluteValue TRUE }
)";
constexpr KeyEvent kA{'A', 0}, kB{'B', 0}, kC{'C', 0}, kD{'D', 0};

class PeerNodeKeys : public testing::Test {
 protected:
  PeerNodeKeys() {
    folder.write("w.wrl", kWorld);
    auto read = share_world(folder / "w.wrl");
    if (!read) throw std::runtime_error(read.error().text);
    shared = std::move(*read);
    settings.name = "a";
    settings.id = 1;
    settings.owns = {"A", "TURNED", "DRIVEN"};
    std::get<config::MotionFormula>(settings.motion["DRIVEN"].kind).x = "t";
  }
  PeerNode& make(std::vector<config::ScriptedKey> keys = {}) {
    settings.keys = std::move(keys);
    config::RunSettings settled;
    settled.peers = {settings};
    node = PeerNode::make(settings, {}, *shared, std::move(config::resolve(settled, shared->world.scene)->front()), {});
    return *node;
  }
  // Until that time after the start.
  void run(double until_s) {
    for (; !node->start() || since_start_s() < until_s; now += 5ms) {
      node->on_tick(now);
      while (node->poll_output()) {
      }
    }
  }
  [[nodiscard]] double since_start_s() const {
    return to_seconds(node->peer().clock().to_session(now) - *node->start());
  }
  [[nodiscard]] KinematicState truth(const char* path) const {
    return node->peer().truth(*shared->world.scene.find(path), node->peer().clock().to_session(now));
  }
  json ask(const std::string& request) { return json::parse(api::answer(*node, now, request).line); }

  testing_support::ScratchFolder folder;
  std::unique_ptr<const SharedWorld> shared;
  config::PeerSettings settings;
  std::unique_ptr<PeerNode> node;
  HostTime now{1000s};
};

TEST_F(PeerNodeKeys, AValueIsAddedOrSet) {
  make();
  run(1);
  const KeyReport a = node->on_key(now, kA);
  EXPECT_EQ(a.hits, 2u);
  EXPECT_FALSE(a.consumed);
  EXPECT_EQ(truth("A").velocity, Vec3(3, 0, 0)) << "the file's and the key's";
  (void)node->on_key(now, kA);
  EXPECT_EQ(truth("A").velocity, Vec3(5, 0, 0)) << "a repeat is a press";
  const KeyReport b = node->on_key(now, kB);
  EXPECT_EQ(truth("A").velocity, Vec3(0, 5, 0));
  EXPECT_TRUE(b.consumed);
  EXPECT_EQ(b.hits, 1u) << "NEVER stands behind one that consumes";
  EXPECT_TRUE(b.done());
}

TEST_F(PeerNodeKeys, AValueIsInTheFrameOfTheParent) {
  make();
  run(1);
  EXPECT_TRUE(node->on_key(now, kC).done());
  EXPECT_NEAR((truth("TURNED").velocity - Vec3(2, 0, 0)).norm(), 0, 1e-6) << "turned by 90 degrees, scaled by 2";
}

TEST_F(PeerNodeKeys, AParentThatTheFileMovesCountsAsItStands) {
  settings.owns.push_back("ON_TABLE");
  make();
  run(2);
  EXPECT_TRUE(node->on_key(now, {'G', 0}).done());
  EXPECT_NEAR((truth("ON_TABLE").velocity - Vec3(1, 0, 0)).norm(), 0, 0.02) << "after a quarter of a turn";
}

TEST_F(PeerNodeKeys, WhatThisPeerDoesNotMoveIsRefusedWithAReason) {
  make();
  run(1);
  const KeyReport a = node->on_key(now, kA);
  ASSERT_EQ(a.changes.size(), 2u);
  EXPECT_EQ(a.changes[0].refused, "");
  EXPECT_THAT(a.changes[1].refused, HasSubstr("a motion"));
  EXPECT_FALSE(a.done());
  const KeyReport d = node->on_key(now, kD);
  EXPECT_THAT(d.changes.at(0).refused, HasSubstr("no peer runs it"));
  EXPECT_TRUE(d.consumed) << "by the sensor, whatever comes of it";
  EXPECT_FALSE(node->on_key(now, {0x1013, 0}).done()) << "nobody listens";
  EXPECT_EQ(node->log().counters.at("keys"), 3u);
  EXPECT_EQ(node->log().counters.at("keys_unheard"), 1u);
  EXPECT_EQ(node->log().counters.at("key_changes"), 1u);
  EXPECT_EQ(node->log().counters.at("key_changes_refused"), 2u);
}

TEST_F(PeerNodeKeys, ASpeedBeyondTheWireLimitsIsRefused) {
  make();
  run(1);
  EXPECT_TRUE(node->on_key(now, {'E', 0}).done());
  EXPECT_THAT(node->on_key(now, {'E', 0}).changes.at(0).refused, HasSubstr("1e6 m/s"));
  EXPECT_THAT(node->on_key(now, {'F', 0}).changes.at(0).refused, HasSubstr("1e6 m/s"));
  EXPECT_EQ(truth("A").velocity, Vec3(600'001, 0, 0));
}

TEST_F(PeerNodeKeys, BeforeTheStartAreRefused) {
  make();
  EXPECT_THAT(node->on_key(now, kA).refused, HasSubstr("not begun"));
  while (!node->start()) run(-1e9);
  ASSERT_LT(since_start_s(), 0);
  EXPECT_THAT(node->on_key(now, kA).refused, HasSubstr("not begun"));
  run(1);
  EXPECT_EQ(truth("A").velocity, Vec3(1, 0, 0));
}

TEST_F(PeerNodeKeys, OfTheSettingsArePressedAtTheirTime) {
  make({{0.5, kA}, {0.75, kB}, {100, kB}});
  run(0.49);
  EXPECT_EQ(truth("A").velocity, Vec3(1, 0, 0));
  run(0.51);
  EXPECT_EQ(truth("A").velocity, Vec3(3, 0, 0));
  run(1);
  EXPECT_EQ(truth("A").velocity, Vec3(0, 5, 0));
  const auto first = node->poll_key_report(), second = node->poll_key_report();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->key, kA);
  EXPECT_EQ(second->key, kB);
  EXPECT_FALSE(node->poll_key_report());
}

TEST_F(PeerNodeKeys, TheNextKeyIsADeadline) {
  make({{0.5013, kA}});
  run(0.499);
  const double deadline_s = to_seconds(node->peer().clock().to_session(node->next_deadline()) - *node->start());
  EXPECT_LE(deadline_s, 0.5013);
  now = node->peer().clock().to_host(*node->start() + from_seconds(0.5013));
  node->on_tick(now);
  EXPECT_TRUE(node->poll_key_report());
}

TEST_F(PeerNodeKeys, StatusSaysWhoWhereAndHowFast) {
  make();
  EXPECT_FALSE(ask(R"({"do":"status"})")["session"]["joined"].get<bool>());
  EXPECT_TRUE(ask(R"({"do":"objects"})")["objects"].empty());
  run(1);
  const json s = ask(R"({"do":"status"})");
  EXPECT_EQ(s["v"], 1);
  EXPECT_EQ(s["ok"], true);
  EXPECT_EQ(s["peer"], json({{"id", 1}, {"name", "a"}}));
  EXPECT_TRUE(s["session"]["joined"].get<bool>());
  EXPECT_NEAR(s["since_start_s"].get<double>(), since_start_s(), 1e-6);
  EXPECT_NEAR(s["world_time_s"].get<double>(), since_start_s(), 1e-6);
  ASSERT_EQ(s["objects"].size(), 3u);
  EXPECT_EQ(s["objects"][0]["path"], "A");
  EXPECT_EQ(s["objects"][0]["owner"], 1);
  EXPECT_EQ(s["objects"][0]["velocity_m_s"], json({1.0, 0.0, 0.0}));
  EXPECT_NEAR(s["objects"][0]["position_m"][0].get<double>(), since_start_s(), 0.02);
  EXPECT_EQ(s["objects"][2]["path"], "DRIVEN");
  EXPECT_EQ(s["objects"][2]["driven"], true);
  EXPECT_GT(s["counters"]["ticks"].get<int>(), 10);
}

TEST_F(PeerNodeKeys, PeersReportsReceptionOfEachPeer) {
  make();
  run(1);
  replication::Message hello;
  hello.sender = PeerId{2};
  hello.incarnation = 7;
  hello.number = 1;
  hello.hello.emplace().introduction.emplace();
  hello.hello->introduction->name = "b";
  hello.hello->introduction->world_hash = replication::RegionSettings{}.session_hash(shared->world.hash);
  const replication::Bytes datagram = replication::encode(hello);
  node->on_packet(now, replication::kWholeScene, datagram);
  replication::Message more;  // the fourth comes, twice, and then the third
  more.sender = PeerId{2};
  more.incarnation = 7;
  more.handovers = {{ObjectId{0}, 1, RegionId{1}}};  // which is not its own
  for (const std::uint32_t number : {4u, 4u, 3u}) {
    more.number = number;
    node->on_packet(now, replication::kWholeScene, replication::encode(more));
  }
  const json reply = ask(R"({"do":"peers"})");
  EXPECT_EQ(reply["clock"]["follows"], 1);
  EXPECT_EQ(reply["clock"]["error_ms"], 0.0);
  ASSERT_EQ(reply["peers"].size(), 1u);
  EXPECT_EQ(reply["peers"][0]["name"], "b");
  EXPECT_EQ(reply["peers"][0]["joined"], false);
  EXPECT_EQ(reply["peers"][0]["bytes_in"], datagram.size() + 3 * replication::encode(more).size());
  for (const json& row : {reply["peers"][0], reply["regions"][0]}) {
    EXPECT_EQ(row["datagrams_in"], 4);
    EXPECT_EQ(row["duplicates"], 1);
    EXPECT_EQ(row["overtaken"], 1);
    EXPECT_GT(row["loss_in"], 0.2) << "one of four";
  }
  EXPECT_EQ(reply["peers"][0]["drops"], json({{"not_owner", 3}}));
  EXPECT_TRUE(reply["peers"][0]["clock_ahead_ms"].is_null()) << "nobody knows yet";
  EXPECT_TRUE(reply["next"].is_null());
  ASSERT_EQ(reply["regions"].size(), 1u);
  EXPECT_TRUE(ask(R"({"do":"peers","from":3})")["peers"].empty());
}

TEST_F(PeerNodeKeys, ObjectsComeInPieces) {
  make();
  run(1);
  const json first = ask(R"({"do":"objects","count":2})");
  EXPECT_EQ(first["objects"].size(), 2u);
  const json rest = ask(json{{"do", "objects"}, {"from", first["next"]}}.dump());
  EXPECT_EQ(rest["objects"].size(), 1u);
  EXPECT_TRUE(rest["next"].is_null());
}

TEST_F(PeerNodeKeys, AKeysReplySaysWhatItDid) {
  make();
  run(1);
  const json reply = ask(R"({"do":"key","key":"a"})");
  EXPECT_EQ(reply["ok"], true);
  EXPECT_EQ(reply["done"], false);
  EXPECT_EQ(reply["key"], "A");
  EXPECT_EQ(reply["consumed"], false);
  ASSERT_EQ(reply["changes"].size(), 2u);
  EXPECT_EQ(reply["changes"][0]["sensor"], "MORE");
  EXPECT_EQ(reply["changes"][0]["recipient"], "A");
  EXPECT_EQ(reply["changes"][0]["done"], true);
  EXPECT_EQ(reply["changes"][1]["sensor"], "KeySensor 1");
  EXPECT_THAT(reply["changes"][1]["refused"].get<std::string>(), HasSubstr("a motion"));
}

TEST_F(PeerNodeKeys, RubbishGetsAReasonAndLeavesThePeerAlone) {
  make();
  run(1);
  EXPECT_EQ(ask("rubbish")["ok"], false);
  EXPECT_THAT(ask("{\"do\":\"key\",\"key\":\"\\u0000\"}")["error"].get<std::string>(), HasSubstr("there is no key"));
  EXPECT_EQ(truth("A").velocity, Vec3(1, 0, 0));
  EXPECT_FALSE(api::answer(*node, now, "{\"do\":\"status\"}").leave);
  EXPECT_TRUE(api::answer(*node, now, "{\"do\":\"leave\"}").leave);
}

}  // namespace peerd::peer_node_keys_test
