#include "replication/objects/replica/scene_objects.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::scene_objects_test {

using namespace test;

// FREE and BALL are registered as colliders, BALL only against FREE; WALL is no collider, PLAIN does not respond.
class SceneThings : public testing::Test {
 protected:
  SceneThings() {
    scene.restart(sim(5s));
    truth.set_base(ball, sim(7s), moving({1, 0, 0}, {2, 0, 0}));
    truth.set_base(free, sim(8s), moving({9, 9, 9}));
    truth.advance(sim(12s));
  }
  static UpdateRecord state(ObjectId object, Duration decision, std::uint32_t sequence) {
    return {object, sequence, sim(10s), moving({0, 0, 0}), SimTime{decision}, {}};
  }

  World world{box("FREE", "1 1 1", "0 0 0", kBounces) + box("BALL", "1 1 1", "50 0 0", kBounces) +
              box("WALL", "1 1 1", "-90 0 0", kBounces) + box("PLAIN", "1 1 1", "-50 0 0") +
              interest("FREE", "\"WALL\" \"BALL\"") + interest("BALL", "\"FREE\"") + interest("PLAIN", "\"WALL\"")};
  ObjectId free = world["FREE"], ball = world["BALL"], wall = world["WALL"];
  Owners owners;
  MotionWorld truth{*world.model, sim(0s)};
  SceneObjects scene{*world.in_force};
};

TEST_F(SceneThings, AreCollidersWithAResponse) {
  for (const char* name : {"FREE", "BALL"}) EXPECT_TRUE(scene.contains(world[name])) << name;
  for (const char* name : {"WALL", "PLAIN"}) EXPECT_FALSE(scene.contains(world[name])) << name;
  scene.note_moved(ball);
  scene.remove(ball);
  EXPECT_FALSE(scene.contains(ball) || scene.is_moved(ball));
  EXPECT_EQ(scene.decided(ball), SimTime{});
}

// An operation has given BALL to a peer; any edit of the scene comes later.
TEST_F(SceneThings, AreNoneThatAPeerOwns) {
  scene.remove(ball);
  owners.set(ball, PeerId{1});
  EXPECT_TRUE(scene.follow_model(sim(13s), owners).empty());
  EXPECT_FALSE(scene.contains(ball));
  owners.set(ball, kNobody);
  EXPECT_EQ(scene.follow_model(sim(14s), owners), std::vector{ball});
  EXPECT_TRUE(scene.contains(ball));
}

TEST_F(SceneThings, AnswerThePairsInWhichTheyAreRegistered) {
  EXPECT_TRUE(scene.answers({free, wall, CollisionType::kWitness, false}, free));
  EXPECT_FALSE(scene.answers({free, wall, CollisionType::kWitness, true}, wall)) << "it is none";
  EXPECT_TRUE(scene.answers({free, ball, CollisionType::kWitness, true}, ball));
  EXPECT_FALSE(scene.answers({free, ball, CollisionType::kWitness, false}, ball));
}

TEST_F(SceneThings, AreStatedWhereContactsHaveMovedThemAndNobodyOwnsThem) {
  EXPECT_TRUE(scene.states(owners, truth, sim(12s)).empty());
  EXPECT_EQ(scene.digest(owners, truth, sim(11s)), 0u);
  scene.note_moved(ball);
  scene.at(ball).decided = sim(6s);
  scene.at(ball).sequence = 4;
  const auto states = scene.states(owners, truth, sim(12s));
  ASSERT_EQ(states.size(), 1u);
  EXPECT_EQ(states[0].object, ball);
  EXPECT_EQ(states[0].at, sim(7s)) << "since when it moves so";
  EXPECT_EQ(states[0].decision, sim(6s));
  EXPECT_EQ(states[0].sequence, 4u);
  EXPECT_TRUE(same_bits(states[0].model.state, moving({1, 0, 0}, {2, 0, 0})));
  EXPECT_NE(scene.digest(owners, truth, sim(11s)), 0u);
  owners.set(ball, PeerId{3});
  EXPECT_TRUE(scene.states(owners, truth, sim(12s)).empty());
  EXPECT_EQ(scene.digest(owners, truth, sim(11s)), 0u);
}

TEST_F(SceneThings, HaveADigestThatSaysWhichAndSinceWhen) {
  scene.note_moved(ball);
  const std::uint64_t one = scene.digest(owners, truth, sim(11s));
  EXPECT_EQ(scene.digest(owners, truth, sim(7s)), one) << "nothing has changed since";
  EXPECT_NE(scene.digest(owners, truth, sim(6s)), one);
  scene.note_moved(free);
  EXPECT_NE(scene.digest(owners, truth, sim(11s)), one);
  scene.note_unmoved(free);
  EXPECT_EQ(scene.digest(owners, truth, sim(11s)), one);
  scene.at(ball).freed = sim(9s);
  EXPECT_NE(scene.digest(owners, truth, sim(11s)), one);
}

TEST_F(SceneThings, OfTwoStatesTheLaterDecisionThenTheSequenceThenTheLongerPresenceCounts) {
  scene.at(ball).decided = sim(6s);
  scene.at(ball).sequence = 4;
  EXPECT_TRUE(scene.supersedes(state(ball, 7s, 1), sim(9s)));
  EXPECT_FALSE(scene.supersedes(state(ball, 5s, 9), sim(1s)));
  EXPECT_TRUE(scene.supersedes(state(ball, 6s, 5), sim(9s)));
  EXPECT_FALSE(scene.supersedes(state(ball, 6s, 3), sim(1s)));
  EXPECT_TRUE(scene.supersedes(state(ball, 6s, 4), sim(4s)));
  EXPECT_FALSE(scene.supersedes(state(ball, 6s, 4), sim(5s)));
  scene.at(ball).is_free = false;
  EXPECT_FALSE(scene.supersedes(state(ball, 6s, 4), sim(4s))) << "its owner is here";
}

TEST_F(SceneThings, GoOnWhenSessionTimeSteps) {
  scene.note_moved(ball);
  scene.at(ball).decided = sim(6s);
  scene.shift(100s);
  EXPECT_EQ(scene.decided(ball), sim(106s));
  EXPECT_EQ(scene.decided(free), SimTime{}) << "none is none";
  scene.differing().emplace(ball, sim(7s));
  scene.at(ball).ghost_reset = sim(7s);
  scene.restart_moved(sim(112s));
  EXPECT_EQ(scene.at(ball).since, sim(112s));
  EXPECT_TRUE(scene.differing().empty()) << "those were times of the other session";
  EXPECT_FALSE(scene.at(ball).ghost_reset.has_value());
  EXPECT_EQ(scene.at(ball).freed, sim(112s));
  EXPECT_EQ(scene.at(free).freed, SimTime::min());
}

}  // namespace peerd::replication::scene_objects_test
