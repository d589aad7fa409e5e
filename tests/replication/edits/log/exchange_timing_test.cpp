#include "replication/edits/log/exchange_timing.hpp"

#include <gtest/gtest.h>

namespace peerd::replication::exchange_timing_test {

// Each of the waiting times, drawn often, by the longest one.
Duration longest(Duration delay) {
  ExchangeTiming timing(1);
  timing.set_delay(delay);
  Duration most{0};
  for (int i = 0; i < 1000; ++i) {
    for (const Duration wait : {timing.ask_after(1), timing.ask_again_after(0), timing.answer_after(0, 0),
                                timing.crossing(), timing.asked_for()}) {
      most = std::max(most, wait);
    }
  }
  return most;
}

TEST(ExchangeTiming, WaitingTimesAreMultiplesOfTheDelay) {
  EXPECT_GT(longest(std::chrono::milliseconds(20)), std::chrono::milliseconds(100));
  EXPECT_LE(longest(std::chrono::milliseconds(20)), std::chrono::milliseconds(120));
  EXPECT_LE(longest(Duration{0}), 6 * ExchangeTiming::kDelayMin) << "ticks cannot tell shorter ones apart";
}

// A host that did not run for 7 s makes the longest latency of its session 7 s, for a while.
TEST(ExchangeTiming, AHostThatSleptMakesNobodyWaitForSeconds) {
  EXPECT_EQ(longest(std::chrono::seconds(7)), longest(ExchangeTiming::kDelayMax));
  EXPECT_LE(longest(std::chrono::seconds(7)), 6 * ExchangeTiming::kDelayMax);
}

TEST(ExchangeTiming, QuestionsAreAskedAgainAtLeastThatOften) {
  ExchangeTiming timing(1);
  timing.set_delay(std::chrono::milliseconds(50));
  EXPECT_GE(timing.ask_again_after(0), std::chrono::milliseconds(250));
  EXPECT_GE(timing.ask_again_after(1), std::chrono::milliseconds(500));
  for (const std::uint32_t n : {5u, 60u, 4'000'000u}) {
    EXPECT_GE(timing.ask_again_after(n), ExchangeTiming::kAgainMax);
    EXPECT_LE(timing.ask_again_after(n), ExchangeTiming::kAgainMax + std::chrono::milliseconds(50));
  }
}

}  // namespace peerd::replication::exchange_timing_test
