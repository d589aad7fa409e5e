#include "replication/objects/updates/proximity_threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::proximity_threshold_test {

using namespace test;

// Two cubes of a metre, whose spheres meet when their centres are so far apart.
const double kMeet_m = 2.0 * std::sqrt(0.75);

// This peer owns CAR, at the origin of the scene; peer 2 owns CUBE.
class Near : public testing::Test {
 protected:
  explicit Near(const std::string& interests = interest("CAR", "\"CUBE\""))
      : world(box("CAR", "1 1 1", "0 0 0") + box("CUBE", "1 1 1", "0 0 0") + interests) {
    own.policy.error_threshold_m = 0.5;
    own.policy.tight_threshold_m = 0.01;
    own.policy.close_proximity_s = 0.5;
    owners.set(car, PeerId{1});
    owners.set(cube, PeerId{2});
    replica.begin(sim(0s));
    if (!replica.truth().has(car)) return;
    replica.truth().declare(car, Role::kDriven);
    replica.truth().declare(cube, Role::kPredicted);
  }
  // At t = 1 s the spheres are `gap_m` apart, and the car comes with 10 m/s.
  double threshold_with_gap(double gap_m, double off_m = 0.0) {
    replica.truth().set_base(cube, sim(1s), moving({0, off_m, 0}));
    const double along_m = std::sqrt(std::pow(kMeet_m, 2) - off_m * off_m);
    replica.truth().set_base(car, sim(1s), moving({-along_m - gap_m, 0, 0}, {10, 0, 0}));
    return threshold.at(car, sim(1s));
  }

  World world;
  ObjectId car = world["CAR"], cube = world["CUBE"];
  PeerConfig own = config(1);
  PeerCounters counters;
  Owners owners;
  Replica replica{*world.in_force};
  ProximityThreshold threshold{own, *world.in_force, owners, replica, counters};
};
class NoInterest : public Near {
 protected:
  NoInterest() : Near("") {}
};
class RegisteredTheOtherWay : public Near {
 protected:
  RegisteredTheOtherWay() : Near(interest("CUBE", "\"CAR\"")) {}
};
// All may meet all, the two and ten others that nobody owns.
class InAGroup : public Near {
 protected:
  InAGroup() : Near(all_with_all()) {}
  static std::string all_with_all() {
    std::string text;
    for (int i = 0; i < 10; ++i) text += box("P" + std::to_string(i), "1 1 1", "0 100 " + std::to_string(5 * i));
    return text + interest("*", "\"*\"");
  }
};

TEST_F(InAGroup, TightensWithinTheCloseProximity) {
  ASSERT_EQ(world.model->groups.size(), 1U);
  EXPECT_EQ(threshold_with_gap(4.99), 0.01);
}

TEST_F(InAGroup, IsTheUsualOneFartherAway) { EXPECT_EQ(threshold_with_gap(5.01), 0.5); }

TEST_F(Near, TightensAtOnceWithinTheCloseProximity) {
  EXPECT_EQ(threshold_with_gap(5.01), 0.5);
  EXPECT_EQ(threshold_with_gap(4.99), 0.01);
  EXPECT_EQ(threshold_with_gap(0.1), 0.01);
  EXPECT_EQ(threshold_with_gap(-0.5), 0.01) << "they overlap";
}

TEST_F(RegisteredTheOtherWay, ItTightensAsWell) {
  EXPECT_EQ(threshold_with_gap(5.01), 0.5);
  EXPECT_EQ(threshold_with_gap(4.99), 0.01);
}

TEST_F(Near, TightensInProportionToTheTimeLeft) {
  own.policy.threshold_by_time = true;
  EXPECT_EQ(threshold_with_gap(5.01), 0.5);
  EXPECT_NEAR(threshold_with_gap(4.0), 0.01 + 0.49 * 0.8, 1e-9);
  EXPECT_NEAR(threshold_with_gap(1.0), 0.01 + 0.49 * 0.2, 1e-9);
  EXPECT_EQ(threshold_with_gap(-0.5), 0.01);
}

TEST_F(Near, CountsRemoteObjectsThatItReceivesAlone) {
  ASSERT_EQ(threshold_with_gap(1.0), 0.01);
  const auto tests = counters.proximity_tests;
  EXPECT_EQ(tests, 1u);
  owners.set(cube, kNobody);
  EXPECT_EQ(threshold_with_gap(1.0), 0.5) << "the scene's";
  owners.set(cube, PeerId{1});
  EXPECT_EQ(threshold_with_gap(1.0), 0.5) << "its own";
  owners.set(cube, PeerId{2});
  replica.set_received(cube, false);
  EXPECT_EQ(threshold_with_gap(1.0), 0.5) << "nobody here knows where it is";
  EXPECT_EQ(counters.proximity_tests, tests);
}

TEST_F(Near, TheUsualOneStandsWhereNothingIsTracked) {
  own.policy.track_proximity = false;
  EXPECT_EQ(threshold_with_gap(0.1), 0.5);
  own.policy.track_proximity = true;
  own.policy.error_threshold_m = 0.004;
  EXPECT_EQ(threshold_with_gap(0.1), 0.004) << "it is tighter anyway";
  EXPECT_EQ(counters.proximity_tests, 0u);
}

// ARM is this peer's, CUBE peer 2's.
struct Arm {
  explicit Arm(const std::string& collider, int type = 1, const std::string& cube = box("CUBE", "1 1 1", "0 0 0"),
               const std::string& collidee = "CUBE")
      : world(arm() + cube + interest(collider, "\"" + collidee + "\"", type), {"ARM", "ARM/HAND", "CUBE"}) {
    own.policy.error_threshold_m = 0.5;
    own.policy.tight_threshold_m = 0.01;
    own.policy.close_proximity_s = 0.5;
    owners.set(world["ARM"], PeerId{1});
    owners.set(world["CUBE"], PeerId{2});
    replica.begin(sim(0s));
    replica.set_world_zero(sim(0s), sim(0s));
  }
  // CUBE is at x, and comes with that speed.
  double at(double x, double speed_m_s = 0.0) {
    replica.truth().set_base(world["CUBE"], sim(1s), moving({x, 0, 0}, {speed_m_s, 0, 0}));
    return threshold.at(world["ARM"], sim(1s));
  }

  World world;
  PeerConfig own = config(1);
  PeerCounters counters;
  Owners owners;
  Replica replica{*world.in_force};
  ProximityThreshold threshold{own, *world.in_force, owners, replica, counters};
};

TEST(ProximityOfParts, AFarPartIsWhatComesClose) {
  for (const char* const collider : {"ARM", "HAND"}) {
    for (const int type : {0, 1, 2}) {
      Arm arm(collider, type);
      EXPECT_EQ(arm.at(20.0 + kMeet_m - 0.1), 0.01) << collider << ' ' << type;
      EXPECT_EQ(arm.at(20.0 + kMeet_m + 4.9, -10.0), 0.01) << collider << ' ' << type;
      EXPECT_EQ(arm.at(20.0 + kMeet_m + 9.0, -10.0), 0.5) << collider << ' ' << type;
      EXPECT_EQ(arm.at(0.0), 0.5) << "the hand is not there: " << collider << ' ' << type;
    }
  }
}

TEST(ProximityOfParts, WhatAnotherPeerCarriesIsAnothers) {
  const std::string cube =
      "DEF CUBE Transform { children DEF TIP Transform { translation 0 0 30 children Shape { geometry "
      "Box { size 1 1 1 } } } }\n";
  for (const char* const collidee : {"CUBE", "TIP"}) {
    Arm arm("HAND", 1, cube, collidee);
    EXPECT_EQ(arm.at(20.0), 0.5) << collidee;
    arm.replica.truth().set_base(arm.world["CUBE"], sim(1s), moving({20, 0, -29.5}));
    EXPECT_EQ(arm.threshold.at(arm.world["ARM"], sim(1s)), 0.01) << "the tip is at the hand: " << collidee;
  }
}

// GROWS is within 20 m of its peer's object; at 1 s its half width is 1.25 m, and in half a second 1.625 m.
TEST(ProximityOfParts, WhatFlexesIsAsLargeAsItGetsInTime) {
  const std::string cube =
      "DEF CUBE Transform { children DEF GROWS Transform { children Shape { geometry Box { size 1 1 1 } } } }\n";
  Arm arm("HAND", 1, cube + kGrows);
  ASSERT_EQ(arm.world.model->flexible.size(), 1u);
  EXPECT_EQ(arm.at(22.6), 0.01);
  EXPECT_EQ(arm.at(26.0), 0.5);
}

// FAR and CAR are this peer's; what carries them comes later, before both in the order of the model's nodes.
TEST(Proximity, IsOfTheModelInForce) {
  World w("DEF BUS Transform { children DEF DOOR Transform { children [ " + box("FAR", "1 1 1", "50 0 0") +
          box("CAR", "1 1 1", "0 0 0") + "] } }\n" + box("CUBE", "1 1 1", "1.5 0 0") + interest("FAR", "\"CUBE\"") +
          interest("CAR", "\"CUBE\""));
  PeerConfig own = config(1);
  own.policy.error_threshold_m = 0.5;
  own.policy.tight_threshold_m = 0.01;
  PeerCounters counters;
  Owners owners;
  owners.set(w["CUBE"], PeerId{2});
  Replica replica{*w.in_force};
  replica.begin(sim(0s));
  replica.set_world_zero(sim(0s), sim(0s));
  ProximityThreshold threshold{own, *w.in_force, owners, replica, counters};
  const ObjectId far = w["BUS/DOOR/FAR"], car = w["BUS/DOOR/CAR"];
  const auto expect = [&] {
    EXPECT_EQ(threshold.at(far, sim(1s)), 0.5);
    EXPECT_EQ(threshold.at(car, sim(1s)), 0.01);
  };
  expect();
  const std::uint32_t index = w.model->index_of(far);
  auto next = extended(*w.model, std::vector{w["BUS"]});
  ASSERT_EQ(next->index_of(far), index + 1);
  replica.change_model(*next);
  w.in_force->replace(std::move(next));
  expect();
}

TEST_F(NoInterest, TheUsualOneStands) {
  EXPECT_EQ(threshold.at(car, sim(1s)), 0.5);
  EXPECT_EQ(counters.proximity_tests, 0u);
}

TEST_F(Near, RefinedByPolygonsWhatPassesBesideIsNotClose) {
  EXPECT_EQ(threshold_with_gap(1.0, 1.7), 0.01) << "the spheres meet";
  own.policy.refine_proximity = true;
  own.policy.error_threshold_m = 0.2;
  EXPECT_EQ(threshold_with_gap(1.0, 1.7), 0.2) << "the cubes stay 0.7 m apart";
  EXPECT_EQ(threshold_with_gap(1.0, 0.2), 0.01) << "they meet";
  EXPECT_EQ(counters.proximity_refined, 2u);
}

TEST_F(Near, TheLeastIsTheTightestThatMayBeInForce) {
  EXPECT_EQ(threshold.least_m(car), 0.01);
  own.policy.error_threshold_m = 0.004;
  EXPECT_EQ(threshold.least_m(car), 0.004);
  own.policy.wanted_error_m = 0.002;
  EXPECT_EQ(threshold.least_m(car), 0.002);
  own.policy.wanted_error_m = 0.1;
  EXPECT_EQ(threshold.least_m(car), 0.004);
  own.policy.wanted_error_m = 0.0;
  own.policy.error_threshold_m.reset();
  EXPECT_EQ(threshold.least_m(car), std::min(0.01, world.scene.object(car).distance_threshold_m));
}

}  // namespace peerd::replication::proximity_threshold_test
