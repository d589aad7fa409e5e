#include "replication/objects/replica/replica.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::replica_test {

using namespace test;

// BALL may meet WALL; nothing can meet LONE.
class Copy : public testing::Test {
 protected:
  Copy() { replica.begin(sim(1s)); }

  World world{box("BALL", "1 1 1", "0 0 0") + box("WALL", "1 9 9", "50 0 0") + box("LONE", "1 1 1", "0 20 0") +
              interest("BALL", "\"WALL\"")};
  ObjectId ball = world["BALL"], lone = world["LONE"];
  Replica replica{*world.in_force};
};

TEST_F(Copy, BeginsWithEverythingAtItsPlace) {
  EXPECT_FALSE(Replica(*world.in_force).begun());
  EXPECT_TRUE(replica.begun());
  for (const ObjectId object : {ball, lone}) {
    EXPECT_EQ(replica.ghost(object, sim(2s)).position, world.scene.rigid_pose(object).position);
    EXPECT_EQ(replica.truth(object, sim(2s)).position, world.scene.rigid_pose(object).position);
  }
  EXPECT_TRUE(replica.ghosts().has(ball) && replica.truth().has(ball));
  EXPECT_FALSE(replica.ghosts().has(lone) || replica.truth().has(lone)) << "no interest names it";
}

TEST_F(Copy, ARemoteObjectMovesInBothWorldsAndAnOwnOneInTheGhosts) {
  replica.declare_remote(ball, Role::kPredicted);
  replica.set_ghost(ball, sim(1s), moving({0, 0, 0}, {2, 0, 0}), false);
  EXPECT_EQ(replica.ghost(ball, sim(3s)).position, Vec3(4, 0, 0));
  EXPECT_EQ(replica.truth(ball, sim(3s)).position, Vec3(4, 0, 0));
  replica.set_ghost(ball, sim(1s), moving({0, 0, 0}, {0, 3, 0}), true);
  EXPECT_EQ(replica.ghost(ball, sim(3s)).position, Vec3(0, 6, 0));
  EXPECT_EQ(replica.truth(ball, sim(3s)).position, Vec3(4, 0, 0)) << "an update does not move the truth of an own one";
}

TEST_F(Copy, WhatNothingCanMeetIsInTheGhostsAlone) {
  replica.declare_remote(lone, Role::kPredicted);
  EXPECT_TRUE(replica.ghosts().has(lone));
  EXPECT_FALSE(replica.truth().has(lone));
  replica.set_ghost(lone, sim(1s), moving({0, 20, 0}, {0, 0, 1}), false);
  EXPECT_EQ(replica.truth(lone, sim(2s)).position, Vec3(0, 20, 1)) << "its truth is its ghost";
}

TEST_F(Copy, AnOvertakenUpdateTakesItsPlaceAmongThoseThatAreKept) {
  const auto update = [&](std::uint32_t sequence, Duration at) { return UpdateRecord{ball, sequence, sim(at), {}}; };
  EXPECT_FALSE(replica.keep_overtaken(update(1, 2s))) << "none has overtaken it";
  for (const std::uint32_t sequence : {2u, 5u, 6u}) replica.keep_update(update(sequence, seconds(sequence)));
  EXPECT_TRUE(replica.keep_overtaken(update(4, 4s)));
  EXPECT_FALSE(replica.keep_overtaken(update(4, 4s))) << "a copy";
  EXPECT_FALSE(replica.keep_overtaken(update(3, 4s))) << "a later update of that instant makes it void";
  EXPECT_TRUE(replica.keep_overtaken(update(3, 3s)));
  for (std::uint32_t sequence = 7; sequence <= 10; ++sequence)
    replica.keep_update(update(sequence, 6s + seconds(0.01 * sequence)));
  EXPECT_FALSE(replica.keep_overtaken(update(1, 1s))) << "nine others have overtaken it";
  std::vector<std::uint32_t> kept;
  for (const UpdateRecord& each : replica.kept_updates(ball)) kept.push_back(each.sequence);
  EXPECT_EQ(kept, (std::vector<std::uint32_t>{2, 3, 4, 5, 6, 7, 8, 9, 10}));
}

TEST_F(Copy, BeginningAnewForgetsTheWorldsButNotWhatIsReceived) {
  replica.set_ghost(ball, sim(1s), moving({7, 0, 0}), false);
  replica.set_received(ball, false);
  const Replica::Worlds old = replica.take();
  replica.begin(sim(5s));
  EXPECT_EQ(old.ghosts.at(ball, sim(1s)).position, Vec3(7, 0, 0));
  EXPECT_EQ(replica.ghost(ball, sim(5s)).position, Vec3(0, 0, 0));
  EXPECT_FALSE(replica.receives(ball));
}

TEST_F(Copy, EverythingIsReceivedUntilSaidOtherwise) {
  EXPECT_TRUE(replica.receives(ball));
  EXPECT_FALSE(replica.set_received(ball, true)) << "it was";
  EXPECT_TRUE(replica.set_received(ball, false));
  EXPECT_FALSE(replica.set_received(ball, false));
  EXPECT_FALSE(replica.receives(ball));
  EXPECT_TRUE(replica.receives(lone));
  EXPECT_TRUE(replica.set_received(ball, true));
  EXPECT_TRUE(replica.receives(ball));
}

TEST_F(Copy, RemembersTheLastUpdateOfEach) {
  EXPECT_EQ(replica.last_update_of(ball), nullptr);
  for (const std::uint32_t sequence : {1u, 2u}) {
    replica.note_update({ball, sequence, {}, {}});
  }
  ASSERT_NE(replica.last_update_of(ball), nullptr);
  EXPECT_EQ(replica.last_update_of(ball)->sequence, 2u);
  EXPECT_EQ(replica.last_update_of(lone), nullptr);
  replica.note_update({lone, 1, {}, {}});
  replica.forget_update_of(ball);
  EXPECT_EQ(replica.last_update_of(ball), nullptr);
  EXPECT_NE(replica.last_update_of(lone), nullptr);
  replica.forget_updates();
  EXPECT_EQ(replica.last_update_of(lone), nullptr);
}

}  // namespace peerd::replication::replica_test
