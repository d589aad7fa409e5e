// Objects that an external program moves, at one peer, by datagrams and through its control interface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/feed/pose_message.hpp"
#include "peerd/peer/node/describe.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "tests/has_members.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::peer_node_feed_test {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF CAR Transform { translation 1 2 3 velocityVector 9 0 0 children Shape { geometry Box { } } }
DEF ARM Transform { children Shape { geometry Box { } } }
DEF FREE Transform { translation 0 50 0 children Shape { geometry Box { } } }
DEF PUSH KeySensor { recipient "CAR" keyValue 65 value 2 0 0 }
)";
constexpr Duration kWallBehind = 3s;  // from Unix time to host time

class PeerNodeFeed : public testing::Test {
 protected:
  PeerNodeFeed() {
    folder.write("w.wrl", kWorld);
    shared = std::move(*share_world(folder / "w.wrl"));
    settings.name = "a";
    settings.id = 1;
    begin({"CAR", "ARM"});
  }
  void begin(const std::vector<std::string>& outside) {
    const auto id = [&](const std::string& path) { return *shared->world.scene.find(path); };
    config::PeerObjects objects;
    objects.owned = {id("CAR"), id("ARM"), id("FREE")};
    for (const std::string& path : outside) objects.outside.emplace(path, id(path));
    node = PeerNode::make(settings, {}, *shared, std::move(objects), {});
  }
  void run(
      Duration time, const std::function<void()>& meanwhile = [] {}) {
    for (const HostTime end = now + time; now < end; now += 1ms) {
      meanwhile();
      node->on_tick(now);
      while (node->poll_output()) {
      }
      while (const auto notice = node->poll_feed_notice()) {
        const LogLine line = describe(*notice);
        if (line.level != LogLevel::kDebug) said += line.text + "\n";
      }
    }
  }
  [[nodiscard]] KinematicState truth(const char* path) const {
    return node->peer().truth(*shared->world.scene.find(path), node->peer().clock().to_session(now));
  }
  json ask(const json& request) { return json::parse(control::answer(*node, now, request.dump(), kWallBehind).line); }
  void datagram(const std::string& text) {
    if (const auto message = feed::parse_pose_message(text)) {
      (void)node->on_poses(now, kWallBehind, message->poses);
    } else {
      node->refuse_poses(message.error());
    }
  }
  [[nodiscard]] double unix_s() const { return to_seconds(now.time_since_epoch() - kWallBehind); }
  std::uint64_t count(const std::string& name) { return node->log().counters.at(name); }

  testing_support::ScratchFolder folder;
  std::unique_ptr<const SharedWorld> shared;
  config::PeerSettings settings;
  std::unique_ptr<PeerNode> node;
  HostTime now{1000s};
  std::string said;
};

// A pose between two ticks is published at once, not 16 ms later.
TEST_F(PeerNodeFeed, GhostErrorsAboveTheThresholdArePublishedAtOnce) {
  run(3s);
  const auto jumps_to = [&](double x) {
    datagram(json{{"do", "pose"}, {"object", "CAR"}, {"position_m", {x, 0, 0}}, {"jump", true}}.dump());
    std::size_t sent = 0;
    while (const auto out = node->poll_output()) sent += std::holds_alternative<replication::Send>(*out);
    return sent;
  };
  const ObjectId car = *shared->world.scene.find("CAR");
  const auto believed = [&] { return node->peer().ghost(car, node->peer().clock().to_session(now)).position.x(); };
  while (node->peer().due_tick(now)) run(1ms);
  EXPECT_EQ(jumps_to(7.0), 1u);
  EXPECT_NEAR(believed(), 7.0, 0.01);
  now += 1ms;
  EXPECT_EQ(jumps_to(8.0), 0u) << "once between two ticks";
  run(20ms);
  EXPECT_NEAR(believed(), 8.0, 0.01) << "the tick published it";
  EXPECT_EQ(jumps_to(8.0), 0u) << "nobody is wrong about it";
  const std::uint64_t before = count("updates_out");
  now += 20ms;  // a due tick has not run yet
  EXPECT_GE(jumps_to(9.0), 1u);
  EXPECT_NEAR(believed(), 9.0, 0.01) << "it does not wait for the tick after";
  EXPECT_EQ(count("updates_out"), before + 1);
  EXPECT_EQ(count("updates_at_once"), 2u);
}

TEST_F(PeerNodeFeed, StandsUntilTheFirstPoseAndFollowsFromThen) {
  run(3s);
  ASSERT_TRUE(node->start());
  EXPECT_EQ(truth("CAR").position, Vec3(1, 2, 3)) << "its velocityVector is not for it";
  int i = 0;
  run(1s, [&] {  // 30 Hz, 4 m/s, 5 ms late
    if (i++ % 33 != 0) return;
    const double t = to_seconds(now - HostTime{1003s}) - 0.005;
    datagram(
        json{{"do", "pose"}, {"object", "CAR"}, {"position_m", {4 * t, 0, 0}}, {"time_s", unix_s() - 0.005}}.dump());
  });
  const double t = to_seconds(now - HostTime{1003s});
  EXPECT_NEAR(truth("CAR").position.x(), 4 * t, 1e-4) << "at the instant, not at the last pose or the last tick";
  EXPECT_NEAR(truth("CAR").velocity.x(), 4.0, 1e-4);
  EXPECT_EQ(truth("ARM").position, Vec3::Zero());
  EXPECT_EQ(count("poses_taken"), 31u);
  EXPECT_EQ(said, "a program moves CAR\n");
}

TEST_F(PeerNodeFeed, SilenceIsLoggedOnceAndCounted) {
  run(2s);
  for (int silence = 0; silence < 3; ++silence) {
    run(200ms, [&] { ask({{"do", "pose"}, {"object", "CAR"}, {"position_m", {unix_s(), 0, 0}}}); });
    run(700ms);
    EXPECT_EQ(truth("CAR").velocity, Vec3::Zero());
  }
  EXPECT_EQ(said, "a program moves CAR\nCAR stands still: the program that moves it is silent\nCAR gets poses again\n");
  EXPECT_EQ(count("feeds_silent"), 3u);
}

// Nanoseconds in an int64 end in the year 2262. Where the wall clock is ahead of the host's, a later time must not
// overflow to one of the past.
TEST_F(PeerNodeFeed, TimesOfOtherCenturiesDoNotWrapRound) {
  run(2s);
  const auto refused = [&](double time_s) {
    const json request{{"do", "pose"}, {"object", "CAR"}, {"position_m", {0, 0, 0}}, {"time_s", time_s}};
    const json reply = json::parse(control::answer(*node, now, request.dump(), -1ns).line);
    return reply["refused"].empty() ? "" : reply["refused"][0]["why"].get<std::string>();
  };
  for (const double time_s : {9.1e9, 9.5e9, 1e10, 1e300}) EXPECT_THAT(refused(time_s), HasSubstr("from 0 to 9e9 s"));
  for (const double time_s : {8.9e9, 9e9}) EXPECT_THAT(refused(time_s), HasSubstr("ahead of this computer's clock"));
  EXPECT_EQ(count("poses_refused_time"), 4u);
}

TEST_F(PeerNodeFeed, AMessageHasManyPosesAndItsReplySaysWhatBecameOfEach) {
  run(2s);
  const json reply = ask({{"do", "pose"},
                          {"time_s", unix_s()},
                          {"poses",
                           {{{"object", "CAR"}, {"position_m", {1, 1, 1}}, {"orientation_xyzw", {0, 0, 1, 0}}},
                            {{"object", "ARM"}, {"position_m", {2, 2, 2}}, {"time_s", unix_s() + 9}},
                            {{"object", "FREE"}, {"position_m", {3, 3, 3}}},
                            {{"object", "ARM"}, {"position_m", {2e9, 2, 2}}}}}});
  EXPECT_THAT(reply, HasMembers(R"({"ok": true, "done": false, "taken": 1})"));
  ASSERT_EQ(reply["refused"].size(), 3u);
  EXPECT_EQ(reply["refused"][0]["object"], "ARM");
  EXPECT_THAT(reply["refused"][0]["why"].get<std::string>(), HasSubstr("ahead of this computer's clock"));
  EXPECT_THAT(reply["refused"][1]["why"].get<std::string>(), HasSubstr("outside = true"));
  EXPECT_THAT(reply["refused"][2]["why"].get<std::string>(), HasSubstr("1e9 m"));
  run(20ms);
  EXPECT_EQ(truth("CAR").position, Vec3(1, 1, 1));
  EXPECT_EQ(truth("CAR").orientation.z(), 1.0) << "x y z w";
  EXPECT_EQ(count("poses_refused"), 3u);
  EXPECT_EQ(count("poses_refused_too_far_ahead"), 1u);
  EXPECT_EQ(count("poses_refused_object"), 1u);
  EXPECT_EQ(count("poses_refused_position"), 1u);
  EXPECT_THAT(said, HasSubstr("a pose of FREE is not used: no object of that name"));
}

TEST_F(PeerNodeFeed, AProgramNeedNotReadReplies) {
  const json request = {{"do", "pose"}, {"object", "CAR"}, {"position_m", {0, 0, 0}}, {"reply", false}};
  EXPECT_EQ(control::answer(*node, now, request.dump()).line, "");
  EXPECT_EQ(count("poses_taken"), 1u);
}

TEST_F(PeerNodeFeed, ByUdpNothingButPosesIsTaken) {
  datagram(R"({"do":"leave"})");
  datagram("rubbish");
  datagram("");
  EXPECT_EQ(count("pose_messages_refused"), 3u);
  run(1500ms);
  EXPECT_EQ(said,
            "a datagram that is no message of poses: by UDP \"do\" must be \"pose\"; more such are only counted\n");
}

// A log line is one line, and can be put into JSON.
TEST_F(PeerNodeFeed, UntrustedTextIsSanitisedForTheLog) {
  const std::string name = std::string(159, 'x') + "\u00e4\n" + std::string(1000, 'y');
  ask({{"do", "pose"}, {"object", name}, {"position_m", {0, 0, 0}}});
  datagram(R"({"do":"pose","\u000a\u0000\u00e4":1})");
  run(10ms);
  EXPECT_EQ(said, "a pose of " + std::string(159, 'x') +
                      "? is not used: no object of that name is moved by a program here (motion.OBJECT.outside = "
                      "true), nor grabbed by this peer; more such are only counted\na datagram that is no message of "
                      "poses: \"object\" is "
                      "missing; more such are only counted\n");
  begin({"CAR", "ARM"});
  said.clear();
  datagram(R"({"do":"pose","poses":[],"\u000a\u0000\u00e4":1})");
  run(10ms);
  EXPECT_THAT(said, HasSubstr("unknown member \"????\""));
}

TEST_F(PeerNodeFeed, AKeyDoesNotMoveWhatAProgramMoves) {
  run(3s);
  EXPECT_THAT(node->on_key(now, {'A', 0}).changes.at(0).refused, HasSubstr("a program outside moves it"));
  const json objects = ask({{"do", "objects"}})["objects"];
  ASSERT_EQ(objects.size(), 3u);
  EXPECT_EQ(objects[0]["outside"], true);
  EXPECT_EQ(objects[0]["driven"], true);
  EXPECT_EQ(objects[2]["outside"], false);
}

// A hand takes what its peer has grabbed, at 30 Hz, without any configuration.
class PeerNodeHand : public PeerNodeFeed {
 protected:
  PeerNodeHand() {
    begin({});
    run(3s);
    EXPECT_TRUE(node->start());
  }
  json pose(double x, const char* object = "FREE") {
    return ask({{"do", "pose"}, {"object", object}, {"position_m", {x, 50, 0}}, {"time_s", unix_s()}});
  }
  // Moves FREE along x for half a second with that speed [m/s]; where it is at the end.
  double drag(double speed, double from) {
    const HostTime begun = now;
    const auto x = [&] { return from + speed * to_seconds(now - begun); };
    int i = 0;
    run(500ms, [&] {
      if (i++ % 33 != 0) return;
      EXPECT_EQ(pose(x())["taken"], 1);
    });
    EXPECT_EQ(pose(x())["taken"], 1);
    return x();
  }
  void grab() {
    EXPECT_EQ(ask({{"do", "grab"}, {"path", "FREE"}})["done"], true);
    run(300ms);
  }
  json row_of_free() { return ask({{"do", "objects"}})["objects"][2]; }
};

TEST_F(PeerNodeHand, WhatIsNotGrabbedItDoesNotMove) {
  EXPECT_EQ(pose(1)["taken"], 0);
  EXPECT_THAT(pose(1)["refused"][0]["why"].get<std::string>(), HasSubstr("nor grabbed by this peer"));
  EXPECT_EQ(ask({{"do", "own"}, {"path", "FREE"}})["done"], true);
  run(300ms);
  EXPECT_EQ(pose(1)["taken"], 0) << "owned, but not grabbed";
  EXPECT_EQ(truth("FREE").position, Vec3(0, 50, 0));
}

TEST_F(PeerNodeHand, MovesWhatIsGrabbedAndThrowsIt) {
  grab();
  EXPECT_EQ(row_of_free()["outside"], false) << "until the first pose";
  const double end = drag(2.0, 0.0);
  EXPECT_NEAR(truth("FREE").position.x(), end, 0.01);
  EXPECT_EQ(row_of_free()["outside"], true);
  EXPECT_EQ(ask({{"do", "let_go"}, {"path", "FREE"}})["done"], true);
  EXPECT_EQ(row_of_free()["outside"], false);
  EXPECT_EQ(row_of_free()["own"], true);
  EXPECT_NEAR(truth("FREE").velocity.x(), 2.0, 0.01) << "the throw's velocity is the hand's";
  run(1s);
  EXPECT_NEAR(truth("FREE").position.x(), end + 2.0, 0.02);
  EXPECT_NEAR(node->peer().ghost(*shared->world.scene.find("FREE"), node->peer().clock().to_session(now)).position.x(),
              end + 2.0, 0.02)
      << "all others predict it so";
  EXPECT_EQ(ask({{"do", "let_go"}, {"path", "FREE"}})["done"], false);
  const double caught = drag(0.0, 7.0);
  EXPECT_EQ(ask({{"do", "let_go"}, {"path", "FREE"}})["done"], true);
  run(500ms);
  EXPECT_NEAR(truth("FREE").position.x(), caught, 1e-6) << "it takes hold of it again, and lets go at rest";
}

TEST_F(PeerNodeHand, AStillHandLetsGoAtRest) {
  grab();
  (void)drag(2.0, 0.0);
  run(1s);  // silence: it stands
  const Vec3 before = truth("FREE").position;
  EXPECT_EQ(truth("FREE").velocity, Vec3::Zero());
  EXPECT_EQ(ask({{"do", "let_go"}, {"path", "FREE"}})["done"], true);
  run(500ms);
  EXPECT_EQ(truth("FREE").position, before);
}

TEST_F(PeerNodeHand, AReleaseLetsGoAndMakesItNobodys) {
  grab();
  (void)drag(2.0, 0.0);
  EXPECT_EQ(ask({{"do", "release"}, {"path", "FREE"}})["done"], true);
  EXPECT_NEAR(truth("FREE").velocity.x(), 2.0, 0.01);
  run(500ms);
  EXPECT_EQ(node->peer().owner(*shared->world.scene.find("FREE")), kNobody);
  EXPECT_EQ(pose(1)["taken"], 0);
}

// A wrong pose takes hold of nothing: what moves goes on.
TEST_F(PeerNodeHand, TakesHoldWithAGoodPoseOnly) {
  grab();
  (void)drag(2.0, 0.0);
  EXPECT_EQ(ask({{"do", "let_go"}, {"path", "FREE"}})["done"], true);
  EXPECT_EQ(pose(1e12)["taken"], 0);
  EXPECT_EQ(row_of_free()["outside"], false);
  run(100ms);
  EXPECT_NEAR(truth("FREE").velocity.x(), 2.0, 0.01);
}

TEST_F(PeerNodeHand, WhatIsRemovedItDoesNotMove) {
  grab();
  (void)drag(1.0, 0.0);
  EXPECT_EQ(ask({{"do", "remove"}, {"path", "FREE"}})["done"], true);
  run(500ms);
  EXPECT_EQ(pose(1)["taken"], 0);
  EXPECT_EQ(ask({{"do", "let_go"}, {"path", "FREE"}})["done"], false);
  EXPECT_EQ(ask({{"do", "undo"}})["done"], true);
  run(500ms);
  EXPECT_EQ(node->peer().owner(*shared->world.scene.find("FREE")), PeerId{1});
  EXPECT_EQ(pose(1)["taken"], 1) << "it is back, and its peer has it, as before";
}

TEST_F(PeerNodeFeed, APeerWithoutSuchObjectsSaysSo) {
  begin({});
  EXPECT_EQ(ask({{"do", "pose"}, {"object", "CAR"}, {"position_m", {0, 0, 0}}})["taken"], 0);
  EXPECT_FALSE(node->log().counters.contains("poses_taken"));
}

}  // namespace peerd::peer_node_feed_test
