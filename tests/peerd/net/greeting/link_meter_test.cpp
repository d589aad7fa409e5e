#include "peerd/net/greeting/link_meter.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/must.hpp"

namespace peerd::net::link_meter_test {

using std::chrono::milliseconds;

constexpr HostTime kStart{std::chrono::seconds(1'000)};

// Two ends of a link, whose clocks differ.
struct Ends {
  LinkMeter near, far;
  Duration far_minus_near = std::chrono::seconds(17), there = milliseconds(30), back = milliseconds(50);
  HostTime now = kStart;

  // A note there, held there for a while, and one back.
  void exchange(Duration held) {
    const LinkNote out = near.note(now);
    now += there;
    EXPECT_TRUE(far.on_note(now + far_minus_near, out));
    now += held;
    const LinkNote in = far.note(now + far_minus_near);
    now += back;
    EXPECT_TRUE(near.on_note(now, in));
  }
};

TEST(LinkMeter, MeasuresTheWayThereAndBackWithoutTheTimeBetween) {
  Ends ends;
  EXPECT_FALSE(ends.near.round_trip());
  for (int i = 0; i < 5; ++i) ends.exchange(milliseconds(300));
  EXPECT_EQ(ends.near.round_trip(), milliseconds(80));
  EXPECT_GE(ends.near.latency_bound(), milliseconds(40));
}

// Whatever the two ways take of the round trip, the other clock is within the bound.
TEST(LinkMeter, BoundsTheOtherClock) {
  for (const int there_ms : {0, 1, 30, 79, 80}) {
    Ends ends{.there = milliseconds(there_ms), .back = milliseconds(80 - there_ms)};
    ends.exchange(milliseconds(10));
    const auto clock = must(ends.near.clock());
    EXPECT_EQ(clock.error, milliseconds(40));
    EXPECT_LE(ends.far_minus_near, clock.middle + clock.error);
    EXPECT_GE(ends.far_minus_near, clock.middle - clock.error);
  }
}

TEST(LinkMeter, KeepsTheClockOfTheShortestWayForAWhile) {
  Ends ends;
  ends.there = ends.back = milliseconds(5);
  ends.exchange(milliseconds(0));
  ends.there = ends.back = milliseconds(50);
  ends.exchange(milliseconds(0));
  EXPECT_EQ(ends.near.clock()->error, milliseconds(5));
  ends.now += std::chrono::seconds(11);
  ends.exchange(milliseconds(0));
  EXPECT_EQ(ends.near.clock()->error, milliseconds(50));
}

TEST(LinkMeter, CountsWhatIsLostInEachDirection) {
  std::mt19937 random(3);
  Ends ends;
  for (int round = 0; round < 200; ++round) {
    for (int i = 0; i < 20; ++i) {
      ends.near.count_out();
      if (random() % 100 >= 10) ends.far.count_in();
      ends.far.count_out();
      if (random() % 100 >= 2) ends.near.count_in();
    }
    ends.exchange(milliseconds(1));
  }
  EXPECT_NEAR(ends.near.loss_out(), 0.10, 0.03);
  EXPECT_NEAR(ends.near.loss_in(), 0.02, 0.015);
  EXPECT_NEAR(ends.far.loss_in(), 0.10, 0.03);
}

TEST(LinkMeter, ARecordedNoteCountsForNothing) {
  Ends ends;
  const LinkNote first = ends.far.note(kStart), second = ends.far.note(kStart + milliseconds(1));
  EXPECT_TRUE(ends.near.on_note(kStart, second));
  EXPECT_FALSE(ends.near.on_note(kStart, first));
  EXPECT_FALSE(ends.near.on_note(kStart, second));
}

TEST(LinkMeter, ImpossibleTimesAreNotMeasured) {
  Ends ends;
  const LinkNote out = ends.near.note(kStart);
  LinkNote forged{.sent_at_ns = 1, .echoed_ns = out.sent_at_ns + 1};
  EXPECT_TRUE(ends.near.on_note(kStart + milliseconds(1), forged));  // an echo of what has not been sent
  forged = {.sent_at_ns = 2, .echoed_ns = out.sent_at_ns, .held_us = 5'000'000};
  EXPECT_TRUE(ends.near.on_note(kStart + milliseconds(2), forged));  // held for longer than it was away
  EXPECT_FALSE(ends.near.round_trip());
  EXPECT_FALSE(ends.near.clock());
}

TEST(LinkMeter, ForgetsLossesOfALinkThatIsNotUsed) {
  Ends ends;
  ends.exchange(milliseconds(1));
  for (int i = 0; i < 400; ++i) ends.near.count_out();
  ends.exchange(milliseconds(1)), ends.exchange(milliseconds(1));
  EXPECT_TRUE(ends.near.is_lossy());
  ends.now += std::chrono::seconds(31);
  ends.exchange(milliseconds(1));
  EXPECT_FALSE(ends.near.is_lossy());
}

}  // namespace peerd::net::link_meter_test
