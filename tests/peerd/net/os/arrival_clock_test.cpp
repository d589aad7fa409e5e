#include "peerd/net/os/arrival_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <random>

#include "tests/must.hpp"

namespace peerd::net::arrival_clock_test {

using namespace std::chrono_literals;

// A computer whose wall clock can be set. Its HostClock begins at 1000 s.
struct Computer {
  HostTime host{1000s};
  Duration wall_minus_host{500s};

  [[nodiscard]] Duration wall() const { return host.time_since_epoch() + wall_minus_host; }
  // A pair of readings within 60 ns.
  HostClock::Pair pair() {
    const HostTime before = host;
    host += 30ns;
    const Duration read = wall();
    host += 30ns;
    return {before, read, host};
  }
};

// A clock that has got a pair of readings, when the queue was empty last.
struct ArrivalClocks : testing::Test {
  ArrivalClocks() { clock.on_pair(computer.pair()); }
  Computer computer;
  HostTime empty_at = computer.host;
  ArrivalClock clock;
};

TEST_F(ArrivalClocks, GivesTheHostTimeOfAStamp) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    empty_at = computer.host;
    computer.host += Duration{static_cast<std::int64_t>(random() % 1'000'000'000)};
    const HostTime came = computer.host;
    const Duration stamp = computer.wall();
    computer.host += Duration{static_cast<std::int64_t>(random() % 100'000'000)};
    clock.on_pair(computer.pair());
    const auto at = must(clock.arrival(stamp, empty_at));
    EXPECT_LE(std::chrono::abs(at - came), 30ns) << "half of what the readings took";
  }
}

TEST_F(ArrivalClocks, NeverLaterThanTheReading) {
  const HostTime before = computer.host;
  const auto slow =
      HostClock::Pair{before, computer.wall() + 900us, before + 1ms};  // preempted: the true time is anywhere within
  ArrivalClock fresh;
  fresh.on_pair(slow);
  EXPECT_LE(must(fresh.arrival(slow.wall, before)), slow.after);
}

TEST_F(ArrivalClocks, AStampFromTheFutureIsNone) {
  const Duration read = computer.wall() - 30ns;
  EXPECT_TRUE(clock.arrival(read, empty_at));
  EXPECT_FALSE(clock.arrival(read + 1ns, empty_at));
}

TEST_F(ArrivalClocks, AStampFromBeforeTheQueueWasEmptyIsNone) {
  const Duration middle = computer.wall() - computer.host.time_since_epoch();
  const Duration oldest = empty_at.time_since_epoch() + middle - ArrivalClock::kStampToQueue;
  EXPECT_TRUE(clock.arrival(oldest + 1us, empty_at));
  EXPECT_FALSE(clock.arrival(oldest - 1us, empty_at));
}

// The wall clock is set while datagrams wait: no arrival time may be off by more than the slack.
class SteppedWallClock : public ArrivalClocks, public testing::WithParamInterface<Duration> {};
TEST_P(SteppedWallClock, IsNoticedUntilTheQueueHasBeenEmpty) {
  empty_at = computer.host;
  computer.host += 20ms;
  const Duration before_step = computer.wall();
  computer.host += 20ms;
  computer.wall_minus_host += GetParam();
  computer.host += 20ms;
  const Duration after_step = computer.wall();
  computer.host += 20ms;
  clock.on_pair(computer.pair());
  EXPECT_FALSE(clock.arrival(before_step, empty_at));
  EXPECT_FALSE(clock.arrival(after_step, empty_at)) << "nobody can tell it from the other";

  // The rest of a long queue, read in a later batch.
  computer.host += 200ms;
  clock.on_pair(computer.pair());
  EXPECT_FALSE(clock.arrival(before_step, empty_at));

  empty_at = computer.host;  // seen empty long after the step
  computer.host += 10ms;
  const HostTime came = computer.host;
  const Duration stamp = computer.wall();
  computer.host += 10ms;
  clock.on_pair(computer.pair());
  const auto at = clock.arrival(stamp, empty_at);
  ASSERT_TRUE(at) << "the new difference is known";
  EXPECT_LE(std::chrono::abs(*at - came), 30ns);
}
INSTANTIATE_TEST_SUITE_P(Steps, SteppedWallClock,
                         testing::Values(Duration{10s}, Duration{-10s}, Duration{5ms}, Duration{-5ms},
                                         Duration{24h * 365}, Duration{-24h * 365}, Duration{10us}, Duration{-10us}),
                         [](const auto& c) {
                           const auto ns = c.param.count();
                           return (ns < 0 ? "Back" : "Forward") + std::to_string(ns < 0 ? -ns : ns) + "ns";
                         });

TEST(ArrivalClock, SlowReadingsAreNoStep) {
  Computer computer;
  ArrivalClock clock;
  std::mt19937_64 random(3);
  HostTime empty_at = computer.host;
  for (int i = 0; i < 1000; ++i) {
    computer.host += 1ms;
    const HostTime came = computer.host;
    const Duration stamp = computer.wall();
    computer.host += 1ms;
    const HostTime before = computer.host;  // preempted somewhere within the readings
    computer.host += Duration{static_cast<std::int64_t>(random() % 3'000'000)};
    const Duration wall = computer.wall();
    computer.host += Duration{static_cast<std::int64_t>(random() % 3'000'000)};
    clock.on_pair({before, wall, computer.host});
    const auto at = clock.arrival(stamp, empty_at);
    ASSERT_TRUE(at) << i;
    if (i > 100) {
      EXPECT_LT(std::chrono::abs(*at - came), 1ms) << "the narrowest pair so far counts";
    }
    empty_at = before;
  }
}

}  // namespace peerd::net::arrival_clock_test
