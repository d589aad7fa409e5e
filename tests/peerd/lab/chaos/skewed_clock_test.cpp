#include "peerd/lab/chaos/skewed_clock.hpp"

#include <gtest/gtest.h>

#include "peerd/peer/motion/random.hpp"

namespace peerd::chaos::skewed_clock_test {

constexpr sim::VirtualTime kBegin{std::chrono::seconds(1000)};
constexpr HostTime kHost{std::chrono::seconds(77)};

TEST(SkewedClock, GainsWhatItSays) {
  for (const std::int64_t ppm : {-500, 0, 500}) {
    const SkewedClock clock(kBegin, kHost, ppm);
    EXPECT_EQ(clock.at(kBegin), kHost);
    EXPECT_EQ(clock.at(kBegin + std::chrono::seconds(100)) - kHost,
              std::chrono::seconds(100) + std::chrono::microseconds(100 * ppm));
  }
}

TEST(SkewedClock, WhenIsTheFirstInstantOfAReading) {
  motion::Random random(1, 0);
  for (int i = 0; i < 20'000; ++i) {
    const auto ppm = static_cast<std::int64_t>(random.below(1001)) - 500;
    const SkewedClock clock(kBegin, kHost, ppm);
    const HostTime reading = kHost + Duration{static_cast<std::int64_t>(random.below(3'600'000'000'000))};
    const sim::VirtualTime t = clock.when(reading);
    EXPECT_GE(clock.at(t), reading);
    if (t > kBegin) {
      EXPECT_LT(clock.at(t - Duration{1}), reading);
    }
  }
}

TEST(SkewedClock, NeverRunsBackwards) {
  for (const std::int64_t ppm : {-500, -1, 1, 500}) {
    const SkewedClock clock(kBegin, kHost, ppm);
    for (std::int64_t ns = 0; ns < 100'000; ++ns) {
      EXPECT_LE(clock.at(kBegin + Duration{ns}), clock.at(kBegin + Duration{ns + 1}));
    }
  }
}

TEST(SkewedClock, WhatIsOverIsNow) {
  const SkewedClock clock(kBegin, kHost, 200);
  EXPECT_EQ(clock.when(kHost - std::chrono::seconds(5)), kBegin);
}

}  // namespace peerd::chaos::skewed_clock_test
