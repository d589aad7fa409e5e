// Edits of the scene while it runs: all peers have the same scene, and from the stamp of an edit on everything collides
// as if the world's file had it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/peer/peers.hpp"

namespace peerd::replication::peer_edit_test {

using namespace test;
using testing::SizeIs;

const std::string kHead = "#VRML V2.0 utf8\n";
// BALL, half a metre wide, flies along x.
const std::string kBall = box("BALL", "0.5 0.5 0.5", "0 0 0", kBounces);

AddNodes adding(const std::string& text) { return {{}, {}, kHead + text, 0, 0, {}}; }
// A wall of 1 m whose face is there.
AddNodes wall_at(int x) {
  return adding(box("WALL", "1 9 9", std::to_string(x) + ".5 0 0") + interest("BALL", "\"WALL\""));
}
class Edits : public Peers {
 protected:
  explicit Edits(const std::string& more = "") : Peers(kBall + box("CAR", "1 1 1", "0 20 0") + more, {"BALL", "CAR"}) {}

  // Peer 1 owns the ball, which physics moves; peer 2 the car.
  void begin() {
    lan = std::make_unique<Lan>(world, Link{.latency = 20ms}, 1);
    lan->add(config(1, {{world["BALL"], false, {.after = 4s, .velocity = Vec3(1, 0, 0)}}}));
    lan->add(config(2, {{world["CAR"]}}), 5s);
    lan->add(config(3));
    lan->run_until(3s);
  }
  [[nodiscard]] SetField setting(std::size_t i, const char* path, const std::string& value) const {
    return {node(path, i), "translation", value, 0};
  }
  // When the ball met something, by peer i [s].
  [[nodiscard]] std::vector<double> contacts_at(std::size_t i) const {
    std::vector<double> times;
    for (const ContactEvent& c : standing_contacts(*lan, i)) {
      times.push_back(to_seconds(c.at.time_since_epoch() - kEpoch));
    }
    return times;
  }
};

TEST_F(Edits, AllPeersHaveTheSceneFromOneInstantOn) {
  begin();
  const OperationId id = edit(1, wall_at(5));
  EXPECT_EQ(scene(1).find("WALL"), std::nullopt) << "not before its stamp";
  lan->run_until(4s);
  expect_one_scene();
  std::vector<SimTime> since;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto seen = lan->seen<SceneEdited>(i);
    ASSERT_THAT(seen, SizeIs(1));
    EXPECT_EQ(seen[0].operation, id);
    EXPECT_EQ(seen[0].refused, "");
    since.push_back(seen[0].at);
  }
  EXPECT_THAT(since, testing::Each(since[0]));
  EXPECT_GE(since[0], lan->session_now(0) - 1s + 90ms);
  EXPECT_THAT(lan->seen<OperationHeld>(1), SizeIs(1));
}

// Without a word of it until long after the ball has gone through.
TEST_F(Edits, WhoHearsLatePredictsAgain) {
  begin();
  lan->run_until(5s);
  lan->filter = [&](std::size_t, std::size_t to, const Message& m) {
    const bool knows_edits = lan->now() > 6s, knows_updates = lan->now() > 9s;  // which say it, too
    return to != 2 || ((m.operations.empty() || knows_edits) && (m.updates.empty() || knows_updates));
  };
  (void)edit(1, wall_at(1));
  lan->run_until(6s);
  EXPECT_EQ(lan->peer(0).ghost(world["BALL"], lan->session_now(0)).velocity.x(), -1.0);
  EXPECT_EQ(lan->peer(2).ghost(world["BALL"], lan->session_now(2)).velocity.x(), 1.0);
  lan->run_until(11s);
  expect_one_scene();
  EXPECT_EQ(contacts_at(2), contacts_at(0));
  expect_one_ghost("BALL");
}

class EditsOfAGroup : public Edits {
 protected:
  EditsOfAGroup()
      : Edits("DEF WALLS Group { children " + box("FAR", "1 9 9", "99 0 0") + " }\n" +
              interest("BALL", "\"WALLS/*\"")) {}
};

TEST_F(EditsOfAGroup, WhatComesIntoItMeetsWhatTheGroupMeets) {
  begin();
  AddNodes wall = adding(box("WALL", "1 9 9", "5.5 0 0"));
  wall.parent = world["WALLS"];
  (void)edit(1, wall);
  lan->run_until(11s);
  expect_one_scene();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(lan->peer(i).ghost(world["BALL"], lan->session_now(i)).velocity.x(), -1.0);
  }
  EXPECT_THAT(contacts_at(0), SizeIs(1));
  EXPECT_EQ(contacts_at(2), contacts_at(0));
}

TEST_F(Edits, AnOwnObjectGoesWhereItsFieldSays) {
  begin();
  (void)edit(1, setting(1, "CAR", "7 20 1"));
  lan->run_until(5s);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(lan->peer(i).ghost(world["CAR"], lan->session_now(i)).position, Vec3(7, 20, 1));
  }
}

// It has no file but that of the beginning, and finds the world as it is.
TEST_F(Edits, APeerThatJoinsHasThemAll) {
  begin();
  (void)edit(1, wall_at(3));
  lan->run_until(9s);
  (void)edit(0, setting(0, "WALL", "9 0 0"));
  lan->run_until(10s);
  lan->leave(1);  // who has made one of them
  lan->run_until(12s);
  lan->add(config(4));
  lan->run_until(16s);
  expect_one_scene();
  expect_one_ghost("BALL");
}

}  // namespace peerd::replication::peer_edit_test
