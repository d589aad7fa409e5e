// Edits of the scene while it runs: all peers have the same scene, and from the stamp of an edit on everything collides
// as if the world's file had it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vrml/document.hpp"
#include "core/writer/writer.hpp"
#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::peer_edit_test {

using namespace test;
using testing::ElementsAre;
using testing::SizeIs;

const std::string kHead = "#VRML V2.0 utf8\n";
// BALL, half a metre wide, flies along x.
const std::string kBall = box("BALL", "0.5 0.5 0.5", "0 0 0", kBounces);

AddNodes adding(const std::string& text) { return {{}, {}, kHead + text, 0, 0, {}}; }
// A wall of 1 m whose face is there.
AddNodes wall_at(int x) {
  return adding(box("WALL", "1 9 9", std::to_string(x) + ".5 0 0") + interest("BALL", "\"WALL\""));
}
SetField setting(const peerd::Scene& scene, const char* path, const std::string& field, const std::string& value) {
  return {scene.document->ids.id_of(scene.at(scene.find(path).value()).node), field, value, 0};
}

class Edits : public testing::Test {
 protected:
  explicit Edits(const std::string& text = kBall + box("CAR", "1 1 1", "0 20 0")) : world(text, {"BALL", "CAR"}) {}

  // Peer 1 owns the ball, which physics moves; peer 2 the car.
  void begin(Link link = {.latency = 20ms}, std::uint64_t seed = 1, std::size_t peers = 3) {
    lan = std::make_unique<Lan>(world, link, seed);
    PeerConfig first = config(1, {{world["BALL"], false, {.after = 4s, .velocity = Vec3(1, 0, 0)}}});
    lan->add(first);
    lan->add(config(2, {{world["CAR"]}}), 5s);
    while (lan->size() < peers) lan->add(config(static_cast<std::uint32_t>(lan->size() + 1)));
    lan->run_until(3s);
  }
  [[nodiscard]] std::string text_at(std::size_t i) const {
    const auto written = write_world(lan->peer(i).scene());
    return written ? written->text : written.error();
  }
  OperationId edit(std::size_t i, OperationBody body) const {
    const auto id = lan->peer(i).edit(lan->host_now(i), std::move(body));
    EXPECT_TRUE(id) << id.error();
    return id.value_or(OperationId{});
  }
  void expect_one_scene() const {
    for (std::size_t i = 1; i < lan->size(); ++i) {
      if (!lan->node(i).running) continue;
      EXPECT_EQ(text_at(0), text_at(i)) << "peer " << i + 1;
    }
  }
  void expect_one_ghost(const char* path) const {
    const SimTime t = lan->session_now(0) - 100ms;
    const ObjectId object = lan->peer(0).scene().find(path).value();
    for (std::size_t i = 1; i < lan->size(); ++i) {
      if (!lan->node(i).running) continue;
      EXPECT_TRUE(same_bits(lan->peer(0).ghost(object, t), lan->peer(i).ghost(object, t))) << "peer " << i + 1;
    }
  }
  // When the ball met something, by peer i [s].
  [[nodiscard]] std::vector<double> contacts_at(std::size_t i) const {
    std::vector<ContactSeen> all;
    for (const auto& [at, out] : lan->node(i).outputs) {
      if (const auto* c = std::get_if<ContactSeen>(&out)) all.push_back(*c);
      if (const auto* back = std::get_if<ContactsRetracted>(&out)) {
        std::erase_if(all, [&](const ContactSeen& c) {
          return back->retracts(c.contact.at, c.contact.collider, c.contact.collidee);
        });
      }
    }
    std::vector<double> times;
    for (const ContactSeen& c : all) times.push_back(to_seconds(c.contact.at.time_since_epoch() - kEpoch));
    return times;
  }

  World world;
  std::unique_ptr<Lan> lan;
};

TEST_F(Edits, AllPeersHaveTheSceneFromOneInstantOn) {
  begin();
  const OperationId id = edit(1, wall_at(5));
  EXPECT_EQ(lan->peer(1).scene().find("WALL"), std::nullopt) << "not before its stamp";
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

// The ball flies from 0 at 4 s, at 1 m/s; it is 0.25 m in front of itself.
TEST_F(Edits, WhatIsAddedIsMetByAll) {
  begin();
  (void)edit(1, wall_at(3));
  lan->run_until(9s);
  const auto met = contacts_at(0);
  ASSERT_THAT(met, SizeIs(1));
  const auto launch = lan->peer(0).ghost(world["BALL"], lan->session_now(0));
  EXPECT_EQ(launch.velocity.x(), -1.0);
  for (std::size_t i = 1; i < 3; ++i) EXPECT_EQ(contacts_at(i), met);
  expect_one_ghost("BALL");
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

TEST_F(Edits, WhatIsRemovedIsGoneForAll) {
  begin();
  (void)edit(1, wall_at(3));
  lan->run_until(5s);
  (void)edit(0, RemoveObject{lan->peer(0).scene().find("WALL").value()});
  lan->run_until(9s);
  expect_one_scene();
  EXPECT_TRUE(contacts_at(0).empty());
  EXPECT_EQ(lan->peer(2).ghost(world["BALL"], lan->session_now(2)).velocity.x(), 1.0);
}

TEST_F(Edits, AnOwnedObjectCanBeRemoved) {
  begin();
  (void)edit(2, RemoveObject{world["CAR"]});
  lan->run_until(5s);
  expect_one_scene();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(lan->peer(i).owner(world["CAR"]), kNobody);
  EXPECT_FALSE(lan->peer(1).owns_any());
  lan->run_until(8s);  // and nobody stumbles
}

TEST_F(Edits, AnOwnObjectGoesWhereItsFieldSays) {
  begin();
  (void)edit(1, setting(lan->peer(1).scene(), "CAR", "translation", "7 20 1"));
  lan->run_until(5s);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(lan->peer(i).ghost(world["CAR"], lan->session_now(i)).position, Vec3(7, 20, 1));
  }
}

TEST_F(Edits, SaysWhyItCannotBe) {
  begin();
  const auto nonsense = lan->peer(0).edit(lan->host_now(0), adding("Transform {"));
  ASSERT_FALSE(nonsense);
  EXPECT_NE(nonsense.error().find("operation:"), std::string::npos) << nonsense.error();
  EXPECT_FALSE(lan->peer(0).edit(lan->host_now(0), RemoveObject{ObjectId(77)}));
  EXPECT_EQ(lan->peer(0).counters().operations, 0u);
}

// It has no file but that of the beginning, and finds the world as it is.
TEST_F(Edits, APeerThatJoinsHasThemAll) {
  begin();
  (void)edit(1, wall_at(3));
  lan->run_until(9s);
  (void)edit(0, setting(lan->peer(0).scene(), "WALL", "translation", "9 0 0"));
  lan->run_until(10s);
  lan->leave(1);  // who has made one of them
  lan->run_until(12s);
  lan->add(config(4));
  lan->run_until(16s);
  expect_one_scene();
  expect_one_ghost("BALL");
}

// Both sides set one field; the later stamp counts everywhere.
TEST_F(Edits, SidesThatWerePartedAgree) {
  begin();
  (void)edit(1, wall_at(30));
  lan->run_until(4s);
  lan->part({2});
  lan->run_until(8s);
  (void)edit(2, setting(lan->peer(2).scene(), "WALL", "translation", "31 0 0"));
  lan->run_until(9s);
  (void)edit(0, setting(lan->peer(0).scene(), "WALL", "translation", "32 0 0"));
  (void)edit(2, wall_at(40));
  lan->run_until(10s);
  EXPECT_NE(text_at(0), text_at(2));
  lan->part({});
  lan->run_until(16s);
  expect_one_scene();
  EXPECT_NE(text_at(0).find("32 0 0"), std::string::npos) << text_at(0);
  EXPECT_NE(text_at(0).find("40.5 0 0"), std::string::npos) << text_at(0);
}

// Many edits of all peers on a bad link, with partitions and departures.
TEST_F(Edits, AreTheSameWhateverGetsLost) {
  std::uint64_t refused = 0, applied = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    const auto draw = [&](std::uint64_t n) { return random() % n; };
    begin({.latency = 30ms, .jitter = 40ms, .loss = 0.05 * static_cast<double>(draw(6)), .duplicates = 0.05}, seed, 5);
    for (int k = 0; k < 25; ++k) {
      lan->run_until(lan->now() + std::chrono::milliseconds(draw(400)));
      if (draw(8) == 0) lan->part(draw(2) == 0 ? std::set<std::size_t>{} : std::set<std::size_t>{draw(5), draw(5)});
      const std::size_t i = draw(5);
      const peerd::Scene& scene = lan->peer(i).scene();
      if (scene.instances.empty()) continue;
      const auto any = [&] { return scene.id_of(static_cast<std::uint32_t>(draw(scene.instances.size()))); };
      OperationBody body = wall_at(static_cast<int>(10 + draw(90)));
      if (draw(3) == 0) body = RemoveObject{any()};
      if (draw(3) == 0) body = MoveObject{any(), any(), {}};
      if (draw(3) == 0) {
        body = SetField{scene.document->ids.id_of(scene.at(any()).node), "translation", std::to_string(k) + " 0 0", 0};
      }
      refused += lan->peer(i).edit(lan->host_now(i), std::move(body)) ? 0 : 1;
    }
    lan->part({});
    lan->run_until(lan->now() + 12s);
    expect_one_scene();
    applied += lan->peer(0).counters().scene_changes;
    if (HasFailure()) FAIL() << "seed " << seed;
  }
  EXPECT_GT(applied, 100u);
  EXPECT_GT(refused, 10u);
}

}  // namespace peerd::replication::peer_edit_test
