#include "replication/objects/contacts/decision_check.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::decision_check_test {

using namespace test;

// Nobody owns A; peer 3, the decider, owns B. Both have stood still since 0 s, and it is 20 s.
class Checked : public testing::Test {
 protected:
  Checked() {
    owners.set(b, PeerId{3});
    add_member(members, 3);
    replica.begin(sim(0s));
    for (const ObjectId object : {a, b}) replica.declare_remote(object, Role::kPredicted);
    const UpdateRecord u{b, 1, sim(1s), moving({2, 0, 0})};
    replica.note_update(u);
    replica.set_ghost(b, sim(1s), u.model, false);
    replica.advance_ghosts(sim(20s));
    ticks.set_last(ticks.number_at(sim(20s)));
  }
  [[nodiscard]] DecisionRecord record(const Vec3& of_a, const Vec3& of_b, const Vec3& after = Vec3::Zero()) const {
    return {a,
            b,
            sim(20s) - 100ms,
            Vec3::UnitX(),
            moving(of_a),
            moving(of_b),
            moving(of_a, after),
            moving(of_b),
            DecisionRule::kId};
  }
  [[nodiscard]] std::optional<MemberLimit> broken(const DecisionRecord& d, HostTime now = host(20s)) const {
    return check.broken_by(now, PeerId{3}, d);
  }

  World world{box("A", "1 1 1", "0 0 0", kBounces) + box("B", "1 1 1", "2 0 0") + interest("A", "\"B\""), {"A", "B"}};
  ObjectId a = world["A"], b = world["B"];
  Membership members{1750ms};
  Owners owners;
  Replica replica{*world.in_force};
  TickGrid ticks{60};
  DecisionCheck check{*world.in_force, members, owners, replica, ticks};
};

TEST_F(Checked, WhatCanBeIsTaken) {
  EXPECT_EQ(broken(record({0, 0, 0}, {1, 0, 0}, {-9, 0, 0})), std::nullopt);
  EXPECT_EQ(broken(record({15, 0, 0}, {16, 0, 0})), std::nullopt) << "peers may differ by so much";
}

TEST_F(Checked, AnObjectIsNearWhereItIsBelieved) {
  EXPECT_EQ(broken(record({40, 0, 0}, {41, 0, 0})), MemberLimit::kDecisionElsewhere);
  replica.set_ghost(a, sim(19s), moving({0, 0, 0}, {10, 0, 0}), false);
  replica.advance_ghosts(sim(20s));
  EXPECT_EQ(broken(record({40, 0, 0}, {41, 0, 0})), std::nullopt) << "it moves";
}

TEST_F(Checked, TheDecidersOwnObjectIsItsOwn) {
  DecisionRecord d = record({0, 0, 0}, {1, 0, 0});
  d.collidee_after.position = {1e6, 0, 0};
  EXPECT_EQ(broken(d), std::nullopt);
  owners.set(b, PeerId{4});
  EXPECT_EQ(broken(d), MemberLimit::kDecisionElsewhere);
}

TEST_F(Checked, TheTwoTouch) { EXPECT_EQ(broken(record({0, 0, 0}, {9, 0, 0})), MemberLimit::kDecisionImpossible); }

TEST_F(Checked, NothingIsMuchFasterThanBefore) {
  EXPECT_EQ(broken(record({0, 0, 0}, {1, 0, 0}, {99, 0, 0})), std::nullopt);
  EXPECT_EQ(broken(record({0, 0, 0}, {1, 0, 0}, {101, 0, 0})), MemberLimit::kDecisionImpossible);
}

TEST_F(Checked, WhoHasJustComeKnowsNothing) {
  const DecisionRecord d = record({40, 0, 0}, {41, 0, 0});
  members.find(PeerId{3})->since = host(11s);
  EXPECT_EQ(broken(d), std::nullopt) << "the owner has just come";
  members.find(PeerId{3})->since = host(0s);
  EXPECT_EQ(broken(d), MemberLimit::kDecisionElsewhere);
  replica.forget_update_of(b);
  EXPECT_EQ(broken(d), std::nullopt) << "nothing has come of it";
}

}  // namespace peerd::replication::decision_check_test
