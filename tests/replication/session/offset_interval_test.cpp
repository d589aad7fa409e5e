#include "replication/session/offset_interval.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::offset_interval_test {

using namespace test;

// One exchange with a host whose clock is `ahead` of ours. Our hello leaves at `sent` on our clock; ways and holding
// time are true times, and our clock is right.
bool exchange(OffsetInterval& interval, HostTime sent, Duration ahead, Duration there, Duration back,
              Duration hold = 30ms) {
  const SimTime t2{(sent + there + ahead).time_since_epoch()};
  return interval.on_hello(t2 + hold, sent + there + hold + back, OffsetInterval::Echo{sent, t2}, kDrift_ppm);
}

TEST(OffsetInterval, HasNoBoundsBeforeAnEcho) {
  OffsetInterval interval;
  EXPECT_FALSE(interval.at(host(100s), kDrift_ppm));
  EXPECT_TRUE(interval.on_hello(sim(103s), host(100s), std::nullopt, kDrift_ppm));
  EXPECT_FALSE(interval.at(host(100s), kDrift_ppm)) << "it is ahead by 3 s at least, and perhaps by a year";
  EXPECT_EQ(interval.exchanges(), 0u);
}

TEST(OffsetInterval, IsAsWideAsTheRoundTrip) {
  OffsetInterval interval;
  ASSERT_TRUE(exchange(interval, host(100s), 3s, 5ms, 7ms));
  const auto bounds = interval.at(host(100s + 42ms), kDrift_ppm);
  ASSERT_TRUE(bounds);
  EXPECT_LE(bounds->least, 3s - 7ms);
  EXPECT_GE(bounds->most, 3s + 5ms);
  EXPECT_NEAR(to_seconds(bounds->most - bounds->least), 12e-3 + 42e-6, 6e-6)
      << "and what the clocks may have drifted by";
  EXPECT_EQ(interval.round_trip(), 12ms);
}

// The quickest delay of each direction, though not of one exchange.
TEST(OffsetInterval, TakesEachDirectionsQuickest) {
  OffsetInterval interval;
  EXPECT_TRUE(exchange(interval, host(100s), 3s, 5ms, 405ms));
  EXPECT_TRUE(exchange(interval, host(101s), 3s, 305ms, 5ms));
  EXPECT_NEAR(to_seconds(interval.likely(host(101s + 340ms)).offset), 3.0, 2e-3);
  const auto bounds = interval.at(host(101s + 340ms), kDrift_ppm);
  EXPECT_LT(bounds->most - bounds->least, 14ms);
}

// Delays are random, drifts are at the limits, and datagrams get lost: the truth is never outside the interval.
TEST(OffsetInterval, HoldsTheTruth) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto draw = [&](Duration most) { return Duration(static_cast<std::int64_t>(random() % (most.count() + 1))); };
    const Duration ahead = draw(20s) - 10s, most_delay = draw(500ms);
    // True time counts from 0; `ours` and `theirs` are how much faster these clocks run.
    const std::int64_t ours_ppm = static_cast<std::int64_t>(random() % 1001) - 500;
    const std::int64_t theirs_ppm = static_cast<std::int64_t>(random() % 1001) - 500;
    const auto our = [&](Duration t) { return host(1000s + t + t * ours_ppm / 1'000'000); };
    const auto their = [&](Duration t) { return sim(1000s + ahead + t + t * theirs_ppm / 1'000'000); };
    OffsetInterval interval;
    for (Duration t{0}; t < 60s; t += 250ms) {
      if (random() % 5 == 0) continue;
      const Duration t2 = t + draw(most_delay), t3 = t2 + draw(250ms), t4 = t3 + draw(most_delay);
      ASSERT_TRUE(interval.on_hello(their(t3), our(t4), OffsetInterval::Echo{our(t), their(t2)}, kDrift_ppm));
      for (const Duration later : {0ms, 100ms, 3000ms}) {
        const Duration truth = their(t4 + later).time_since_epoch() - our(t4 + later).time_since_epoch();
        const auto bounds = interval.at(our(t4 + later), kDrift_ppm);
        ASSERT_LE(bounds->least, truth);
        ASSERT_GE(bounds->most, truth);
      }
      t = std::max(t, t4 - 250ms);  // arrivals in order
    }
  }
}

struct Jump {
  const char* name;
  Duration by;
};
class AJump : public testing::TestWithParam<Jump> {};
INSTANTIATE_TEST_SUITE_P(Table, AJump, testing::Values(Jump{"Forward", 10s}, Jump{"Back", -10s}, Jump{"ALittle", 20ms}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST_P(AJump, IsDetectedAndEarlierSamplesAreDropped) {
  OffsetInterval interval;
  for (int i = 0; i < 8; ++i) ASSERT_TRUE(exchange(interval, host(100s + i * 250ms), 3s, 5ms, 5ms));
  EXPECT_FALSE(exchange(interval, host(103s), 3s + GetParam().by, 5ms, 5ms));
  EXPECT_EQ(interval.exchanges(), 1u);
  EXPECT_NEAR(to_seconds(interval.likely(host(104s)).offset), to_seconds(3s + GetParam().by), 1e-9);
}

TEST(OffsetInterval, AJumpBetweenTheStampsLeavesOneBound) {
  OffsetInterval interval;
  // Their clock advanced by 10 s between receiving ours and answering, though they held it for no time.
  EXPECT_FALSE(
      interval.on_hello(sim(113s), host(100s + 10ms), OffsetInterval::Echo{host(100s), sim(103s)}, kDrift_ppm));
  EXPECT_FALSE(interval.at(host(101s), kDrift_ppm));
}

TEST(OffsetInterval, ImpossibleStampsAreNone) {
  OffsetInterval interval;
  constexpr Duration far{std::int64_t{1} << 62};
  EXPECT_TRUE(interval.on_hello(sim(far), host(-far), std::nullopt, kDrift_ppm));
  EXPECT_TRUE(interval.on_hello(sim(-far), host(100s), OffsetInterval::Echo{host(100s), sim(far)}, kDrift_ppm));
  const OffsetInterval::Echo from_our_future{host(200s), sim(100s)}, too_old{host(50s), sim(50s)},
      held_too_long{host(99s), sim(80s)};
  for (const auto& echo : {from_our_future, too_old, held_too_long}) {
    EXPECT_TRUE(interval.on_hello(sim(100s), host(100s), echo, kDrift_ppm));
  }
  EXPECT_EQ(interval.exchanges(), 0u);
}

// Delays are steady, whatever their length, with hellos once a second: the meter finds the speed, and continues with it
// between two hellos.
TEST(OffsetInterval, FollowsAClockThatRunsFaster) {
  for (const Duration way : {0ms, 100ms, 500ms}) {
    for (const std::int64_t ppm : {-1000, 37, 1000}) {
      SCOPED_TRACE(testing::Message() << to_seconds(way) << " s, " << ppm);
      const auto their = [&](Duration t) { return sim(1003s + t + t * ppm / 1'000'000); };
      OffsetInterval interval;
      for (Duration t{0}; t < 20s; t += 1s) {
        const OffsetInterval::Echo echo{host(1000s + t), their(t + way)};
        ASSERT_TRUE(interval.on_hello(their(t + way), host(1000s + t + 2 * way), echo, kDrift_ppm));
      }
      const Duration later = 19s + 2 * way + 900ms;
      const Duration truth = their(later).time_since_epoch() - host(1000s + later).time_since_epoch();
      const OffsetInterval::Likely likely = interval.likely(host(1000s + later));
      EXPECT_NEAR(to_seconds(likely.offset - truth), 0.0, 1e-7);
      EXPECT_NEAR(likely.speed * 1e6, static_cast<double>(ppm), 0.01);
    }
  }
}

// Where delays vary, the meter does not take their variation for a speed.
TEST(OffsetInterval, IsWithinAQuarterOfTheJitter) {
  std::vector<double> errors_s;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    const auto way = [&] { return 100ms + Duration(static_cast<std::int64_t>(random() % 50'000'000)); };
    const std::int64_t ppm = static_cast<std::int64_t>(random() % 2001) - 1000;
    const auto their = [&](Duration t) { return sim(1003s + t + t * ppm / 1'000'000); };
    OffsetInterval interval;
    for (Duration t{0}; t < 60s; t += 1s) {
      const Duration there = t + way(), back = there + way();
      const OffsetInterval::Echo echo{host(1000s + t), their(there)};
      ASSERT_TRUE(interval.on_hello(their(there), host(1000s + back), echo, kDrift_ppm));
      if (t < 10s) continue;
      const Duration truth = their(back).time_since_epoch() - host(1000s + back).time_since_epoch();
      errors_s.push_back(std::abs(to_seconds(interval.likely(host(1000s + back)).offset - truth)));
    }
  }
  std::ranges::sort(errors_s);
  EXPECT_LT(errors_s[errors_s.size() * 99 / 100], 0.05 / 4.0);
}

TEST(OffsetBounds, MeetOrNot) {
  EXPECT_EQ(intersection({1s, 3s}, {2s, 4s})->least, Duration(2s));
  EXPECT_EQ(intersection({1s, 3s}, {2s, 4s})->most, Duration(3s));
  EXPECT_TRUE(intersection({1s, 2s}, {2s, 3s}));
  EXPECT_FALSE(intersection({1s, 2s}, {2s + 1ns, 3s}));
}

}  // namespace peerd::replication::offset_interval_test
