#include "peerd/daemon/loop/tick_lateness.hpp"

#include <gtest/gtest.h>

namespace peerd::tick_lateness_test {

using namespace std::chrono_literals;

TEST(TickLateness, NoTicksAreNotLate) {
  const TickLateness none;
  EXPECT_EQ(none.count(), 0u);
  EXPECT_EQ(none.most(), Duration{0});
}

TEST(TickLateness, P99LeavesOutOneInAHundred) {
  TickLateness lateness;
  for (int i = 0; i < 99; ++i) lateness.add(250us);
  lateness.add(50ms);
  EXPECT_EQ(lateness.p99(), 300us) << "rounded up to a step";
  EXPECT_EQ(lateness.most(), 50ms);
  lateness.add(50ms);
  EXPECT_GT(lateness.p99(), 49ms) << "two in 101 are more than a hundredth";
  EXPECT_EQ(lateness.count(), 101u);
}

TEST(TickLateness, CountsTheTicksThatWereLaterThanAStep) {
  TickLateness lateness;
  lateness.add(900us);
  lateness.add(2500us);
  lateness.add(3s);
  EXPECT_EQ(lateness.later_than(1ms), 2u);
  EXPECT_EQ(lateness.later_than(50ms), 1u);
}

TEST(TickLateness, ATickBeforeItsTimeCountsAsPunctual) {
  TickLateness lateness;
  lateness.add(-1ms);
  EXPECT_EQ(lateness.p99(), TickLateness::kStep);
  EXPECT_EQ(lateness.most(), Duration{0});
}

TEST(TickLateness, BeyondTheHistogramTheGreatestCounts) {
  TickLateness lateness;
  for (int i = 0; i < 5; ++i) lateness.add(3s);
  EXPECT_EQ(lateness.p99(), 3s);
}

}  // namespace peerd::tick_lateness_test
