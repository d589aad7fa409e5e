#include "peerd/net/os/host_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace peerd::net::host_clock_test {

using namespace std::chrono_literals;

TEST(HostClock, IsTheTimeOfThisComputer) {
  const HostClock clock;
  const Duration now = clock.now().time_since_epoch();
  const Duration wall = std::chrono::system_clock::now().time_since_epoch();
  EXPECT_LT(std::chrono::abs(now - wall), 1s);
}

// Timestamps of the wall clock can be converted however far the two clocks are apart.
TEST(HostClock, TurnsUnixTimeIntoItsOwn) {
  const auto wall = [] {
    return std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch());
  };
  for (const Duration offset : {Duration{0}, Duration{-24h}}) {
    const HostClock clock(offset);
    const Duration before = wall();
    const Duration found = clock.now().time_since_epoch() - clock.minus_wall();
    const Duration after = wall(), span = after - before;  // no reading is off by more than the duration of all of them
    EXPECT_GE(found, before - span);
    EXPECT_LE(found, after + span);
  }
}

TEST(HostClock, NeverRunsBackwards) {
  const HostClock clock;
  HostTime last = clock.now();
  for (int i = 0; i < 100'000; ++i) {
    const HostTime now = clock.now();
    ASSERT_GE(now, last);
    last = now;
  }
}

TEST(HostClock, TestOffsetMakesItBelieveAnotherTime) {
  for (const Duration offset : {Duration{3s}, Duration{-3s}, Duration{-24h}}) {
    const HostClock honest, shifted(offset);
    EXPECT_LT(std::chrono::abs(shifted.now() - honest.now() - offset), 500ms);
  }
}

TEST(HostClock, TwoClocksOfOneComputerRunAtOneRate) {
  const HostClock a, b(3s);
  const Duration first = b.now() - a.now();
  const auto until = a.now() + 20ms;
  while (a.now() < until) {
  }
  EXPECT_LT(std::chrono::abs((b.now() - a.now()) - first), 10ms);
}

}  // namespace peerd::net::host_clock_test
