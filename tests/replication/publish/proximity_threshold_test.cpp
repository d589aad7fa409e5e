#include "replication/publish/proximity_threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/replication/lan.hpp"

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
  Owners owners{world.scene.instances.size()};
  Replica replica{*world.in_force};
  ProximityThreshold threshold{own, *world.in_force, owners, replica, counters};
};
class NoInterest : public Near {
 protected:
  NoInterest() : Near("") {}
};

TEST_F(Near, TightensAtOnceWithinTheCloseProximity) {
  EXPECT_EQ(threshold_with_gap(5.01), 0.5);
  EXPECT_EQ(threshold_with_gap(4.99), 0.01);
  EXPECT_EQ(threshold_with_gap(0.1), 0.01);
  EXPECT_EQ(threshold_with_gap(-0.5), 0.01) << "they overlap";
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
