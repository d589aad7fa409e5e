#include "peerd/net/relay/byte_budget.hpp"

#include <gtest/gtest.h>

namespace peerd::relay::byte_budget_test {

constexpr HostTime kStart{std::chrono::seconds(100)};

TEST(ByteBudget, UpdatesAreLeftOutBeforeWhatMattersToAll) {
  ByteBudget budget(1'000.0, kStart);  // 500 at once, the last 125 of them for all
  EXPECT_TRUE(budget.take(300, false, kStart));
  EXPECT_FALSE(budget.take(100, false, kStart));
  EXPECT_TRUE(budget.take(100, true, kStart));
  EXPECT_TRUE(budget.take(100, true, kStart));
  EXPECT_FALSE(budget.take(1, true, kStart));
}

TEST(ByteBudget, ComesBackAtItsRateAndNoFurtherThanItBegan) {
  ByteBudget budget(1'000.0, kStart);
  EXPECT_TRUE(budget.take(500, true, kStart));
  const HostTime later = kStart + std::chrono::milliseconds(200);
  EXPECT_FALSE(budget.take(201, true, later));
  EXPECT_TRUE(budget.take(200, true, later));
  const HostTime much_later = kStart + std::chrono::hours(1);
  EXPECT_TRUE(budget.take(500, true, much_later));
  EXPECT_FALSE(budget.take(1, true, much_later));
}

TEST(ByteBudget, ATimeBeforeTheLastGivesNothing) {
  ByteBudget budget(1'000.0, kStart);
  EXPECT_TRUE(budget.take(500, true, kStart));
  EXPECT_FALSE(budget.take(1, true, kStart - std::chrono::seconds(5)));
  EXPECT_FALSE(budget.take(1, true, kStart));
}

}  // namespace peerd::relay::byte_budget_test
