#include "replication/objects/replica/launches.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::launches_test {

using namespace test;

class Launched : public testing::Test {
 protected:
  Launched() {
    replica.begin(sim(0s));
    for (const auto& [object, each] : own) replica.truth().declare(object, Role::kAuthoritative);
  }
  Vec3 at(ObjectId object, Duration t) { return replica.truth(object, sim(t)).position; }

  World world{box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "0 10 0") +
              box("C", "1 1 1", "0 20 0", "collisionResponse CollisionResponse { responseType 2 friction 0.5 } ")};
  ObjectId a = world["A"], b = world["B"], c = world["C"];
  std::vector<OwnedObject> objects{{a, false, {0s, Vec3(1, 0, 0), Vec3(0, 0, 2)}}, {b, false}, {c, false}};
  OwnObjects own{*world.in_force, objects, false};
  Replica replica{*world.in_force};
  Launches launches{*world.in_force, own, replica};
  Launches::FileVelocity by_file = [this](SimTime t, ObjectId object) {
    return Vec3(0, 0, object == b ? to_seconds(t.time_since_epoch()) : 99);
  };
};

TEST_F(Launched, ALaunchGivesItsVelocityAndAcceleration) {
  launches.launch(sim(2s), a, by_file);
  EXPECT_EQ(at(a, 2s), Vec3(0, 0, 0));
  EXPECT_EQ(at(a, 4s), Vec3(2, 0, 4)) << "1 m/s along x, 2 m/s^2 along z";
  EXPECT_TRUE(launches.unpublished().empty()) << "everybody sees the session's begin";
}

TEST_F(Launched, ALaunchTurnsInTheWorldsFrame) {
  objects[0].launch.angular_velocity = Vec3(0, 3, 0);
  OwnObjects turning{*world.in_force, objects, false};
  KinematicState lying;
  lying.orientation = Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()));
  replica.truth().set_base(a, sim(1s), lying);
  Launches(*world.in_force, turning, replica).launch(sim(2s), a, by_file);
  const KinematicState state = replica.truth().at(a, sim(2s));
  EXPECT_NEAR((state.orientation * state.angular_velocity_body - Vec3(0, 3, 0)).norm(), 0.0, 1e-14);
  EXPECT_NEAR((state.angular_velocity_body - Vec3(0, 0, -3)).norm(), 0.0, 1e-14);
}

TEST_F(Launched, WithoutAVelocityTheFilesCounts) {
  launches.launch(sim(2s), b, by_file);
  EXPECT_EQ(at(b, 3s), Vec3(0, 10, 2)) << "of the time of the launch";
}

TEST_F(Launched, DueLaunchesBeginAtTheirTimesAndAreUnpublished) {
  launches.schedule(a, sim(2s));
  launches.schedule(b, sim(1s));
  launches.begin_due(sim(2s) - 1ns, by_file);
  EXPECT_EQ(launches.unpublished(), (std::map<ObjectId, SimTime>{{b, sim(1s)}}));
  launches.begin_due(sim(2s), by_file);
  EXPECT_EQ(launches.unpublished(), (std::map<ObjectId, SimTime>{{a, sim(2s)}, {b, sim(1s)}}));
  EXPECT_EQ(at(b, 3s), Vec3(0, 10, 2));
  EXPECT_EQ(at(a, 3s), Vec3(1, 0, 1));
  launches.note_published(a);
  launches.begin_due(sim(9s), by_file);
  EXPECT_EQ(launches.unpublished(), (std::map<ObjectId, SimTime>{{b, sim(1s)}})) << "each once";
  launches.forget_unpublished();
  EXPECT_TRUE(launches.unpublished().empty());
}

TEST_F(Launched, AStepOfSessionTimeMovesWhatIsScheduled) {
  launches.schedule(a, sim(2s));
  launches.shift(10s);
  launches.begin_due(sim(12s) - 1ns, by_file);
  EXPECT_TRUE(launches.unpublished().empty());
  launches.begin_due(sim(12s), by_file);
  EXPECT_EQ(launches.unpublished().at(a), sim(12s));
}

TEST_F(Launched, WhatAnotherPeerOwnsIsNotLaunched) {
  launches.schedule(a, sim(2s));
  launches.change_velocity(sim(1s), b, {1, 0, 0}, true);
  launches.forget(a);
  launches.forget(b);
  launches.begin_due(sim(3s), by_file);
  EXPECT_TRUE(launches.unpublished().empty());
  EXPECT_EQ(at(a, 3s), Vec3(0, 0, 0));
}

TEST_F(Launched, AHandSetsAVelocityOrAddsToIt) {
  launches.launch(sim(0s), a, by_file);
  launches.change_velocity(sim(1s), a, {0, 5, 0}, false);
  EXPECT_EQ(replica.truth(a, sim(1s)).velocity, Vec3(1, 5, 2));
  EXPECT_EQ(at(a, 2s), Vec3(2, 5, 4)) << "it goes on accelerating";
  launches.change_velocity(sim(2s), a, {0, 5, 0}, true);
  EXPECT_EQ(replica.truth(a, sim(2s)).velocity, Vec3(0, 5, 0));
  EXPECT_EQ(launches.unpublished().at(a), sim(2s));
}

TEST_F(Launched, AHandTakesTheLaunchsPlace) {
  launches.schedule(b, sim(2s));
  launches.change_velocity(sim(1s), b, {3, 0, 0}, true);
  launches.begin_due(sim(5s), by_file);
  EXPECT_EQ(at(b, 4s), Vec3(9, 10, 0));
  EXPECT_EQ(launches.unpublished().at(b), sim(1s));
}

TEST_F(Launched, WhatHasFrictionSlidesToRest) {
  launches.change_velocity(sim(0s), c, {1, 0, 0}, true);
  EXPECT_EQ(replica.truth().model_at(c, sim(0s)).kind, MotionKind::kSliding);
  EXPECT_TRUE(replica.truth().is_at_rest_from(c, sim(60s)));
}

}  // namespace peerd::replication::launches_test
