// A real peer, watched and steered by WebSockets over loopback.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "peerd/view/frames/pose_frame.hpp"
#include "tests/peerd/view/gateway/served_peer.hpp"
#include "tests/peerd/view/gateway/web_client.hpp"

namespace peerd::gateway::live_connection_test {

using nlohmann::json;
using testing::HasSubstr;
using testing_support::LiveClient;
using testing_support::ServedPeer;
using testing_support::WebClient;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF CAR Transform { velocityVector 1 0 0 children Shape { geometry Box { } } }
DEF STONE Transform { translation 0 0 -9 children Shape { geometry Box { } } }
DEF PUSH KeySensor { recipient "CAR" keyValue 65 value 2 0 0 }
)";

struct Frame {
  explicit Frame(const std::string& bytes) {
    const auto read = [&](auto& value, std::size_t at) { std::memcpy(&value, bytes.data() + at, sizeof(value)); };
    if (bytes.size() < view::kPoseFrameHeader_bytes) {
      ADD_FAILURE() << "a frame of " << bytes.size() << " bytes";
      return;
    }
    read(magic, 0);
    read(count, 4);
    read(session_s, 8);
    read(revision, 32);
    read(row_bytes, 36);
    EXPECT_EQ(bytes.size(), view::kPoseFrameHeader_bytes + count * view::kPoseRow_bytes);
    rows.resize(count);
    std::memcpy(rows.data(), bytes.data() + view::kPoseFrameHeader_bytes, count * view::kPoseRow_bytes);
  }
  std::uint32_t magic = 0, count = 0, revision = 0, row_bytes = 0;
  double session_s = 0.0;
  std::vector<view::PoseRow> rows;
};

class GatewayLive : public testing::Test {
 protected:
  // The first row of that node and kind that comes.
  view::PoseRow row_of(LiveClient& client, std::uint32_t node) {
    for (int frames = 0; frames < 1000; ++frames) {
      for (const view::PoseRow& row : Frame(client.next_frame()).rows) {
        if (row.node == node) return row;
      }
    }
    ADD_FAILURE() << "no row of node " << node;
    return {};
  }
  std::uint32_t node_of(LiveClient& client, const std::string& path) {
    for (std::uint32_t node = 0; node < 100; ++node) {
      const json seen = client.ask({{"do", "inspect"}, {"node", node}});
      if (seen["ok"] == false) break;
      if (seen["path"] == path) return node;
    }
    ADD_FAILURE() << "no node is " << path;
    return 0;
  }

  ServedPeer peer{kWorld, {"CAR"}};
};

TEST_F(GatewayLive, RepliesRepeatTheNumberOfTheirRequest) {
  LiveClient client(peer);
  EXPECT_EQ(client.ask({{"do", "status"}})["peer"]["name"], "a");
  EXPECT_EQ(client.ask({{"do", "nonsense"}})["ok"], false);
  EXPECT_EQ(client.ask({{"do", "watch"}, {"hz", 1e9}})["ok"], false);
  client.send_text(R"({"do":"objects"})");
  ASSERT_TRUE(client.read());
}

TEST_F(GatewayLive, FramesSayWhereThingsAreNow) {
  LiveClient client(peer);
  peer.await_start();
  EXPECT_EQ(client.ask({{"do", "watch"}, {"hz", 60}, {"kinds", {"shown", "truth", "ghost"}}})["ok"], true);
  const Frame first(client.next_frame());
  EXPECT_EQ(first.magic, view::kPoseFrameMagic);
  EXPECT_EQ(first.row_bytes, view::kPoseRow_bytes);
  const std::uint32_t car = node_of(client, "CAR");
  const auto early = row_of(client, car);
  EXPECT_EQ(early.owner, 1U);
  EXPECT_NE(early.flags & view::kOwn, 0);
  double before_s = first.session_s;
  for (int frames = 0; frames < 30; ++frames) {
    const Frame frame(client.next_frame());
    EXPECT_GE(frame.session_s, before_s);
    before_s = frame.session_s;
  }
  EXPECT_GT(row_of(client, car).position[0], early.position[0]);
  EXPECT_EQ(client.ask({{"do", "unwatch"}})["ok"], true);
}

TEST_F(GatewayLive, PicksByTheDaemonsOwnRay) {
  LiveClient client(peer);
  const json hit = client.ask({{"do", "pick"}, {"origin_m", {0, 0, -20}}, {"direction", {0, 0, 1}}});
  ASSERT_EQ(hit["ok"], true) << hit;
  EXPECT_EQ(hit["hit"]["path"], "STONE");
  EXPECT_EQ(hit["hit"]["distance_m"], 10.0);
  EXPECT_EQ(hit["hit"]["owner"], nullptr);
  EXPECT_EQ(client.ask({{"do", "pick"}, {"origin_m", {0, 50, 0}}, {"direction", {0, 1, 0}}})["hit"], nullptr);
  EXPECT_EQ(client.ask({{"do", "pick"}, {"origin_m", {0, 50, 0}}, {"direction", {0, 0, 0}}})["ok"], false);
}

TEST_F(GatewayLive, TellsItsSurroundingsAndHierarchies) {
  LiveClient client(peer);
  peer.await_start();
  const json around = client.ask({{"do", "surroundings"}});
  ASSERT_EQ(around["ok"], true) << around;
  EXPECT_EQ(around["regions"]["cell_m"], 0.0);
  EXPECT_TRUE(around["proximity"]["objects"].is_array());
  const json root = client.ask({{"do", "hierarchy"}, {"path", "STONE"}});
  ASSERT_EQ(root["ok"], true) << root;
  EXPECT_EQ(root["volumes"].size(), 1u);
  EXPECT_EQ(root["level"], 0);
  EXPECT_GT(client.ask({{"do", "hierarchy"}, {"path", "STONE"}, {"level", 1}})["volumes"].size(), 1u);
  EXPECT_EQ(client.ask({{"do", "hierarchy"}, {"path", "NOTHING"}})["ok"], false);
}

TEST_F(GatewayLive, WithoutTheTokenNothingChanges) {
  LiveClient client(peer);
  peer.await_start();
  for (const json& request : std::vector<json>{{{"do", "key"}, {"key", "a"}},
                                               {{"do", "add"}, {"text", "DEF NEW Transform { }"}},
                                               {{"do", "pose"}, {"object", "CAR"}, {"position_m", {1, 2, 3}}},
                                               {{"do", "leave"}},
                                               {{"do", "token"}, {"token", "0123456789abcdefghijkm"}},
                                               {{"do", "grab"}, {"path", "CAR"}}}) {
    const json reply = client.ask(request);
    EXPECT_EQ(reply["ok"], false) << request;
    EXPECT_THAT(reply["error"].get<std::string>(), HasSubstr("token"));
  }
  EXPECT_EQ(peer.counter("keys"), 0U);
  EXPECT_EQ(peer.counter("operations"), 0U);
  EXPECT_EQ(peer.counter("gateway.refused_token"), 6U);
  EXPECT_EQ(client.ask({{"do", "token"}, {"token", ServedPeer::kToken}})["ok"], true);
  EXPECT_EQ(client.ask({{"do", "key"}, {"value", 65}})["hits"], 1);
  LiveClient another(peer);
  EXPECT_EQ(another.ask({{"do", "key"}, {"value", 65}})["ok"], false) << "each connection shows it for itself";
}

// Each client has kinds of its own, and edits are seen by all of them as another revision.
TEST_F(GatewayLive, EventsGoToThoseWhoWantThem) {
  LiveClient messages(peer, true), data(peer, true), watcher(peer);
  EXPECT_EQ(messages.ask({{"do", "subscribe"}, {"to", {"messages"}}})["subscribed"], json({"messages"}));
  EXPECT_EQ(data.ask({{"do", "subscribe"}, {"to", {"data"}}})["ok"], true);
  peer.await_start();
  EXPECT_EQ(messages.ask({{"do", "data"}, {"path", "CAR"}, {"key", "k"}, {"value", "v"}})["done"], true);
  EXPECT_EQ(messages.ask({{"do", "send"}, {"topic", "t"}, {"text", "hello"}})["done"], true);
  EXPECT_EQ(messages.next_event()["text"], "hello");
  const json changed = data.next_event();
  EXPECT_EQ(changed["event"], "data");
  EXPECT_EQ(changed["value"], "v");
  const json added = data.ask({{"do", "add"}, {"text", "DEF BOX Transform { children Shape { geometry Box { } } }"}});
  EXPECT_EQ(added["done"], true) << added;
  for (LiveClient* const client : {&messages, &data, &watcher}) {
    const json scene = client->next_event();
    EXPECT_EQ(scene["event"], "scene");
    EXPECT_EQ(scene["revision"], 2) << scene;
  }
  WebClient web(peer);
  EXPECT_THAT(web.get("/api/v1/scene.glb").body(), HasSubstr("BOX"));
}

// The avatar of a page goes when the page does, and the peer looks as before.
TEST_F(GatewayLive, AnAvatarGoesWithItsConnection) {
  peer.await_start();
  const auto has_avatar = [&] {
    return peer.in_its_thread([&] { return peer.node().scene().find("ME").has_value(); });
  };
  const auto viewpoint = [&] {
    return peer.in_its_thread([&] { return peer.node().peer().config().decisions.viewpoint; });
  };
  {
    LiveClient client(peer, true);
    EXPECT_EQ(client.ask({{"do", "add"}, {"text", "DEF ME Transform { children Shape { geometry Box { } } }"}})["done"],
              true);
    EXPECT_TRUE(ServedPeer::soon(has_avatar));
    LiveClient reader(peer);
    EXPECT_EQ(reader.ask({{"do", "avatar"}, {"path", "ME"}})["ok"], false) << "it has no token";
    EXPECT_EQ(client.ask({{"do", "avatar"}, {"path", "ME"}})["ok"], true);
    EXPECT_EQ(client.ask({{"do", "viewpoint"}, {"object", "ME"}, {"position_m", {0, 0, 0}}})["done"], true);
    EXPECT_EQ(client.ask({{"do", "viewpoint"}, {"object", "YOU"}, {"position_m", {0, 0, 0}}})["done"], false);
    EXPECT_TRUE(has_avatar());
    ASSERT_TRUE(viewpoint());
    EXPECT_TRUE(viewpoint()->object);
  }
  EXPECT_TRUE(ServedPeer::soon([&] { return !has_avatar(); }));
  EXPECT_FALSE(viewpoint());
}

// The stone's face is at z = -10 on this side; the rays are the daemon's own.
TEST_F(GatewayLive, WhoWalksEndsAtWhatCollides) {
  LiveClient client(peer);
  const auto go = [&](const json& members) {
    json request = {{"do", "walk"}, {"eye_m", {0, 0, -20}}, {"by_m", {0, 0, 15}}, {"falls", false}, {"height_m", 0.1}};
    request.update(members);
    return client.ask(request);
  };
  const json stopped = go(json::object());
  ASSERT_EQ(stopped["ok"], true) << stopped;
  EXPECT_NEAR(stopped["eye_m"][2].get<double>(), -10.25, 1e-4);
  EXPECT_NEAR(go({{"by_m", {0, 0, 3}}})["eye_m"][2].get<double>(), -17.0, 1e-12);
  EXPECT_NEAR(go({{"by_m", {3, 0, 0}}})["eye_m"][0].get<double>(), 3.0, 1e-12);
}

}  // namespace peerd::gateway::live_connection_test
