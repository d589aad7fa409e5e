#include "replication/objects/contacts/contact_watch.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::contact_watch_test {

using namespace test;

// This peer is 2 and owns A; B is peer 3's and C peer 9's. All three may meet, two at a time.
class Watching : public testing::Test {
 protected:
  Watching() {
    owners.set(a, conf.id);
    owners.set(b, PeerId{3});
    owners.set(c, PeerId{9});
    for (const ObjectId object : {a, b, c}) scene.remove(object);
    replica.begin(sim(0s));
    replica.truth().declare(a, Role::kAuthoritative);
    replica.ghosts().declare(a, Role::kPredicted);
    for (const ObjectId object : {b, c}) replica.declare_remote(object, Role::kPredicted);
    watch.follow_all();
  }
  // Whether the world finds that one of the two runs into the other.
  [[nodiscard]] bool meet(MotionWorld& in, ObjectId one, ObjectId other) {
    while (in.poll_event()) {
    }
    in.set_base(one, now, moving({-3, 50, 0}, {4, 0, 0}));
    in.set_base(other, now, moving({0, 50, 0}, {0, 0, 0}));
    in.advance(now + 900ms);
    for (const ObjectId object : {one, other}) in.set_base(object, now + 900ms, moving({0, -50, 0}, {0, 0, 0}));
    now += 1s;
    bool found = false;
    while (const auto event = in.poll_event()) found |= std::holds_alternative<ContactEvent>(*event);
    return found;
  }
  [[nodiscard]] bool meet_in_truth(ObjectId one, ObjectId other) { return meet(replica.truth(), one, other); }
  void give(ObjectId object, PeerId owner) {
    if (owner == conf.id) own.adopt(object);
    if (owner != conf.id && own.contains(object)) own.remove({{object}});
    owners.set(object, owner);
    watch.follow_owners_of({{object}});
  }

  World world{box("A", "1 1 1", "0 0 0", kBounces) + box("B", "1 1 1", "-5 0 0") + box("C", "1 1 1", "9 9 9") +
                  interest("A", "\"B\" \"C\"") + interest("B", "\"C\""),
              {"A", "B", "C"}};
  ObjectId a = world["A"], b = world["B"], c = world["C"];
  PeerConfig conf = config(2, {{a}});
  Owners owners;
  OwnObjects own{*world.in_force, conf.owned, false};
  SceneObjects scene{*world.in_force};
  Replica replica{*world.in_force};
  ContactWatch watch{conf, *world.in_force, owners, scene, own, replica};
  SimTime now = sim(10s);
};

TEST_F(Watching, SearchesWhatItDecides) {
  EXPECT_TRUE(watch.searches(a, b)) << "the lower id decides";
  EXPECT_FALSE(watch.leaves(a, b));
  EXPECT_FALSE(watch.searches(b, c));
  give(b, PeerId{1});
  EXPECT_FALSE(watch.searches(a, b));
  EXPECT_TRUE(watch.leaves(a, b));
  EXPECT_FALSE(meet_in_truth(a, b));
}

// B and C are other peers'. Their contacts count here as long as one of the two may meet an own object.
TEST_F(Watching, PartnersOfOwnObjectsMeetInTheTruth) {
  EXPECT_TRUE(meet_in_truth(b, c));
  give(a, PeerId{3});
  EXPECT_FALSE(meet_in_truth(b, c));
  give(a, conf.id);
  EXPECT_TRUE(meet_in_truth(b, c));
  give(a, kNobody);
  EXPECT_FALSE(meet_in_truth(b, c));
  EXPECT_TRUE(meet(replica.ghosts(), b, c)) << "they are predicted all the same";
}

// A contact that lasts has to be solved, whoever decides.
TEST_F(Watching, WhatRestsIsFollowedForAnotherOwner) {
  give(b, PeerId{1});
  give(c, PeerId{1});
  EXPECT_FALSE(meet_in_truth(a, b));
  EXPECT_FALSE(meet_in_truth(b, c));
  watch.set_rests(a, b, true);
  EXPECT_TRUE(watch.rests(b, a));
  EXPECT_TRUE(meet_in_truth(a, b));
  EXPECT_TRUE(meet_in_truth(b, c));
  give(b, conf.id);
  EXPECT_FALSE(watch.rests(a, b)) << "both are this peer's";
  give(b, PeerId{1});
  watch.set_rests(a, b, true);
  watch.forget_rests_of(a);
  EXPECT_FALSE(watch.rests(a, b));
}

}  // namespace peerd::replication::contact_watch_test
