#include "peerd/peer/control/answer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "peerd/net/os/traffic_counters.hpp"
#include "peerd/peer/control/request.hpp"
#include "replication/wire/codec.hpp"
#include "tests/has_members.hpp"
#include "tests/peerd/peer/node/lone_peer.hpp"

namespace peerd::control::answer_test {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { velocityVector 1 0 0 children Shape { geometry Box { } } }
DEF B Transform { children Shape { geometry Box { } } }
DEF DRIVEN Transform { children Shape { geometry Box { } } }
DEF C Transform { }
DEF MORE KeySensor { recipient "A" keyValue 65 value 2 0 0 consume FALSE }
KeySensor { recipient "DRIVEN" keyValue 65 value 2 0 0 consume FALSE }
)";

class ControlAnswer : public testing::Test, public testing_support::LonePeer {
 protected:
  ControlAnswer() : LonePeer(kWorld, {"A", "B", "DRIVEN"}) {}
  json ask(const std::string& request) { return json::parse(control::answer(*node, now, request).line); }
};

TEST_F(ControlAnswer, StatusSaysWhoWhereAndHowFast) {
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

TEST_F(ControlAnswer, PeersReportsReceptionOfEachPeer) {
  make();
  run(1);
  replication::Message hello{.sender = PeerId{2}, .incarnation = 7, .number = 1};
  hello.hello.emplace().introduction.emplace();
  hello.hello->introduction->name = "b";
  hello.hello->introduction->world_hash = replication::RegionSettings{}.session_hash(shared->world.hash);
  const replication::Bytes datagram = replication::encode(hello);
  node->on_packet(now, replication::kWholeScene, datagram);
  replication::Message more;  // the fourth datagram comes twice, and then the third
  more.sender = PeerId{2};
  more.incarnation = 7;
  more.handovers = {{ObjectId{0}, 1, RegionId{1}}};  // an object that it does not own
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
    EXPECT_THAT(row, HasMembers(R"({"datagrams_in": 4, "duplicates": 1, "overtaken": 1})"));
    EXPECT_GT(row["loss_in"], 0.2) << "one of four";
  }
  EXPECT_EQ(reply["peers"][0]["drops"], json({{"not_owner", 3}}));
  EXPECT_TRUE(reply["peers"][0]["clock_ahead_ms"].is_null()) << "nobody knows yet";
  EXPECT_TRUE(reply["next"].is_null());
  ASSERT_EQ(reply["regions"].size(), 1u);
  EXPECT_TRUE(ask(R"({"do":"peers","from":3})")["peers"].empty());
}

TEST_F(ControlAnswer, ObjectsComeInPieces) {
  make();
  run(1);
  const json first = ask(R"({"do":"objects","count":2})");
  EXPECT_EQ(first["objects"].size(), 2u);
  const json rest = ask(json{{"do", "objects"}, {"from", first["next"]}}.dump());
  EXPECT_EQ(rest["objects"].size(), 1u);
  EXPECT_TRUE(rest["next"].is_null());
}

TEST_F(ControlAnswer, AKeysReplySaysWhatItDid) {
  make();
  run(1);
  const json reply = ask(R"({"do":"key","key":"a"})");
  EXPECT_THAT(reply, HasMembers(R"({"ok": true, "done": false, "key": "A", "consumed": false})"));
  ASSERT_EQ(reply["changes"].size(), 2u);
  EXPECT_EQ(reply["changes"][0]["sensor"], "MORE");
  EXPECT_EQ(reply["changes"][0]["recipient"], "A");
  EXPECT_EQ(reply["changes"][0]["done"], true);
  EXPECT_EQ(reply["changes"][1]["sensor"], "KeySensor 1");
  EXPECT_THAT(reply["changes"][1]["refused"].get<std::string>(), HasSubstr("a motion"));
}

TEST_F(ControlAnswer, LocksAndUnlocks) {
  make();
  run(1);
  EXPECT_TRUE(ask(R"({"do":"status"})")["locks"].empty());
  const json locked = ask(R"({"do":"lock","path":"A"})");
  ASSERT_EQ(locked["done"], true) << locked;
  EXPECT_EQ(locked["edit"], "lock A");
  run(2);
  const json status = ask(R"({"do":"status"})");
  ASSERT_EQ(status["locks"].size(), 1u);
  EXPECT_EQ(status["locks"][0]["path"], "A");
  const std::string by = status["locks"][0]["by"];
  EXPECT_EQ(by, "author " + std::to_string(locked["operation"]["author"].get<int>()));
  EXPECT_EQ(ask(R"({"do":"objects"})")["objects"][0]["locked_by"], by);
  EXPECT_FALSE(ask(R"({"do":"objects"})")["objects"][1].contains("locked_by"));
  EXPECT_EQ(ask(R"({"do":"lock","path":"A"})")["refused"], "it is locked already");
  EXPECT_EQ(ask(R"({"do":"unlock","path":"B"})")["refused"], "it is not locked");
  EXPECT_EQ(ask(R"({"do":"lock","path":"D"})")["refused"], "the scene has no D");
  EXPECT_FALSE(ask(R"({"do":"unlock"})")["ok"]);
  EXPECT_EQ(ask(R"({"do":"unlock","path":"A"})")["done"], true);
  run(3);
  EXPECT_TRUE(ask(R"({"do":"status"})")["locks"].empty());
}

TEST_F(ControlAnswer, OwnsAndReleases) {
  make();
  run(1);
  const json owned = ask(R"({"do":"own","path":"C"})");
  ASSERT_EQ(owned["done"], true) << owned;
  EXPECT_EQ(owned["edit"], "own C");
  run(2);
  json operation = owned["operation"];
  operation["do"] = "operation";
  EXPECT_EQ(ask(operation.dump())["applied"], true);
  EXPECT_EQ(node->peer().owner(*node->scene().find("C")), node->peer().id());
  EXPECT_EQ(ask(R"({"do":"release","path":"C"})")["done"], true);
  run(3);
  EXPECT_EQ(node->peer().owner(*node->scene().find("C")), kNobody);
  EXPECT_EQ(ask(R"({"do":"release","path":"C"})")["refused"], "this peer does not own it");
  EXPECT_EQ(ask(R"({"do":"grab","path":"D"})")["refused"], "the scene has no D");
  EXPECT_FALSE(ask(R"({"do":"own"})")["ok"]);
}

TEST_F(ControlAnswer, EditsTheScene) {
  make();
  run(1);
  const json added = ask(R"({"do":"add","text":"DEF NEW Transform { }","under":"B"})");
  ASSERT_EQ(added["done"], true) << added;
  json operation = added["operation"];
  operation["do"] = "operation";
  EXPECT_EQ(ask(operation.dump())["applied"], false);
  run(2);
  const json state = ask(operation.dump());
  EXPECT_THAT(state, HasMembers(R"(
    {"applied": true, "held": false, "stored": false, "stores": false, "alone": true})"));
  EXPECT_EQ(node->scene().path_of(*node->scene().find("NEW")), "B/NEW");
  EXPECT_EQ(ask(R"({"do":"set","path":"A","field":"translation","value":"5 6 7"})")["done"], true);
  EXPECT_EQ(ask(R"({"do":"move","path":"B/NEW"})")["done"], true);
  run(3);
  EXPECT_EQ(node->scene().path_of(*node->scene().find("NEW")), "NEW");
  EXPECT_EQ(truth("A").position.y(), 6.0);
  EXPECT_EQ(ask(R"({"do":"remove","path":"MORE"})")["done"], true) << "a node that is no instance";
  EXPECT_EQ(ask(R"({"do":"remove","path":"B"})")["done"], true);
  run(4);
  EXPECT_FALSE(node->scene().find("B"));
  const json gone = ask(R"({"do":"remove","path":"B"})");
  EXPECT_EQ(gone["done"], false);
  EXPECT_EQ(gone["refused"], "the scene has no B");
  EXPECT_EQ(ask(R"({"do":"key","key":"a"})")["hits"], 1) << "of the sensors the other one is left";
  const json world = ask(R"({"do":"world"})");
  EXPECT_THAT(world["world"].get<std::string>(), HasSubstr("DEF NEW Transform"));
  EXPECT_EQ(ask(R"({"do":"operation","author":1,"number":99})")["refused"], "this peer has made no such operation");
}

TEST_F(ControlAnswer, KeepsDataAtNodes) {
  make();
  run(1);
  EXPECT_EQ(ask(R"({"do":"data","path":"A","key":"colour"})")["refused"], "it has no such key");
  const json set = ask(R"({"do":"data","path":"A","key":"colour","value":"red"})");
  ASSERT_EQ(set["done"], true) << set;
  EXPECT_EQ(set["edit"], "data A colour");
  EXPECT_EQ(ask(R"({"do":"data","path":"MORE","key":"k","value":""})")["done"], true) << "a node that is no instance";
  run(2);
  EXPECT_EQ(ask(R"({"do":"data","path":"A","key":"colour"})")["value"], "red");
  EXPECT_EQ(ask(R"({"do":"data","path":"MORE","key":"k"})")["value"], "");
  EXPECT_EQ(ask(R"({"do":"data","path":"A"})")["keys"], json::array({"colour"}));
  EXPECT_EQ(ask(R"({"do":"data","path":"A","key":"colour","remove":true})")["edit"], "data A colour removed");
  run(3);
  EXPECT_EQ(ask(R"({"do":"data","path":"A"})")["keys"], json::array());
  EXPECT_EQ(ask(R"({"do":"data","path":"NONE"})")["refused"], "the scene has no NONE");
  const json long_key = ask(json{{"do", "data"}, {"path", "A"}, {"key", std::string(257, 'k')}, {"value", ""}}.dump());
  EXPECT_EQ(long_key["refused"], "a key has 1 to 256 bytes, and this one 257");
  const json sent = ask(R"({"do":"send","topic":"chat","text":"hello"})");
  EXPECT_EQ(sent["edit"], "send chat");
  run(4);
  json operation = sent["operation"];
  operation["do"] = "operation";
  EXPECT_EQ(ask(operation.dump())["applied"], true);
}

TEST_F(ControlAnswer, RubbishGetsAReasonAndLeavesThePeerAlone) {
  make();
  run(1);
  EXPECT_EQ(ask("rubbish")["ok"], false);
  EXPECT_THAT(ask("{\"do\":\"key\",\"key\":\"\\u0000\"}")["error"].get<std::string>(), HasSubstr("there is no key"));
  EXPECT_EQ(truth("A").velocity, Vec3(1, 0, 0));
  EXPECT_FALSE(control::answer(*node, now, "{\"do\":\"status\"}").leave);
  EXPECT_TRUE(control::answer(*node, now, "{\"do\":\"leave\"}").leave);
}

TEST_F(ControlAnswer, CountersAndTroublesOfOthersBelongToStatus) {
  make();
  net::TrafficCounters network;
  network.packets_in = 42;
  const auto more = [&] { return More{network.named(), {"it rains"}}; };
  const json with = json::parse(answer(*node, now, R"({"do":"status"})", Duration{0}, more).line);
  EXPECT_EQ(with["counters"]["net.packets_in"], 42);
  EXPECT_EQ(with["troubles"], json::array({"it rains"}));
  EXPECT_FALSE(ask(R"({"do":"status"})")["counters"].contains("net.packets_in"));
}

TEST_F(ControlAnswer, ARefusalIsOneLineOfJsonWhateverItsTextHolds) {
  const std::string line = refusal("no \"\xFF\n\" here");
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const json reply = json::parse(line);
  EXPECT_EQ(reply["v"], 1);
  EXPECT_EQ(reply["ok"], false);
  EXPECT_EQ(reply["error"], "no \"\uFFFD\n\" here") << "a byte that is no UTF-8 is replaced";
}

}  // namespace peerd::control::answer_test
