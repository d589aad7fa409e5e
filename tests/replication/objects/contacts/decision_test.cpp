#include "replication/objects/contacts/decision.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::decision_test {

using namespace test;

const PeerId kOne{1}, kTwo{2}, kServer{9};

TEST(DeciderById, IsTheLowerOfTwoOrTheOnlyOne) {
  EXPECT_EQ(decider_by_id(kOne, kTwo), kOne);
  EXPECT_EQ(decider_by_id(kTwo, kOne), kOne);
  EXPECT_EQ(decider_by_id(kTwo, kTwo), kTwo);
  EXPECT_EQ(decider_by_id(kNobody, kTwo), kTwo);
  EXPECT_EQ(decider_by_id(kTwo, kNobody), kTwo);
  EXPECT_EQ(decider_by_id(kNobody, kNobody), kNobody);
}

Contender stake(PeerId owner, double speed, double acceleration = 0.0, Duration latency = 100ms, bool sees = false) {
  return {owner, moving({0, 0, 0}, {0, speed, 0}, {acceleration, 0, 0}), latency, sees};
}
Contender unknown(PeerId owner) { return {owner, std::nullopt, 100ms, true}; }

// Two owners, 1 and 2, and the peer that decides by each policy: id, velocity, field-of-view, expected-error, server.
struct Case {
  const char* name;
  Contender one, two;
  std::array<PeerId, 5> expected;
};
class Deciders : public testing::TestWithParam<Case> {};
TEST_P(Deciders, AreTheSameForBothOwners) {
  const Case& c = GetParam();
  for (std::uint8_t i = 1; i <= 5; ++i) {
    const auto policy = static_cast<DecisionPolicy>(i);
    EXPECT_EQ(decider(policy, c.one, c.two, kServer), c.expected[i - 1u]) << int{i};
    EXPECT_EQ(decider(policy, c.two, c.one, kServer), c.expected[i - 1u]) << int{i};
    const PeerId without_server = i == 5 ? kOne : c.expected[i - 1u];
    EXPECT_EQ(decider(policy, c.one, c.two, kNobody), without_server) << int{i};
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, Deciders,
    testing::Values(
        Case{"AllAlike", stake(kOne, 2), stake(kTwo, 2), {kOne, kOne, kOne, kOne, kServer}},
        Case{"TheSecondIsFaster", stake(kOne, 2), stake(kTwo, -3), {kOne, kTwo, kOne, kTwo, kServer}},
        Case{"TheFirstIsFaster", stake(kOne, 3), stake(kTwo, -2), {kOne, kOne, kOne, kOne, kServer}},
        Case{"TheSecondSlowOneManoeuvres", stake(kOne, 9), stake(kTwo, 1, 5), {kOne, kOne, kOne, kTwo, kServer}},
        Case{"TheFirstSlowOneManoeuvres", stake(kOne, 1, 5), stake(kTwo, 9), {kOne, kTwo, kOne, kOne, kServer}},
        Case{"TheSecondHearsSooner",
             stake(kOne, 2, 2, 400ms),
             stake(kTwo, 2, 2, 50ms),
             {kOne, kOne, kOne, kTwo, kServer}},
        Case{"TheSecondLooks", stake(kOne, 2), stake(kTwo, 2, 0, 100ms, true), {kOne, kOne, kTwo, kOne, kServer}},
        Case{"BothLook",
             stake(kOne, 2, 0, 100ms, true),
             stake(kTwo, 2, 0, 100ms, true),
             {kOne, kOne, kOne, kOne, kServer}},
        Case{"TheSecondIsNotKnownSoFarBack", stake(kOne, 2), unknown(kTwo), {kOne, kOne, kOne, kOne, kServer}},
        Case{"TheFirstIsNotKnownSoFarBack", unknown(kOne), stake(kTwo, 2), {kOne, kOne, kOne, kOne, kServer}}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(Decider, OnlyTwoOwnersNeedOne) {
  for (std::uint8_t i = 1; i <= 5; ++i) {
    const auto policy = static_cast<DecisionPolicy>(i);
    EXPECT_EQ(decider(policy, stake(kNobody, 0), stake(kTwo, 1), kServer), kTwo);
    EXPECT_EQ(decider(policy, stake(kTwo, 1), stake(kTwo, 2), kServer), kTwo);
    EXPECT_EQ(decider(policy, stake(kNobody, 0), stake(kNobody, 0), kServer), kNobody);
  }
}

TEST(ExpectedError, GrowsWithSpeedAccelerationAndLatency) {
  EXPECT_DOUBLE_EQ(expected_error_m(moving({5, 5, 5}), 500ms), 0.0);
  EXPECT_DOUBLE_EQ(expected_error_m(moving({0, 0, 0}, {0, 3, 4}), 0ms), 5e-3);
  EXPECT_DOUBLE_EQ(expected_error_m(moving({0, 0, 0}, {0, 0, 0}, {0, 0, 8}), 500ms), 1.0);
}

// The two owners may find a contact at slightly different times. The decision goes by the states of one instant for
// both, which lies far enough back.
TEST(DecidedAsOf, IsOnAGridAndFarEnoughBack) {
  EXPECT_EQ(decided_as_of(sim(1000ms), 100ms), sim(900ms));
  EXPECT_EQ(decided_as_of(sim(1124ms), 100ms), sim(900ms));
  EXPECT_EQ(decided_as_of(sim(1125ms), 100ms), sim(1025ms));
  EXPECT_EQ(decided_as_of(sim(-1ms), 0ms), sim(-125ms));
  for (int i = 0; i < 1000; ++i) {
    const SimTime contact = sim(i * 7919us);
    EXPECT_LE(decided_as_of(contact, 150ms), contact - 150ms);
    EXPECT_GT(decided_as_of(contact, 150ms), contact - 275ms);
  }
}

TEST(Sees, WhatLiesInTheFrustum) {
  const auto box_at = [](double x, double z) { return WorldBox{Vec3(x - 1, -1, z - 1), Vec3(x + 1, 1, z + 1)}; };
  const collision::Camera ahead{{}, 0.8, 1.0};
  EXPECT_TRUE(sees(ahead, box_at(0, -10)));
  EXPECT_FALSE(sees(ahead, box_at(0, 10))) << "behind";
  EXPECT_FALSE(sees(ahead, box_at(30, -10))) << "beside";
  EXPECT_FALSE(sees({{}, 0.0, 1.0}, box_at(0, -10))) << "no frustum at all";
}

}  // namespace peerd::replication::decision_test
