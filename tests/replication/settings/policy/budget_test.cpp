#include "replication/settings/policy/budget.hpp"

#include <gtest/gtest.h>

#include "replication/wire/codec.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::budget_test {

using namespace test;

TEST(UpdateBudget, IsFullAtFirstAndDearerTheEmptierItIs) {
  PublishPolicy policy;
  policy.wanted_error_m = 0.01;
  policy.updates_per_s = 2;
  policy.updates_saved = 4;
  UpdateBudget budget;
  EXPECT_EQ(budget.least_gain_m(policy, sim(0s)), 0.01);
  budget.spend(policy, sim(0s));
  budget.spend(policy, sim(0s));
  EXPECT_EQ(budget.least_gain_m(policy, sim(0s)), 0.04);
  budget.spend(policy, sim(0s));
  EXPECT_EQ(budget.least_gain_m(policy, sim(0s)), 0.08);
  budget.spend(policy, sim(0s));
  EXPECT_EQ(budget.least_gain_m(policy, sim(0s)), 0.16) << "the last";
  budget.spend(policy, sim(0s));
  EXPECT_EQ(budget.least_gain_m(policy, sim(0s)), std::nullopt) << "one is owed";
  EXPECT_EQ(budget.least_gain_m(policy, sim(500ms)), 0.16) << "one more after half a second";
  EXPECT_EQ(budget.least_gain_m(policy, sim(100s)), 0.01) << "never more than can be saved";
}

TEST(UpdateBudget, BoundsWhatIsSentOfItsOwn) {
  PublishPolicy policy;
  policy.wanted_error_m = 1e-6;
  policy.updates_per_s = 1.9;
  policy.updates_saved = 6;
  UpdateBudget budget;
  int sent = 0;
  for (Duration t = 0s; t < 15s; t += 16ms) {
    if (!budget.least_gain_m(policy, sim(t))) continue;
    budget.spend(policy, sim(t));
    ++sent;
  }
  EXPECT_LE(sent, 7 + 1.9 * 15);
  EXPECT_GE(sent, 33);
}

// ---- the budget of bytes ----

constexpr double kOne = static_cast<double>(kDatagramMax_bytes);

TEST(ByteBudget, FillsAtItsRateUpToAQuarterOfASecond) {
  PublishPolicy policy;
  policy.bytes_per_s = 10'000.0;
  ByteBudget budget;
  EXPECT_EQ(budget.left(policy, sim(10s)), 2500.0) << "full at first";
  budget.spend(3000, true);
  EXPECT_EQ(budget.left(policy, sim(10s)), -500.0) << "what must go is owed";
  EXPECT_EQ(budget.left(policy, sim(10s + 100ms)), 500.0);
  EXPECT_EQ(budget.left(policy, sim(20s)), 2500.0);
  EXPECT_EQ(budget.left(policy, sim(15s)), 2500.0) << "session time has stepped";
  policy.bytes_per_s = 1000.0;
  EXPECT_EQ(ByteBudget().left(policy, sim(0s)), kOne) << "a datagram at least";
}

TEST(ByteBudget, AQuarterIsForUpdatesWhateverIsOwed) {
  PublishPolicy policy;
  policy.bytes_per_s = 1000.0;
  ByteBudget budget;
  EXPECT_EQ(budget.left(policy, sim(0s)), kOne);
  budget.spend(100'000, false);
  EXPECT_EQ(budget.left(policy, sim(0s)), -2000.0) << "more than two seconds' bytes are not owed";
  EXPECT_EQ(budget.left(policy, sim(1s)), 250.0);
  budget.spend(1000, false);
  EXPECT_EQ(budget.left(policy, sim(2s)), 500.0);
  budget.spend(400, true);
  EXPECT_EQ(budget.left(policy, sim(2s)), 100.0);
  budget.spend(1100, true);
  EXPECT_LT(budget.left(policy, sim(3s)), 0.0) << "that share owes, too";
  EXPECT_EQ(budget.left(policy, sim(60s)), kOne) << "a datagram at most";
}

// Each tick sends a datagram while anything is left; it is larger than what the share for updates gets in a tick.
TEST(ByteBudget, HoldsThoughADatagramGoesWheneverAnythingIsLeft) {
  PublishPolicy policy;
  policy.bytes_per_s = 3000.0;
  ByteBudget budget;
  double sent = 0.0;
  for (SimTime t = sim(0s); t < sim(60s); t += 20ms) {
    if (budget.left(policy, t) <= 0.0) continue;
    budget.spend(300, true);
    sent += 300.0;
  }
  EXPECT_LE(sent, 60.0 * 3000.0 + 2.0 * kOne);
  EXPECT_GE(sent, 60.0 * 3000.0);
}

TEST(ByteBudget, AnHourOfOverloadIsMadeUpForWithinSeconds) {
  PublishPolicy policy;
  policy.bytes_per_s = 1000.0;
  ByteBudget budget;
  SimTime t = sim(0s);
  for (; t < sim(3600s); t += 250ms) {
    (void)budget.left(policy, t);
    budget.spend(400, false);
  }
  std::size_t sent = 0;
  for (const SimTime end = t + 60s; t < end; t += 250ms) {
    if (budget.left(policy, t) < 100.0) continue;
    budget.spend(250, true);
    sent += 250;
  }
  EXPECT_GT(sent, 55'000u);
}

}  // namespace peerd::replication::budget_test
