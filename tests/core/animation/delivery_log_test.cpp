#include "core/animation/delivery_log.hpp"

#include <gtest/gtest.h>

namespace peerd::animation::delivery_log_test {

TEST(DeliveryLog, FindsTheEventsAroundATime) {
  DeliveryLog log;
  log.grow(3);
  EXPECT_FALSE(log.has(1));
  EXPECT_EQ(log.latest(1, 10), nullptr);
  log.insert(1, 4, Value::of_float(40));
  log.insert(1, 2, Value::of_float(20));
  EXPECT_TRUE(log.has(1));
  EXPECT_FALSE(log.has(2));
  EXPECT_EQ(log.latest(1, 1.9), nullptr);
  EXPECT_EQ(log.latest(1, 2)->value.scalar(), 20.0);  // an event counts from its own time on
  EXPECT_EQ(log.next(1, 2)->t, 4.0);
  EXPECT_EQ(log.latest(1, 1e9)->value.scalar(), 40.0);
  EXPECT_EQ(log.next(1, 4), nullptr);
}

TEST(DeliveryLog, TheLastCallOfOneTimeCounts) {
  DeliveryLog log;
  log.grow(1);
  log.insert(0, 1, Value::of_float(1));
  log.insert(0, 1, Value::of_float(2));
  EXPECT_EQ(log.latest(0, 1)->value.scalar(), 2.0);
}

TEST(DeliveryLog, GivesTheKeptValueToBeChanged) {
  DeliveryLog log;
  log.grow(1);
  log.insert(0, 1, Value::of_float(1)).number[0] = 7;
  EXPECT_EQ(log.latest(0, 1)->value.scalar(), 7.0);
}

}  // namespace peerd::animation::delivery_log_test
