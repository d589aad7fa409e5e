#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/replication/peer/lan.hpp"

// Collisions between what peers run: predicted, tracked, decided.
namespace peerd::replication::peer_collision_test {

using namespace test;

using testing::IsEmpty;

// ---- remote collision prediction ----

// A former defect: a peer that joined received the state of a flying ball. From then on the ghosts met each wall at the
// time that follows from this state, and the truth at the time that follows from the state before it, a nanosecond
// apart.
TEST(Prediction, TheTruthContinuesFromThePublishedState) {
  const World world(corridor(std::string(kBounces) + "velocityVector 2 0 0 "));
  for (int i = 0; i < 8; ++i) {
    SCOPED_TRACE(i);
    Lan lan(world);
    lan.add(config(1, {{world["BALL"], false}}));
    lan.add(config(2));
    lan.run_until(2s + i * 370ms);
    lan.add(config(3));
    lan.run_until(20s);
    std::vector<std::set<SimTime>> times(3);
    for (std::size_t peer = 0; peer < 3; ++peer) {
      for (const ContactSeen& c : lan.contacts(peer, peer == 0 ? ContactKind::kOwner : ContactKind::kPredicted)) {
        if (c.contact.at > SimTime{kEpoch + 8s} && c.contact.at < SimTime{kEpoch + 19s})
          times[peer].insert(c.contact.at);
      }
    }
    EXPECT_GE(times[0].size(), 3u);
    EXPECT_EQ(times[1], times[0]);
    EXPECT_EQ(times[2], times[0]);
    const SimTime then = lan.session_now(0) - 1s;
    const KinematicState truth = lan.peer(0).truth(world["BALL"], then);
    for (std::size_t peer = 0; peer < 3; ++peer) {
      EXPECT_TRUE(same_bits(lan.peer(peer).ghost(world["BALL"], then), truth)) << peer;
    }
  }
}

// ---- adaptive collision prediction tracking ----

// CAR drives by CUBE and back, so that it is near it around each whole ten seconds.
KinematicState to_and_fro(SimTime t) {
  const double phase = 0.2 * std::numbers::pi * to_seconds(t.time_since_epoch() - kEpoch);
  const double s = std::sin(phase), c = std::cos(phase), w = 0.2 * std::numbers::pi;
  return moving({20 * c, 0, 0}, {-20 * w * s, 0, 0}, {-20 * w * w * c, 0, 0});
}
// Which objects are near is decided in proximity_threshold_test.
TEST(Tracking, TightensNearRemoteObjects) {
  const World world(box("CAR", "2 1 1", "20 0 0") + box("CUBE", "1 1 1", "20 2 0") + interest("CAR", "\"CUBE\""));
  for (const bool track : {true, false}) {
    Lan lan(world, {5ms, 0ms, 0, 0});
    for (const std::uint32_t id : {1u, 2u}) {
      PeerConfig c = config(id, {{world[id == 1 ? "CAR" : "CUBE"], id == 1}});
      c.policy.track_proximity = track;
      std::map<ObjectId, Lan::Motion> motions;
      if (id == 1) motions[world["CAR"]] = to_and_fro;
      lan.add(c, 0s, motions);
    }
    lan.run_until(3s);
    lan.node(0).outputs.clear();
    lan.run_until(33s);
    std::set<double> thresholds;
    for (const Published& p : lan.seen<Published>(0)) {
      thresholds.insert(p.threshold_m);
      const double distance = (to_and_fro(p.at).position - Vec3(20, 2, 0)).norm();
      if (distance > 15.0) {
        EXPECT_EQ(p.threshold_m, 0.5) << "far away";
      }
      if (distance < 2.0 && track) {
        EXPECT_EQ(p.threshold_m, 0.01) << "near";
      }
    }
    EXPECT_EQ(thresholds, track ? (std::set<double>{0.01, 0.5}) : std::set<double>{0.5});
    EXPECT_EQ(lan.peer(0).counters().proximity_tests > 0, track);
  }
}

// ---- decisions ----

// CAR starts towards CUBE as soon as its owner is in the session. Peers: 0 runs CAR, 1 runs CUBE, 2 watches.
struct Roles {
  const char* name;
  std::uint32_t car, cube;  // ids
  bool mutual;
};
class Decision : public testing::TestWithParam<Roles> {
 protected:
  static std::string text(bool mutual) {
    return box("CAR", "1 1 1", "0 0 0", std::string("velocityVector 2 0 0") + kBounces) +
           box("CUBE", "1 1 1", "12 0 0", std::string("velocityVector -1 0 0") + kBounces) +
           interest("CAR", "\"CUBE\"") + (mutual ? interest("CUBE", "\"CAR\"") : "");
  }
  Decision() {
    lan.add(config(GetParam().car, {{world["CAR"], false}}));
    lan.add(config(GetParam().cube, {{world["CUBE"], false}}), 3s);
    lan.add(config(9), -3s);
  }
  [[nodiscard]] std::size_t decider() const { return GetParam().car < GetParam().cube ? 0 : 1; }
  // Runs until the decision is made and its outcome is `later` old.
  void run(Duration later) {
    while (lan.contacts(decider(), ContactKind::kDecided).empty() && lan.now() < 20s) lan.run_until(lan.now() + 1ms);
    lan.run_until(lan.now() + later);
  }

  World world{text(GetParam().mutual)};
  Lan lan{world, {60ms, 0ms, 0, 1.0}};  // all comes twice
};

TEST_P(Decision, TheLowerIdAloneDecidesAndAllApplyIt) {
  run(1s);
  const auto decided = lan.contacts(decider(), ContactKind::kDecided);
  ASSERT_EQ(decided.size(), 1u);
  const ContactEvent& c = decided[0].contact;
  EXPECT_EQ(c.collider, world["CAR"]);
  for (const std::size_t i : {1 - decider(), std::size_t{2}}) {
    EXPECT_THAT(lan.contacts(i, ContactKind::kDecided), IsEmpty()) << i;
    EXPECT_THAT(lan.contacts(i, ContactKind::kOwner), IsEmpty()) << i;
    const auto applied = lan.contacts(i, ContactKind::kApplied);
    ASSERT_EQ(applied.size(), 1u) << i;
    EXPECT_EQ(applied[0].contact.at, c.at);
    EXPECT_EQ(applied[0].contact.collidee, c.collidee);
    EXPECT_TRUE(same_bits(applied[0].contact.collider_after, c.collider_after));
    EXPECT_TRUE(same_bits(applied[0].contact.collidee_after, c.collidee_after));
    EXPECT_EQ(lan.drops(i, "decision_known"), 1u) << "copies merge into one";
    EXPECT_GE(applied[0].known_at - c.at, 59ms) << "nobody knows before the datagram is there, clocks apart or not";
  }
  EXPECT_THAT(lan.contacts(decider(), ContactKind::kApplied), IsEmpty());
}

// The outcome counts from the time of the contact, not from the arrival of its news: latency causes no error.
TEST_P(Decision, TheOutcomeIsOfTheContactTime) {
  run(2s);
  const ContactEvent c = lan.contacts(decider(), ContactKind::kDecided).at(0).contact;
  const SimTime t = lan.session_now(0);
  const double dt = to_seconds(t - c.at);
  const Vec3 car = advance(c.collider_after, dt).position, cube = advance(c.collidee_after, dt).position;
  EXPECT_LT(c.collider_after.velocity.x(), 0.0);
  EXPECT_EQ(c.collidee_after.velocity.x(), GetParam().mutual ? 1.0 : -1.0);
  EXPECT_LT((lan.peer(0).truth(world["CAR"], t).position - car).norm(), 1e-6);
  EXPECT_LT((lan.peer(1).truth(world["CUBE"], t).position - cube).norm(), 1e-6);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((lan.peer(i).ghost(world["CAR"], t).position - car).norm(), 1e-3) << i;
    EXPECT_LT((lan.peer(i).ghost(world["CUBE"], t).position - cube).norm(), 1e-3) << i;
  }
  lan.run_until(lan.now() + 6s);  // past a time threshold
  const SimTime then = lan.session_now(0) - 200ms;
  for (const char* object : {"CAR", "CUBE"}) {
    for (std::size_t i = 1; i < 3; ++i) {
      EXPECT_TRUE(same_bits(lan.peer(i).ghost(world[object], then), lan.peer(0).ghost(world[object], then))) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, Decision,
                         testing::Values(Roles{"CarDecides", 1, 2, false}, Roles{"CubeDecides", 2, 1, false},
                                         Roles{"CarDecidesBothAnswer", 1, 2, true},
                                         Roles{"CubeDecidesBothAnswer", 2, 1, true}),
                         [](const auto& c) { return std::string(c.param.name); });

// ---- decisions by hand ----

class Decided : public testing::Test {
 protected:
  Decided() {
    self = lan.add(config(5, {{world["CUBE"], false}}));
    lan.run_until(2s);
    lan.inject(self, encode(hello_of(1, lan.host_now(self), {world["CAR"]})));
    lan.inject(self, encode(hello_of(7, lan.host_now(self), {world["LORRY"]})));
  }
  Message decision(std::uint32_t by, const char* other, Duration ago, const Vec3& velocity_after) {
    Message m = message_of(by);
    const KinematicState after = moving({0, 0, 0}, velocity_after);
    m.decisions = {{world["CUBE"],
                    world[other],
                    lan.session_now(self) - ago,
                    Vec3::UnitX(),
                    {},
                    {},
                    after,
                    moving({9, 9, 9}),
                    DecisionRule::kId}};
    return m;
  }
  Vec3 velocity() { return lan.peer(self).truth(world["CUBE"], lan.session_now(self)).velocity; }

  World world{box("CAR", "1 1 1", "9 9 9") + box("CUBE", "1 1 1", "0 0 0", kBounces) + box("LORRY", "1 1 1", "-9 9 9") +
              box("VAN", "1 1 1", "9 -9 9") + interest("CUBE", "\"CAR\" \"LORRY\" \"VAN\"")};
  Lan lan{world};
  std::size_t self = 0;
};

// A deciding peer could go on for ever with decisions on one pair; the memory of a pair is bounded.
TEST_F(Decided, NoMoreThanThereCanBeAreRemembered) {
  constexpr int kEach = 20;
  for (int i = 0; i < 5000; i += kEach) {
    Message m = decision(1, "CAR", 100ms, {1, 0, 0});
    for (int k = 0; k < kEach; ++k) {
      if (k > 0) m.decisions.push_back(m.decisions.front());
      m.decisions.back().collidee_after = m.decisions.back().collider_after = {};
      m.decisions.back().contact += std::chrono::nanoseconds(i + k);
    }
    ASSERT_TRUE(lan.inject(self, encode(m)));
  }
  EXPECT_EQ(lan.contacts(self, ContactKind::kApplied).size(), 4000u);
  EXPECT_EQ(lan.drops(self, "too_many_decisions"), 1000u);
}

// The hello of the object's owner may be still to come.
TEST_F(Decided, AnUpdateOfAnUnownedObjectIsRequestedAgain) {
  std::optional<Received> acknowledged;
  lan.filter = [&](std::size_t, std::size_t, const Message& m) {
    for (const Echo& echo : m.hello ? m.hello->echoes : std::vector<Echo>{}) {
      if (echo.peer == PeerId{1}) acknowledged = echo.received;
    }
    return true;
  };
  Message m = decision(1, "VAN", 100ms, {1, 0, 0});
  m.number = 2;
  lan.inject(self, encode(m));
  lan.run_until(lan.now() + 2s);
  EXPECT_EQ(velocity(), Vec3::Zero());
  EXPECT_EQ(lan.drops(self, "not_decider"), 1u);
  ASSERT_TRUE(acknowledged);
  EXPECT_FALSE(acknowledged->has(m.number));
}

TEST_F(Decided, DecisionsFromAnotherAgeAreDropped) {
  for (const Duration ago : {6100ms, -1100ms, 3'600'000ms})
    lan.inject(self, encode(decision(1, "CAR", ago, {1, 0, 0})));
  EXPECT_EQ(velocity(), Vec3::Zero());
  EXPECT_EQ(lan.drops(self, "decision_time"), 3u);
}

// The decision arrives after the cube should have met a wall. The truth must take that wall into account.
TEST(DecidedLate, WhatFollowsFromADecisionIsFoundInThePast) {
  const World world(corridor() + box("CAR", "1 1 1", "0 9 0") + interest("BALL", "\"CAR\""));
  Lan lan(world);
  lan.add(config(5, {{world["BALL"], false}}));
  lan.run_until(2s);
  lan.inject(0, encode(hello_of(1, lan.host_now(0), {world["CAR"]})));
  lan.run_until(3s);
  Message m = message_of(1);
  const SimTime now = lan.session_now(0);
  m.decisions = {{world["BALL"],
                  world["CAR"],
                  now - 200ms,
                  Vec3::UnitX(),
                  {},
                  {},
                  moving({2.5, 0, 0}, {10, 0, 0}),
                  moving({0, 9, 0}),
                  DecisionRule::kId}};
  lan.inject(0, encode(m));
  lan.run_until(3100ms);
  const SimTime t = lan.session_now(0);
  EXPECT_NEAR(lan.peer(0).ghost(world["BALL"], t).position.x(), 0.5, 0.01);  // the wall was 50 ms after the contact
  EXPECT_NEAR(lan.peer(0).truth(world["BALL"], t).position.x(), 0.5, 0.01);
}

// An object that nobody runs stays where it is, whatever hits it.
TEST(OrphanedObject, StaysWhenItIsHit) {
  const World world(box("CAR", "1 1 1", "0 0 0", std::string("velocityVector 2 0 0") + kBounces) +
                    box("CUBE", "1 1 1", "14 0 0", kBounces) + interest("CUBE", "\"CAR\""));
  Lan lan(world, {20ms, 0ms, 0, 0});
  lan.add(config(1, {{world["CAR"], false}}));
  lan.add(config(2, {{world["CUBE"], false}}));
  lan.add(config(3));
  lan.run_until(4s);
  lan.leave(1);
  lan.run_until(15s);
  for (const std::size_t i : {0u, 2u}) {
    EXPECT_EQ(lan.peer(i).owner(world["CUBE"]), PeerId{0});
    EXPECT_EQ(lan.peer(i).ghost(world["CUBE"], lan.session_now(i)).position, Vec3(14, 0, 0)) << i;
  }
}

// An object that is squeezed between two that do not give way must not flood the network with decisions.
TEST(Squeezed, ASqueezedObjectDoesNotFloodTheNetwork) {
  const World world(box("CUBE", "1 1 1", "0 0 0", kBounces) + box("WALL", "1 9 9", "-1.5 0 0") +
                    box("PRESS", "1 1 1", "6 0 0", "velocityVector -1 0 0") + interest("CUBE", "\"WALL\" \"PRESS\""));
  Lan lan(world, {20ms, 0ms, 0, 0});
  std::size_t decisions = 0;
  lan.filter = [&](std::size_t from, std::size_t to, const Message& m) {
    if (from == 0 && to == 1) decisions += m.decisions.size();
    return true;
  };
  lan.add(config(1, {{world["CUBE"], false}}));
  lan.add(config(2, {{world["PRESS"], false}}));
  lan.run_until(12s);
  EXPECT_LE(decisions, 3u * 100u);
}

}  // namespace peerd::replication::peer_collision_test
