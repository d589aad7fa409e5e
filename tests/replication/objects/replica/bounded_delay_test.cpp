#include "replication/objects/replica/bounded_delay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "replication/session/delay_meter.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::bounded_delay_test {

using namespace test;

const BoundedLatency kFixed{120ms, false}, kMeasured{0ms, true}, kAtLeast{200ms, true}, kSlowTicks{0ms, true, 20};
const Duration kMargin = kMeasured.margin();

TEST(BoundedDelay, AFixedOneStays) {
  BoundedDelay delay(kFixed);
  delay.on_published(sim(1s), 500ms, sim(1s));
  for (const Duration t : {0s, 1s, 20s, 3600s}) {
    EXPECT_EQ(delay.at(sim(t)), 120ms);
    EXPECT_TRUE(delay.is_steady_at(sim(t)));
  }
}

TEST(BoundedDelay, OfNoHelloItIsThatOfALinkWithoutLatency) {
  BoundedDelay delay(kMeasured);
  EXPECT_EQ(delay.at(sim(5s)), latency_bound(0ms) + kMargin);
  BoundedDelay of_slow_ticks(kSlowTicks);
  EXPECT_EQ(of_slow_ticks.at(sim(5s)), latency_bound(0ms) + 105ms);
}

TEST(BoundedDelay, AJoiningPeerBeginsWithWhatHasBeenSent) {
  BoundedDelay delay(kMeasured);
  delay.on_published(sim(4900ms), 150ms, sim(5s));
  delay.on_published(sim(4950ms), 100ms, sim(5s));
  EXPECT_EQ(delay.at(sim(5s)), 150ms + kMargin);
  EXPECT_TRUE(delay.is_steady_at(sim(5s)));
}

// A latency of 250 ms is sent from 10.5 s until 20.5 s, one of 50 ms in every second.
class Grows : public testing::Test {
 protected:
  static void publish(BoundedDelay& delay, Duration from, Duration until) {
    for (Duration t = from; t < until; t += 1s) {
      delay.on_published(sim(t), 50ms, sim(t + 100ms));
      if (t >= 10s && t < 21s) delay.on_published(sim(t + 500ms), 250ms, sim(t + 700ms));
    }
  }
};

TEST_F(Grows, OnceAllKnowIt_ByATenthOfTheTime) {
  BoundedDelay delay(kMeasured);
  std::vector<std::pair<Duration, Duration>> turns;  // when it began to change, or ended
  bool was_steady = true;
  Duration before = 50ms + kMargin, shown{-1s};
  for (Duration t = 0s; t < 50s; t += 10ms) {
    if (t % 1s == 0s) publish(delay, t, t + 1s);
    const Duration now = delay.at(sim(t));
    ASSERT_LE(now > before ? now - before : before - now, 1ms) << to_seconds(t);
    ASSERT_GT(t - now, shown) << "what is shown never goes back";
    shown = t - now;
    before = now;
    if (const bool steady = delay.is_steady_at(sim(t)); steady != was_steady) {
      turns.emplace_back(t, now);
      was_steady = steady;
    }
  }
  // Sent in the second 10, counted from 13 on; in the second 20, counted until 32.
  const std::vector<std::pair<Duration, Duration>> expected{
      {13s, 50ms + kMargin}, {15s, 250ms + kMargin}, {33s, 250ms + kMargin}, {35s, 50ms + kMargin}};
  EXPECT_EQ(turns, expected);
}

// Hellos come in another order, up to 2 s late, and some peers ask seldom: the same bound at the same times.
TEST_F(Grows, AlikeForAllWhoHaveReceivedTheSame) {
  std::mt19937_64 random(7);
  struct Sent {
    Duration at, latency, comes;
  };
  std::vector<Sent> sent;
  std::uniform_int_distribution<int> ms(0, 1900), steps(1, 12);
  for (Duration t = 0s; t < 60s; t += 300ms) sent.push_back({t, steps(random) * 50ms, t});
  const auto bounds = [&](std::uint64_t seed, Duration asks_every) {
    std::mt19937_64 way(seed);
    std::vector<Sent> arriving = sent;
    for (Sent& hello : arriving) hello.comes += ms(way) * 1ms;
    std::ranges::sort(arriving, {}, &Sent::comes);
    BoundedDelay delay(kMeasured);
    std::vector<Duration> of;
    auto next = arriving.begin();
    for (Duration t = 0s; t < 60s; t += 20ms) {
      for (; next != arriving.end() && next->comes <= t; ++next) {
        delay.on_published(sim(next->at), next->latency, sim(t));
      }
      if (t % asks_every == 0s) of.push_back(delay.at(sim(t)));
    }
    return of;
  };
  const auto one = bounds(1, 20ms), other = bounds(2, 20ms), seldom = bounds(3, 2500ms);
  // They begin with what each has received first, and agree once they have moved by what there was to move.
  const std::size_t begun = 15s / 20ms;
  ASSERT_EQ(one.size(), other.size());
  EXPECT_TRUE(std::equal(one.begin() + begun, one.end(), other.begin() + begun));
  EXPECT_NE(*std::ranges::max_element(one), *std::ranges::min_element(one.begin() + begun, one.end()));
  for (std::size_t i = 6; i < seldom.size(); ++i) EXPECT_EQ(seldom[i], one[i * (2500ms / 20ms)]) << i;
}

TEST(BoundedDelay, IsNeverShorterThanTheConfiguredOneNorLongerThanTheLongest) {
  BoundedDelay delay(kAtLeast);
  EXPECT_EQ(delay.at(sim(0s)), 200ms);
  delay.on_published(sim(0s), 2000ms, sim(0s));
  delay.restart();
  delay.on_published(sim(0s), 2000ms, sim(0s));
  EXPECT_EQ(delay.at(sim(0s)), kBoundMax);
}

TEST(BoundedDelay, WhatIsSaidOfOtherTimesDoesNotCount) {
  BoundedDelay delay(kMeasured);
  delay.on_published(sim(80s), 1000ms, sim(100s));
  delay.on_published(sim(102s), 1000ms, sim(100s));
  delay.on_published(sim(500s), 1000ms, sim(100s));
  EXPECT_EQ(delay.at(sim(100s)), 50ms + kMargin);
}

TEST(BoundedDelay, AStepOfTheSessionBeginsItAnew) {
  BoundedDelay delay(kMeasured);
  delay.on_published(sim(0s), 500ms, sim(0s));
  EXPECT_EQ(delay.at(sim(0s)), 500ms + kMargin);
  delay.restart();
  EXPECT_EQ(delay.at(sim(9000s)), 50ms + kMargin);
}

}  // namespace peerd::replication::bounded_delay_test
