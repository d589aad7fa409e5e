#include "replication/physics/world/colliding_objects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::colliding_objects_test {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

using Seen = std::tuple<ObjectId, Duration, bool>;

struct Watched {
  explicit Watched(const std::string& text) : world(text), motion(*world.model, sim(0s)), colliding(*world.in_force) {
    motion.declare(world["BALL"], Role::kAuthoritative);
  }
  // Advances in ticks of 100 ms until `to`.
  std::vector<Seen> until(Duration to) {
    std::vector<Seen> seen;
    for (; now <= to; now += 100ms) {
      motion.advance(sim(now));
      while (const auto event = motion.poll_event()) {
        if (const auto* contact = std::get_if<ContactEvent>(&*event)) colliding.on_contact(*contact);
      }
      motion.take_changed([&](ObjectId id) { colliding.wake(id); });
      const auto touch = [&](ObjectId a, ObjectId b) {
        ++asked;
        return motion.ends_touch(a, b, sim(now));
      };
      colliding.update(
          touch, [&](ObjectId id) { return motion.is_at_rest_from(id, sim(now)); }, sim(now));
      while (const auto change = colliding.poll())
        seen.emplace_back(change->object, change->at - sim(0s), change->value);
    }
    return seen;
  }

  World world;
  MotionWorld motion;
  CollidingObjects colliding;
  Duration now{0};
  std::size_t asked = 0;  // whether two touch
};

TEST(CollidingObjects, ABounceCollidesUntilTheNextTick) {
  Watched w(corridor());
  w.motion.set_base(w.world["BALL"], sim(0s), moving({0, 0, 0}, {2, 0, 0}));
  const ObjectId ball = w.world["BALL"], right = w.world["RIGHT"];
  EXPECT_THAT(w.until(1400ms), IsEmpty());
  EXPECT_THAT(w.until(1500ms), ElementsAre(Seen{ball, 1500ms, false}, Seen{right, 1500ms, false}));
  EXPECT_THAT(w.until(1700ms), ElementsAre(Seen{ball, 1600ms, true}, Seen{right, 1600ms, true}));
}

TEST(CollidingObjects, WhatStopsCollidesUntilItIsTakenAway) {
  Watched w(corridor(kStops));
  w.motion.set_base(w.world["BALL"], sim(0s), moving({0, 0, 0}, {2, 0, 0}));
  const ObjectId ball = w.world["BALL"], right = w.world["RIGHT"];
  EXPECT_THAT(w.until(5s), ElementsAre(Seen{ball, 1500ms, false}, Seen{right, 1500ms, false}));
  EXPECT_EQ(w.asked, 1u) << "once, when they stopped: what lies is not checked";
  w.motion.set_base(w.world["BALL"], sim(5s), moving({1, 0, 0}));
  EXPECT_THAT(w.until(6s), ElementsAre(Seen{ball, 5100ms, true}, Seen{right, 5100ms, true}));
}

// Two stops are as far apart as the object is wide. Between them it touches both, and it is free when it touches
// neither.
TEST(CollidingObjects, IsReportedOnceForSeveralPartners) {
  Watched w(box("BALL", "0.5 0.5 0.5", "0 0 0", kStops) + box("RIGHT", "1 50 50", "3.75 0 0") +
            box("UPPER", "50 1 50", "0 0.75 0") + interest("BALL", "\"RIGHT\" \"UPPER\""));
  const ObjectId ball = w.world["BALL"];
  w.motion.set_base(w.world["BALL"], sim(0s), moving({2, -0.01, 0}, {2, 0.02, 0}));  // both after half a second
  const auto of_ball = [&](const std::vector<Seen>& seen) {
    std::vector<Seen> out;
    for (const Seen& s : seen) {
      if (std::get<0>(s) == ball) out.push_back(s);
    }
    return out;
  };
  EXPECT_THAT(of_ball(w.until(2s)), ElementsAre(Seen{ball, 500ms, false}));
  w.motion.set_base(w.world["BALL"], sim(2s), moving({3, -1, 0}));
  EXPECT_THAT(of_ball(w.until(3s)), IsEmpty());
  w.motion.set_base(w.world["BALL"], sim(3s), moving({0, -1, 0}));
  EXPECT_THAT(of_ball(w.until(4s)), ElementsAre(Seen{ball, 3100ms, true}));
}

// Session time steps while two pairs touch, which have the ball in common.
TEST(CollidingObjects, AllAreApartWhereTheWorldsBeginAnew) {
  Watched w(corridor());
  w.motion.set_base(w.world["BALL"], sim(0s), moving({0, 0, 0}, {2, 0, 0}));
  const ObjectId ball = w.world["BALL"], left = w.world["LEFT"], right = w.world["RIGHT"];
  ASSERT_THAT(w.until(1500ms), ElementsAre(Seen{ball, 1500ms, false}, Seen{right, 1500ms, false}));
  w.colliding.on_contact({sim(1500ms), ball, left});
  w.colliding.forget(sim(1600ms));
  std::vector<Seen> seen;
  while (const auto change = w.colliding.poll()) seen.emplace_back(change->object, change->at - sim(0s), change->value);
  EXPECT_THAT(seen, testing::UnorderedElementsAre(Seen{left, 1500ms, false}, Seen{ball, 1600ms, true},
                                                  Seen{left, 1600ms, true}, Seen{right, 1600ms, true}));
}

TEST(CollidingObjects, AllPeersReportTheSameForABounce) {
  const World world(corridor());
  Lan lan(world, {5ms, 0ms, 0, 0});
  for (const std::uint32_t id : {1u, 2u}) {
    PeerConfig config{.id = PeerId{id}, .name = id == 1 ? "one" : "two"};
    if (id == 1) config.owned.push_back({world["BALL"], false});
    lan.add(config);
  }
  lan.run_until(3s);
  const SimTime start = lan.peer(0).clock().to_session(lan.host_now(0));
  lan.peer(0).change_velocity(lan.host_now(0), world["BALL"], {2, 0, 0}, true);
  lan.run_until(6s);
  std::vector<SimTime> began[2];
  for (const std::size_t peer : {0u, 1u}) {
    for (const NotColliding& n : lan.seen<NotColliding>(peer)) {
      if (n.object == world["BALL"] && !n.value) began[peer].push_back(n.at);
    }
  }
  ASSERT_EQ(began[0].size(), 1u);
  ASSERT_EQ(began[1].size(), 1u);
  EXPECT_NEAR(to_seconds(began[0][0] - began[1][0]), 0.0, 1e-6) << "one from the truth, one from the last update";
  EXPECT_NEAR(to_seconds(began[0][0] - start), 1.5, 0.02);
}

// The ghost continues into the obstacle at which the car has stopped. The car's owner knows better.
TEST(CollidingObjects, AnOwnObjectIsReportedByItsTruthNotItsGhost) {
  const World world(box("CAR", "1 1 1", "-5 0 0") + box("CUBE", "1 1 1", "0 0 0") + interest("CAR", "\"CUBE\""));
  Lan lan(world, {5ms, 0ms, 0, 0});
  const auto stops_before_it = [](SimTime t) {
    const double x = -5.0 + to_seconds(t.time_since_epoch() - kEpoch - 3s);
    return x < -1.1 ? moving({x, 0, 0}, {1, 0, 0}) : moving({-1.1, 0, 0});
  };
  for (const std::uint32_t id : {1u, 2u}) {
    PeerConfig config{.id = PeerId{id}, .name = id == 1 ? "one" : "two"};
    config.policy.track_proximity = false;
    config.owned.push_back({world[id == 1 ? "CAR" : "CUBE"], id == 1});
    lan.add(
        config, 0s,
        id == 1 ? std::map<ObjectId, Lan::Motion>{{world["CAR"], stops_before_it}} : std::map<ObjectId, Lan::Motion>{});
  }
  lan.run_until(9s);
  std::size_t predicted = 0;
  for (const ContactSeen& c : lan.seen<ContactSeen>(0)) predicted += c.kind == ContactKind::kPredicted;
  ASSERT_GE(predicted, 1u) << "its ghost does run into it";
  EXPECT_THAT(lan.seen<NotColliding>(0), IsEmpty());
}

}  // namespace peerd::replication::colliding_objects_test
