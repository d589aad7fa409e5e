#include "replication/session/session_clock.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::session_clock_test {

using namespace test;

SessionClock::Estimate estimate(HostTime at, Duration offset, Duration either_way, bool settled = true) {
  SessionClock::Estimate e;
  e.bounds = {offset - either_way, offset + either_way};
  e.likely = offset;
  e.at = at;
  e.settled = settled;
  return e;
}
constexpr Duration kSteady = 2s;

TEST(SessionClock, HasNoTimeBeforeTheFirstEstimate) {
  SessionClock clock;
  EXPECT_FALSE(clock.synchronised());
  EXPECT_FALSE(clock.error_bound(host(100s)));
  clock.follow(host(100s), estimate(host(100s), 3s, 5ms, /*settled=*/false), kSteady);
  EXPECT_FALSE(clock.synchronised()) << "one queued packet could set it";
  clock.follow(host(101s), estimate(host(101s), 3s, 5ms), kSteady);
  EXPECT_TRUE(clock.synchronised());
  EXPECT_EQ(clock.to_session(host(101s)), sim(104s));
}

TEST(SessionClock, TheFounderIsTheSession) {
  SessionClock clock;
  clock.lead(host(5s));
  EXPECT_TRUE(clock.synchronised());
  EXPECT_EQ(clock.to_session(host(5s)), sim(5s));
  EXPECT_EQ(clock.error_bound(host(500s)), Duration(0s));
}

TEST(SessionClock, TheBoundHoldsDriftDebtAndTheFollowedOnesOwn) {
  SessionClock clock;
  clock.follow(host(100s), estimate(host(100s), 3s, 5ms), kSteady);
  EXPECT_EQ(clock.error_bound(host(100s)), 5ms + drift(0s, kDrift_ppm));
  EXPECT_EQ(clock.error_bound(host(101s)), 5ms + drift(1s, kDrift_ppm));
  auto next = estimate(host(102s), 3s + 10ms, 5ms);  // to be slewed
  next.reference_error = 7ms;
  clock.follow(host(102s), next, kSteady);
  EXPECT_EQ(clock.error_bound(host(102s)), 5ms + 10ms + 7ms + 2 * drift(0s, kDrift_ppm));
  EXPECT_EQ(clock.debt(host(102s)), Duration(10ms));
}

// Session time is checked at every reading and between two adjustments, and to_host() is the inverse of to_session().
TEST(SessionClock, SlewsContinuouslyAndNeverRunsBackwards) {
  for (const Duration moved : {-240ms, -15ms, 15ms, 240ms}) {
    SCOPED_TRACE(to_seconds(moved));
    SessionClock clock;
    clock.follow(host(100s), estimate(host(100s), 3s, 5ms), kSteady);
    clock.adjust(host(100s));
    clock.follow(host(101s), estimate(host(101s), 3s + moved, 5ms), kSteady);
    SimTime last = clock.to_session(host(101s));
    HostTime now = host(101s);
    for (; now < host(140s); now += 16ms) {
      ASSERT_FALSE(clock.adjust(now));
      for (const Duration later : {0ns, 1ns, 7'000'001ns, 16'000'000ns}) {
        const SimTime reading = clock.to_session(now + later);
        ASSERT_GE(reading, last);
        ASSERT_LE(to_seconds(reading - last), to_seconds(later) * 1.0501 + 1e-8);
        last = reading;
        const HostTime back = clock.to_host(reading);
        ASSERT_GE(clock.to_session(back), reading);
        ASSERT_LT(clock.to_session(back - 1ns), reading);
      }
    }
    EXPECT_EQ(clock.session_minus_host(now), 3s + moved);
  }
}

TEST(SessionClock, StepsForwardsAloneAndOnlyBeyondWhatSlewingMends) {
  for (const auto& [moved, steps] :
       {std::pair{250ms, false}, std::pair{251ms, true}, std::pair{-251ms, false}, std::pair{-10'000ms, false}}) {
    SessionClock clock;
    clock.follow(host(100s), estimate(host(100s), 3s, 5ms), kSteady);
    clock.follow(host(101s), estimate(host(101s), 3s + moved, 5ms, /*settled=*/false), kSteady);
    EXPECT_FALSE(clock.adjust(host(101s))) << "too few exchanges to believe";
    clock.follow(host(101s), estimate(host(101s), 3s + moved, 5ms), kSteady);
    const auto step = clock.adjust(host(101s));
    EXPECT_EQ(step.has_value(), steps);
    EXPECT_EQ(clock.session_minus_host(host(101s)) == 3s + moved, steps);
  }
}

// The others take the clock for one that does not slew for a while yet.
TEST(SessionClock, HoldsStillAfterLeading) {
  SessionClock clock;
  clock.lead(host(100s));
  clock.follow(host(101s), estimate(host(101s), 15ms, 5ms), kSteady);
  clock.adjust(host(101s));
  clock.adjust(host(102s));
  EXPECT_EQ(clock.session_minus_host(host(102s)), Duration(0s));
  clock.adjust(host(103s));
  EXPECT_EQ(clock.session_minus_host(host(104s)), Duration(5ms));
}

TEST(SessionClock, AfterAStopItContinuesWithoutAnErrorBound) {
  SessionClock clock;
  clock.lead(host(100s));
  clock.stop(host(130s), 20s);
  EXPECT_FALSE(clock.synchronised());
  EXPECT_FALSE(clock.error_bound(host(130s)));
  EXPECT_EQ(clock.to_session(host(130s)), sim(110s));
  clock.follow(host(131s), estimate(host(131s), 0s, 5ms), kSteady);
  EXPECT_EQ(clock.error_bound(host(131s)), 20s + 5ms + drift(0s, kDrift_ppm));
  EXPECT_EQ(clock.adjust(host(131s)), Duration(20s));
}

TEST(SessionClock, LeadingGoesOnWithTheTimeAsItIs) {
  SessionClock clock;
  clock.follow(host(100s), estimate(host(100s), 3s, 5ms), kSteady);
  clock.lead(host(110s));
  clock.adjust(host(111s));
  EXPECT_EQ(clock.session_minus_host(host(120s)), Duration(3s));
}

}  // namespace peerd::replication::session_clock_test
