#include "replication/objects/replica/display.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::display_test {

using namespace test;

// This peer owns MINE; another one owns BALL, which an interest pairs with WALL.
class Shown : public testing::Test {
 protected:
  Shown() {
    replica.begin(sim(0s));
    replica.truth().declare(mine, Role::kDriven);
    replica.declare_remote(ball, Role::kPredicted);
    replica.truth().set_base(mine, sim(0s), moving({0, 20, 0}, {1, 0, 0}));
    replica.ghosts().set_base(ball, sim(0s), moving({-5, 0, 0}, {0, 1, 0}));
  }
  Vec3 shown(ObjectId object, Duration t) {
    replica.truth().advance(sim(t));
    replica.ghosts().advance(sim(t));
    return display.shown(object, sim(t)).position;
  }

  World world{box("MINE", "1 1 1", "0 20 0") + box("BALL", "1 1 1", "-5 0 0") + box("WALL", "0.2 90 90", "0 0 0") +
              interest("BALL", "\"WALL\"") + interest("MINE", "\"WALL\"")};
  ObjectId mine = world["MINE"], ball = world["BALL"];
  PeerConfig conf = config(1, {{mine, true}});
  PeerCounters counters;
  OwnObjects own{*world.in_force, conf.owned, false};
  Replica replica{*world.in_force};
  Display display{conf, *world.in_force, own, replica, counters};
};

TEST_F(Shown, EverythingWhereItIs) {
  EXPECT_EQ(shown(mine, 2s), Vec3(2, 20, 0));
  EXPECT_EQ(shown(ball, 2s), Vec3(-5, 2, 0));
  EXPECT_EQ(shown(world["WALL"], 2s), Vec3(0, 0, 0));
}

struct DelayCase {
  const char* name;
  DisplayDelay delay;
  std::uint32_t snapshots_hz;
  Duration own, remote;  // how late they are shown
};
class Late : public Shown, public testing::WithParamInterface<DelayCase> {};
// The oldest update so far was 70 ms old.
TEST_P(Late, ByTheDelayThatIsAskedFor) {
  conf.display_delay = GetParam().delay;
  conf.policy.snapshots_hz = GetParam().snapshots_hz;
  for (const Duration age : {20ms, 70ms, 50ms}) display.on_update_age(age);
  EXPECT_NEAR(shown(mine, 2s).x(), 2.0 - to_seconds(GetParam().own), 1e-9);
  EXPECT_NEAR(shown(ball, 2s).y(), 2.0 - to_seconds(GetParam().remote), 1e-9);
}
INSTANTIATE_TEST_SUITE_P(Table, Late,
                         testing::Values(DelayCase{"None", {}, 20, 0ms, 0ms},
                                         DelayCase{"Fixed", {100ms, false, false}, 20, 0ms, 100ms},
                                         DelayCase{"FixedForOwnOnesToo", {100ms, false, true}, 20, 100ms, 100ms},
                                         DelayCase{"Measured", {0ms, true, false}, 0, 0ms, 70ms},
                                         DelayCase{"MeasuredWithSnapshots", {0ms, true, false}, 20, 0ms, 120ms},
                                         DelayCase{"All", {100ms, true, true}, 20, 220ms, 220ms}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST_F(Shown, ARestartForgetsTheMeasuredDelay) {
  conf.display_delay = {0ms, true, false};
  display.on_update_age(500ms);
  EXPECT_NEAR(shown(ball, 2s).y(), 1.5, 1e-9);
  display.restart();
  EXPECT_NEAR(shown(ball, 2s).y(), 2.0, 1e-9);
}

// Own objects are shown as their ghosts were, which all others show, too.
class ShownWithBound : public Shown {
 protected:
  ShownWithBound() {
    replica.ghosts().declare(mine, Role::kPredicted);
    replica.ghosts().set_base(mine, sim(0s), moving({0, 20, 3}, {1, 0, 0}));
    conf.convergence = {ConvergenceMethod::kLinear, 200ms};
    conf.display_delay = {30ms, false, false};
    conf.bounded_latency = {100ms, false};
  }
};

TEST_F(ShownWithBound, AllIsShownAsItWasPublishedUntilThen) {
  EXPECT_TRUE(shown(mine, 2s).isApprox(Vec3(1.9, 20, 3), 1e-12));
  EXPECT_TRUE(shown(ball, 2s).isApprox(Vec3(-5, 1.9, 0), 1e-12));
  // An update takes effect at its stamp + the bound, at once.
  replica.ghosts().set_base(ball, sim(2s), moving({-5, 2, 4}, {0, 1, 0}));
  EXPECT_EQ(shown(ball, 2100ms - 1ns).z(), 0.0);
  EXPECT_EQ(shown(ball, 2100ms).z(), 4.0);
}

TEST_F(ShownWithBound, WhatComesAtTheBoundOrLaterIsCounted) {
  display.on_update(sim(1900ms), sim(1999999us));
  EXPECT_EQ(counters.updates_late, 0u);
  EXPECT_FALSE(display.poll_late(sim(2s)));
  display.on_update(sim(1900ms), sim(2s));
  EXPECT_EQ(counters.updates_late, 1u);
  EXPECT_EQ(counters.latest_by, 0ms);
  display.on_update(sim(1s), sim(2s));
  display.on_decision(sim(1800ms), sim(2s));
  display.on_missing(2);
  EXPECT_EQ(counters.updates_late, 2u);
  EXPECT_EQ(counters.decisions_late, 1u);
  EXPECT_EQ(counters.updates_missing, 2u);
  EXPECT_EQ(counters.latest_by, 900ms);
}

TEST_F(ShownWithBound, ItIsSaidOnceInAWhile) {
  display.on_update(sim(1s), sim(2s));
  const auto late = display.poll_late(sim(2s));
  ASSERT_TRUE(late);
  EXPECT_EQ(late->updates, 1u);
  EXPECT_EQ(late->latest_by, 900ms);
  EXPECT_FALSE(display.poll_late(sim(20s))) << "nothing new";
  display.on_missing(1);
  display.on_decision(sim(1s), sim(3s));
  EXPECT_FALSE(display.poll_late(sim(2s) + kLateSaidEvery - 1ns));
  const auto again = display.poll_late(sim(2s) + kLateSaidEvery);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->updates, 0u);
  EXPECT_EQ(again->missing, 1u);
  EXPECT_EQ(again->decisions, 1u);
  EXPECT_EQ(again->latest_by, 1900ms);
}

TEST_F(ShownWithBound, TheDelayIsSaidWhenItChanges) {
  const auto first = display.poll_delay(sim(1s));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->delay, 100ms);
  EXPECT_FALSE(display.poll_delay(sim(2s)));
  conf.bounded_latency.measured = true;
  display.on_latency(sim(2s), 150ms, sim(2s));
  const auto other = display.poll_delay(sim(2s));
  ASSERT_TRUE(other);
  EXPECT_EQ(other->delay, 150ms + conf.bounded_latency.margin());
}

TEST_F(Shown, WithoutABoundNothingIsLate) {
  display.on_update(sim(0s), sim(3s));
  display.on_decision(sim(0s), sim(3s));
  display.on_missing(3);
  EXPECT_EQ(counters.updates_late + counters.decisions_late + counters.updates_missing, 0u);
  EXPECT_FALSE(display.poll_delay(sim(3s)) || display.poll_late(sim(3s)));
}

// The file marks BALL, which jumps 2 m along z at 1 s.
TEST(ShownAsTheFileSays, ARemoteNodeConvergesWhereTheOthersJump) {
  const World world{box("BALL", "1 1 1", "-5 0 0", "remote TRUE") + box("BOX", "1 1 1", "5 0 0")};
  PeerConfig conf = config(1);
  ASSERT_EQ(conf.convergence.method, ConvergenceMethod::kJump);
  PeerCounters counters;
  OwnObjects own{*world.in_force, conf.owned, false};
  Replica replica{*world.in_force};
  replica.begin(sim(0s));
  Display display{conf, *world.in_force, own, replica, counters};
  const auto z_at = [&](ObjectId object, Duration t) {
    replica.ghosts().advance(sim(t));
    return display.shown(object, sim(t)).position.z();
  };
  for (const char* name : {"BALL", "BOX"}) {
    replica.declare_remote(world[name], Role::kPredicted);
    EXPECT_EQ(z_at(world[name], 1s), 0.0);
    replica.ghosts().set_base(world[name], sim(1s), moving({name[1] == 'A' ? -5.0 : 5.0, 0, 2}));
  }
  EXPECT_EQ(z_at(world["BOX"], 1100ms), 2.0);
  EXPECT_NEAR(z_at(world["BALL"], 1100ms), 1.0, 0.6);
  EXPECT_LT(z_at(world["BALL"], 1199ms), 2.0);
  EXPECT_EQ(z_at(world["BALL"], 1200ms), 2.0);
}

class Smoothed : public Shown {
 protected:
  Smoothed() { conf.convergence = {ConvergenceMethod::kLinear, 200ms}; }
};

// At 1 s the ball turns out to be 2 m farther along z.
TEST_F(Smoothed, AnUpdateIsApproachedInTime) {
  EXPECT_EQ(shown(ball, 1s), Vec3(-5, 1, 0));
  replica.ghosts().set_base(ball, sim(1s), moving({-5, 1, 2}, {0, 1, 0}));
  EXPECT_NEAR(shown(ball, 1100ms).z(), 1.0, 1e-9);
  EXPECT_EQ(shown(ball, 1200ms).z(), 2.0);
}

TEST_F(Smoothed, WhatIsForgottenIsShownAtOnceWhereItIs) {
  EXPECT_EQ(shown(ball, 1s), Vec3(-5, 1, 0));
  replica.ghosts().set_base(ball, sim(1s), moving({-5, 1, 2}, {0, 1, 0}));
  display.forget(ball);
  EXPECT_EQ(shown(ball, 1100ms).z(), 2.0);
}

// The ghost has jumped to the wall's other side.
TEST_F(Smoothed, NothingIsShownOnItsWayThroughAWall) {
  EXPECT_EQ(shown(ball, 1s), Vec3(-5, 1, 0));
  replica.ghosts().set_base(ball, sim(1s), moving({5, 1, 0}));
  bool crossed = false;
  for (Duration t = 1010ms; t < 1600ms; t += 10ms) {
    const double x = shown(ball, t).x();
    ASSERT_GT(std::abs(x), 0.59) << "half of the ball's edge and half of the wall's";
    crossed |= x > 0;
  }
  EXPECT_TRUE(crossed);
  EXPECT_EQ(counters.convergence_blocked, 1u);
}

TEST_F(Smoothed, AWallThatIsNotReceivedIsInNobodysWay) {
  replica.set_received(world["WALL"], false);
  EXPECT_EQ(shown(ball, 1s), Vec3(-5, 1, 0));
  replica.ghosts().set_base(ball, sim(1s), moving({5, 1, 0}));
  EXPECT_NEAR(shown(ball, 1100ms).x(), 0.0, 1e-9);
  EXPECT_EQ(counters.convergence_blocked, 0u);
}

}  // namespace peerd::replication::display_test
