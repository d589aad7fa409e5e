#include "replication/objects/replica/scripted_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::scripted_motion_test {

using namespace test;

// PLATE goes from x = 10 to x = 4 and back in 12 s, at 1 m/s.
const std::string kMachine = box("PLATE", "1 1 1", "10 0 0") + box("BALL", "1 1 1", "-90 0 0") + shuttles("PLATE") +
                             interest("BALL", "\"PLATE\"");

class Scripted : public testing::Test {
 protected:
  Scripted() {
    replica.begin(sim(0s));
    scripted.restart();
  }
  void extend(Duration to, std::optional<SimTime> zero = sim(1s)) {
    scripted.extend(sim(to), zero, owners, scene, replica);
    replica.truth().advance(sim(to));
    replica.ghosts().advance(sim(to));
  }
  double x(Duration t) const { return replica.ghost(plate, sim(t)).position.x(); }

  World world{kMachine};
  ObjectId plate = world["PLATE"];
  Owners owners;
  SceneObjects scene{*world.in_force};
  Replica replica{*world.in_force};
  ScriptedMotion scripted{*world.in_force};
};

TEST_F(Scripted, NothingMovesBeforeWorldTimeIsKnown) {
  extend(5s, std::nullopt);
  EXPECT_EQ(x(5s), 10.0);
}

TEST_F(Scripted, BothWorldsMoveAsTheFileSays) {
  for (Duration t = 0s; t <= 14s; t += 500ms) {
    extend(t);
    const double world_s = std::max(0.0, to_seconds(t) - 1.0);
    const double expected = 4.0 + std::abs(std::fmod(world_s, 12.0) - 6.0);
    ASSERT_NEAR(x(t), expected, 1e-6) << to_seconds(t);
    ASSERT_NEAR(replica.truth(plate, sim(t)).position.x(), expected, 1e-6);
  }
}

TEST_F(Scripted, WhoJoinsLaterSeesTheSameBits) {
  Replica late(*world.in_force);
  late.begin(sim(4s));
  ScriptedMotion joined(*world.in_force);
  joined.restart();
  for (Duration t = 0s; t <= 6s; t += 100ms) {
    extend(t);
    if (t >= 4s) joined.extend(sim(t), sim(1s), owners, scene, late);
  }
  for (Duration t = 4s; t <= 6s; t += 37ms) {
    ASSERT_TRUE(same_bits(late.ghost(plate, sim(t)), replica.ghost(plate, sim(t)))) << to_seconds(t);
  }
}

TEST_F(Scripted, WhatSomebodyOwnsIsNotMovedNorInItsPastAfterwards) {
  extend(2s);
  owners.set(plate, PeerId{2});
  replica.set_ghost(plate, sim(2s), moving({50, 0, 0}), false);
  extend(3s);
  EXPECT_EQ(x(3s), 50.0);
  owners.set(plate, kNobody);
  extend(4s);
  EXPECT_EQ(x(2500ms), 50.0) << "it was there";
  EXPECT_NEAR(x(4s), 7.0, 1e-6);
}

TEST_F(Scripted, ARestartGivesTheMotionToANewWorld) {
  extend(3s);
  replica.begin(sim(103s));
  scripted.restart();
  extend(103s, sim(101s));
  EXPECT_NEAR(x(103s), 8.0, 1e-6);
  EXPECT_FALSE(scripted.limited_at());
}

TEST_F(Scripted, VelocitiesOfTheFileAreInTheParentsFrame) {
  EXPECT_EQ(scripted.to_world(sim(3s), std::nullopt, plate, {1, 2, 3}), world.scene.to_world(plate, {1, 2, 3}));
  const World turning(
      "DEF TURN Transform { children [ " + box("IN", "1 1 1", "0 0 0") + " ] }\n" + box("BALL", "1 1 1", "-90 0 0") +
      "DEF T TimeSensor { cycleInterval 4 loop TRUE }\n"
      "DEF O OrientationInterpolator { key [ 0 0.25 1 ] keyValue [ 0 0 1 0, 0 0 1 1.5707963, 0 0 1 0 ] }\n"
      "ROUTE T.fraction_changed TO O.set_fraction ROUTE O.value_changed TO TURN.rotation\n" +
      interest("BALL", "\"TURN/IN\""));
  ScriptedMotion turned(*turning.in_force);
  const Vec3 v = turned.to_world(sim(3s), sim(2s), turning["TURN/IN"], {1, 0, 0});  // a quarter of a turn
  EXPECT_NEAR((v - Vec3(0, 1, 0)).norm(), 0.0, 1e-6);
}

TEST(ScriptedMotion, AWorldThatStandsStillHasNone) {
  const World world(box("A", "1 1 1", "0 0 0"));
  ScriptedMotion scripted(*world.in_force);
  Replica replica(*world.in_force);
  replica.begin(sim(0s));
  scripted.restart();
  scripted.extend(sim(1s), sim(0s), Owners(), SceneObjects(*world.in_force), replica);
  EXPECT_EQ(scripted.to_world(sim(1s), sim(0s), world["A"], {1, 0, 0}), Vec3(1, 0, 0));
  EXPECT_FALSE(scripted.limited_at());
}

}  // namespace peerd::replication::scripted_motion_test
