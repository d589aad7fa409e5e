#include "replication/session/delay_meter.hpp"

#include <gtest/gtest.h>

#include "replication/wire/codec.hpp"

namespace peerd::replication::delay_meter_test {

using namespace std::chrono_literals;

TEST(DelayMeter, KnowsNothingBeforeTheFirstDelay) {
  const DelayMeter meter;
  EXPECT_EQ(meter.mean(), std::nullopt);
  EXPECT_EQ(meter.longest(), 0ns);
}

TEST(DelayMeter, AveragesTheDelaysThatItHas) {
  DelayMeter meter;
  meter.add(10ms);
  meter.add(40ms);
  EXPECT_EQ(meter.mean(), 25ms);
  EXPECT_EQ(meter.longest(), 40ms);
  EXPECT_EQ(meter.last(), 40ms);
}

TEST(DelayMeter, ForgetsTheOldestOfMoreThanItKeeps) {
  DelayMeter meter;
  meter.add(1s);
  for (std::size_t i = 0; i < DelayMeter::kDelays - 1; ++i) meter.add(2ms);
  EXPECT_EQ(meter.longest(), 1s);
  meter.add(3ms);
  EXPECT_EQ(meter.longest(), 3ms);
  EXPECT_EQ(meter.last(), 3ms);
  EXPECT_EQ(meter.mean(), (Duration{2ms} * 15 + Duration{3ms}) / 16);
}

TEST(LatencyBound, LeavesRoomForJitter) {
  EXPECT_EQ(latency_bound(-5ms), 50ms);
  EXPECT_EQ(latency_bound(0ms), 50ms);
  EXPECT_EQ(latency_bound(0ms), kLatencyStep);
  EXPECT_EQ(latency_bound(25ms), 50ms);
  EXPECT_EQ(latency_bound(26ms), 100ms);
  EXPECT_EQ(latency_bound(100ms), 150ms);
  EXPECT_EQ(latency_bound(500ms), 550ms);
}

}  // namespace peerd::replication::delay_meter_test
