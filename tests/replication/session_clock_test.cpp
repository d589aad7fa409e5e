#include "replication/session_clock.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/replication/worlds.hpp"

namespace peerd::replication {
namespace {

using namespace test;

// One exchange with a leader whose host clock is `ahead` of ours and whose session time is its host time plus
// `session`. `sent` is when our hello left, on our clock.
SessionClock::Exchange exchange(HostTime sent, Duration ahead, Duration there, Duration back, Duration session = 0s) {
  const Duration hold = 30ms;
  const SimTime t2{(sent + there + ahead + session).time_since_epoch()};
  return {sent, t2, t2 + hold, sent + there + hold + back};
}

TEST(SessionClock, SaysNothingBeforeItKnows) {
  SessionClock clock;
  EXPECT_FALSE(clock.synchronised());
  for (int i = 0; i < 3; ++i) {
    clock.on_exchange(exchange(host(100s + i * 250ms), 3s, 5ms, 5ms));
    EXPECT_FALSE(clock.synchronised()) << i;
  }
  clock.on_exchange(exchange(host(101s), 3s, 5ms, 5ms));
  EXPECT_TRUE(clock.synchronised());
}

TEST(SessionClock, TheFounderIsTheSession) {
  SessionClock clock;
  clock.found_session();
  EXPECT_TRUE(clock.synchronised());
  EXPECT_EQ(clock.to_session(host(5s)), sim(5s));
  EXPECT_EQ(clock.error_bound(), 0s);
}

TEST(SessionClock, IsExactWhereBothWaysTakeTheSameTime) {
  for (const Duration ahead : {-3'000'000'001ns, 0ns, 3'000'000'000ns, 86'400'000'000'000ns}) {
    SessionClock clock;
    for (int i = 0; i < 4; ++i) clock.on_exchange(exchange(host(100s + i * 250ms), ahead, 200ms, 200ms, 7s));
    EXPECT_EQ(clock.session_minus_host(), ahead + 7s);
    EXPECT_EQ(clock.to_session(host(200s)), sim(200s + ahead + 7s));
    EXPECT_EQ(clock.to_host(clock.to_session(host(200s))), host(200s));
    EXPECT_EQ(clock.error_bound(), 200ms);
  }
}

TEST(SessionClock, IsNeverFartherOffThanItsBound) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const auto draw = [&](Duration most) { return Duration{static_cast<std::int64_t>(rng() % (most.count() + 1))}; };
    const Duration ahead = draw(20s) - 10s, session = draw(20s) - 10s;
    SessionClock clock;
    for (int i = 0; i < 40; ++i) {
      clock.on_exchange(exchange(host(100s + i * 250ms), ahead, draw(500ms), draw(500ms), session));
      // The estimate itself, not the slew towards it: a fresh clock fed with the same would start from here.
      if (i != 3) continue;
      const Duration error = clock.session_minus_host() - (ahead + session);
      EXPECT_LE(std::chrono::abs(error), clock.error_bound() + 1ns);
    }
  }
}

TEST(SessionClock, TheLeastRoundTripNamesTheOffset) {
  SessionClock clock;
  clock.on_exchange(exchange(host(100s), 3s, 5ms, 405ms));  // queued on the way back: 200 ms off
  clock.on_exchange(exchange(host(101s), 3s, 4ms, 4ms));
  clock.on_exchange(exchange(host(102s), 3s, 305ms, 5ms));
  clock.on_exchange(exchange(host(103s), 3s, 5ms, 105ms));
  EXPECT_EQ(clock.session_minus_host(), 3s);
  EXPECT_EQ(clock.error_bound(), 4ms);
}

TEST(SessionClock, OldSamplesAreForgotten) {
  SessionClock clock;
  for (int i = 0; i < 4; ++i) clock.on_exchange(exchange(host(100s + i * 1s), 3s, 1ms, 1ms));
  for (int i = 0; i < 16; ++i) clock.on_exchange(exchange(host(110s + i * 1s), 3s + 100ms, 9ms, 9ms));  // it drifted
  EXPECT_EQ(clock.error_bound(), 9ms);
  clock.adjust(host(200s));
  clock.adjust(host(300s));
  EXPECT_EQ(clock.session_minus_host(), 3s + 100ms);
}

TEST(SessionClock, AnImpossibleRoundTripIsNoSample) {
  SessionClock clock;
  for (int i = 0; i < 8; ++i) {
    SessionClock::Exchange e = exchange(host(100s + i * 1s), 0s, 5ms, 5ms);
    e.t4 = e.t1 + 1ms;  // answered before it was asked
    clock.on_exchange(e);
  }
  EXPECT_FALSE(clock.synchronised());
}

TEST(SessionClock, SlewsAndNeverRunsBackwards) {
  for (const Duration moved : {-240ms, 240ms}) {
    SessionClock clock;
    for (int i = 0; i < 4; ++i) clock.on_exchange(exchange(host(100s + i * 10ms), 3s, 5ms, 5ms));
    EXPECT_FALSE(clock.adjust(host(101s)));
    for (int i = 0; i < 16; ++i) clock.on_exchange(exchange(host(101s + i * 10ms), 3s + moved, 5ms, 5ms));
    SimTime last = clock.to_session(host(101s));
    Duration offset = clock.session_minus_host();
    for (HostTime now = host(101s); now < host(160s); now += 16ms) {
      EXPECT_FALSE(clock.adjust(now));
      ASSERT_GE(clock.to_session(now), last);
      last = clock.to_session(now);
      ASSERT_LE(std::chrono::abs(clock.session_minus_host() - offset), Duration{16ms} / 200);
      offset = clock.session_minus_host();
    }
    EXPECT_EQ(clock.session_minus_host(), 3s + moved);
  }
}

TEST(SessionClock, StepsOnlyBeyondWhatSlewingCouldMend) {
  for (const auto& [moved, steps] : {std::pair{250ms, false}, std::pair{251ms, true}, std::pair{-251ms, true}}) {
    SessionClock clock;
    for (int i = 0; i < 4; ++i) clock.on_exchange(exchange(host(100s + i * 10ms), 3s, 5ms, 5ms));
    clock.adjust(host(101s));
    clock.follow_another();
    for (int i = 0; i < 3; ++i) clock.on_exchange(exchange(host(101s + i * 10ms), 3s + moved, 5ms, 5ms));
    EXPECT_FALSE(clock.adjust(host(102s))) << "three exchanges are too few to believe";
    EXPECT_EQ(clock.session_minus_host(), 3s);
    clock.on_exchange(exchange(host(102s), 3s + moved, 5ms, 5ms));
    EXPECT_EQ(clock.adjust(host(102s)), steps);
    EXPECT_EQ(clock.session_minus_host() == 3s + moved, steps);
  }
}

TEST(SessionClock, StaysInItsSessionWhenItFollowsAnother) {
  SessionClock clock;
  for (int i = 0; i < 4; ++i) clock.on_exchange(exchange(host(100s + i * 10ms), 3s, 5ms, 5ms));
  clock.follow_another();
  EXPECT_TRUE(clock.synchronised());
  clock.adjust(host(110s));
  EXPECT_EQ(clock.session_minus_host(), 3s);
}

}  // namespace
}  // namespace peerd::replication
