// Session time on hosts whose clocks drift, jump and stop: how far each peer is from the one it follows, and whether it
// says so. The oracle (clock_lab.hpp) looks at every call of every peer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/sim/clock_lab.hpp"

namespace peerd::sim::clock_test {

using namespace std::chrono_literals;
using testing::IsEmpty;
using testing_support::ClockLab;

double ms(Duration d) { return to_seconds(d) * 1e3; }

struct Figures {
  Duration p99{0}, worst{0};
  double bound_over_error = 0.0;  // median over samples: how loose the bound is
  Duration bound_median{0};
  std::size_t samples = 0;
};

// Samples since `from` whose peer has followed the same leader for `settled`.
Figures figures(const ClockLab& lab, Duration from, Duration settled = 0s) {
  std::vector<Duration> errors, bounds;
  std::vector<double> ratios;
  for (const ClockLab::Sample& s : lab.samples()) {
    if (s.at < from || s.followed_for < settled) continue;
    errors.push_back(std::chrono::abs(s.error));
    bounds.push_back(s.bound);
    ratios.push_back(to_seconds(s.bound) / std::max(1e-9, to_seconds(errors.back())));
  }
  if (errors.empty()) return {};
  std::ranges::sort(errors);
  std::ranges::sort(bounds);
  std::ranges::sort(ratios);
  return {errors[(errors.size() * 99 + 99) / 100 - 1], errors.back(), ratios[ratios.size() / 2],
          bounds[bounds.size() / 2], errors.size()};
}

// The time from which on all errors are at most `aim`.
Duration recovered(const ClockLab& lab, Duration from, Duration aim) {
  Duration last = from;
  for (const ClockLab::Sample& s : lab.samples()) {
    if (s.at >= from && std::chrono::abs(s.error) > aim) last = s.at;
  }
  return last - from;
}

void print(const std::string& what, const Figures& f) {
  std::printf("%-44s error p99 %8.3f ms, worst %8.3f ms; bound (median) %8.3f ms, bound/error (median) %7.1f; %zu\n",
              what.c_str(), ms(f.p99), ms(f.worst), ms(f.bound_median), f.bound_over_error, f.samples);
}

// ---- symmetric delays ----

struct Delay {
  const char* name;
  double latency_ms, jitter_part, loss, reordering;
};
class SymmetricDelay : public testing::TestWithParam<Delay> {};

TEST_P(SymmetricDelay, IsWithinTheTargetAndAlwaysWithinTheBound) {
  const Delay& d = GetParam();
  const double jitter_ms = d.latency_ms * d.jitter_part;
  const Duration target = from_seconds(1e-3 * (1.0 + jitter_ms / 4.0));
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::vector<ClockLab::HostSettings> hosts(2 + random() % 7);
    for (auto& h : hosts) {
      h.ahead = Duration(static_cast<std::int64_t>(random() % 20'000'000'000) - 10'000'000'000);
      h.drift_ppm = static_cast<int>(random() % 1001) - 500;
    }
    hosts[0].drift_ppm = seed % 2 == 0 ? 500 : -500;
    hosts[1].drift_ppm = -hosts[0].drift_ppm;  // the most that two differ by
    ClockLab lab({d.latency_ms, jitter_ms, d.loss, 0.0, d.reordering}, hosts, seed);
    lab.run_until(60s);
    EXPECT_THAT(lab.findings(), IsEmpty());
    const Figures f = figures(lab, 20s, 10s);
    print(std::string(d.name) + ", " + std::to_string(hosts.size()) + " peers", f);
    EXPECT_LE(f.p99, target);
    EXPECT_GT(f.samples, 1000u);
  }
}
INSTANTIATE_TEST_SUITE_P(Table, SymmetricDelay,
                         testing::Values(Delay{"None", 0, 0, 0, 0}, Delay{"Lan", 1, 0.5, 0, 0},
                                         Delay{"LanLosing20", 1, 0.5, 0.2, 0}, Delay{"Steady100", 100, 0, 0, 0},
                                         Delay{"Jitter100", 100, 0.5, 0, 0}, Delay{"Jitter100Loss5", 100, 0.1, 0.05, 0},
                                         Delay{"Reordered200", 200, 0.1, 0, 0.25}, Delay{"Steady500", 500, 0, 0, 0},
                                         Delay{"Jitter500", 500, 0.5, 0, 0}, Delay{"Worst500", 500, 0.5, 0.2, 0.25}),
                         [](const auto& c) { return std::string(c.param.name); });

// ---- asymmetric delays ----

TEST(SessionTime, UnderAOneSidedDelayTheBoundCoversTheError) {
  for (const bool towards_leader : {false, true}) {
    ClockLab lab({1.0, 0.2, 0.0, 0.0, 0.0}, {{0s, 500}, {3s, -500}, {-2s, 100}}, 7);
    lab.set_link(towards_leader ? 1 : 0, towards_leader ? 0 : 1, {500.0, 0.0, 0.0, 0.0, 0.0});
    lab.run_until(60s);
    EXPECT_THAT(lab.findings(), IsEmpty());
    const Figures f = figures(lab, 30s);
    print("one-sided 500 ms", f);
    EXPECT_NEAR(ms(f.worst), 250.0, 3.0) << "no protocol that asks and is answered could know";
  }
}

// ---- clocks that jump, hosts that sleep ----

const config::LinkSettings kLan{5.0, 2.0, 0.02, 0.0, 0.0};
constexpr Duration kAim = 2ms;

void expect_recovered(const ClockLab& lab, Duration since, const char* name) {
  EXPECT_THAT(lab.findings(), IsEmpty());
  const Duration after = recovered(lab, since, kAim);
  std::printf("%s: %.2f s, steps %zu %zu %zu %zu\n", name, to_seconds(after), lab.steps(0), lab.steps(1), lab.steps(2),
              lab.steps(3));
  EXPECT_LT(after, 20s);
}

struct Jump {
  const char* name;
  std::size_t host;
  Duration by;
};
class JumpingClock : public testing::TestWithParam<Jump> {};

// HostClock does not jump when the wall clock is set; a virtual machine's may.
TEST_P(JumpingClock, EverybodyIsBackInStepAndNobodysTimeRunsBackwards) {
  ClockLab lab(kLan, {{0s, 500}, {3s, -500}, {-2s, 0}, {100s, 20}}, 3);
  lab.run_until(30s);
  lab.restart_silence_of_all(GetParam().host, 32s - std::min(Duration{0}, GetParam().by));
  if (GetParam().by > 0s) {
    lab.jump(GetParam().host, GetParam().by);
  } else {  // a clock whose past is set again waits for it (ForwardTime)
    lab.suspend(GetParam().host, false);
    lab.run_until(30s - GetParam().by);
    lab.wake(GetParam().host);
  }
  const Duration at = lab.now();
  lab.run_until(at + 60s);
  expect_recovered(lab, at, GetParam().name);
}
INSTANTIATE_TEST_SUITE_P(Table, JumpingClock,
                         testing::Values(Jump{"LeaderForward", 0, 10s}, Jump{"LeaderBack", 0, -10s},
                                         Jump{"FollowerForward", 2, 10s}, Jump{"FollowerBack", 2, -10s},
                                         Jump{"LeaderALittleForward", 0, 3s}, Jump{"FollowerALittleForward", 2, 3s},
                                         Jump{"LeaderALittleBack", 0, -1s}, Jump{"FollowerALittleBack", 2, -1s}),
                         [](const auto& c) { return std::string(c.param.name); });

struct Sleep {
  const char* name;
  std::size_t host;
  bool clock_runs;  // CLOCK_BOOTTIME on a computer that sleeps; else as a virtual machine that is paused
};
class SleepingHost : public testing::TestWithParam<Sleep> {};

TEST_P(SleepingHost, IsBackInStepAndNobodysTimeRunsBackwards) {
  ClockLab lab(kLan, {{0s, 500}, {3s, -500}, {-2s, 0}, {100s, 20}}, 4);
  lab.run_until(20s);
  if (!GetParam().clock_runs) lab.restart_silence_of_all(GetParam().host, 52s);
  lab.suspend(GetParam().host, GetParam().clock_runs);
  lab.run_until(50s);
  lab.wake(GetParam().host);
  lab.run_until(120s);
  expect_recovered(lab, 50s, GetParam().name);
}
INSTANTIATE_TEST_SUITE_P(Table, SleepingHost,
                         testing::Values(Sleep{"LeaderAsleep", 0, true}, Sleep{"LeaderPaused", 0, false},
                                         Sleep{"FollowerAsleep", 2, true}, Sleep{"FollowerPaused", 2, false}),
                         [](const auto& c) { return std::string(c.param.name); });

// Two peers whose session is later sleep, and wake where another session is, led by lower ids: the peers of that one
// step forward into theirs.
TEST(SessionTime, WhoWakesBesideAnEarlierSessionLeadsIt) {
  for (const Duration ahead : {3s, 100s}) {
    SCOPED_TRACE(ahead.count());
    ClockLab lab(kLan, {{0s, 100}, {0s, -100}, {ahead, 0}, {ahead, 50}}, 7);
    lab.part({2, 3});
    lab.run_until(20s);
    for (const std::size_t i : {2, 3}) lab.suspend(i, true);
    lab.run_until(30s);
    lab.part({});
    for (const std::size_t i : {2, 3}) lab.wake(i);
    lab.run_until(90s);
    EXPECT_THAT(lab.findings(), IsEmpty());
    EXPECT_LT(recovered(lab, 30s, 10ms), 20s);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(std::chrono::abs(lab.session_now(i) - lab.session_now(0)), 10ms) << i;
  }
}

TEST(SessionTime, OutlivesALeaderThatLeavesAndComesBack) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    ClockLab lab({50.0, 25.0, 0.05, 0.0, 0.0}, {{0s, 500}, {3s, -500}, {-2s, 0}, {1s, 250}}, seed);
    lab.run_until(20s);
    lab.leave(0);
    lab.run_until(40s);
    lab.start(0);
    lab.run_until(80s);
    EXPECT_THAT(lab.findings(), IsEmpty());
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(lab.steps(i), 0u);
    print("leader leaves at 20 s, is back at 40 s", figures(lab, 20s));
  }
}

TEST(SessionTime, SurvivesALeaderCutOffAndTwoSessionsThatMeet) {
  for (const std::vector<std::size_t>& side : {std::vector<std::size_t>{0}, {0, 2}, {3}}) {
    ClockLab lab({20.0, 10.0, 0.05, 0.0, 0.0}, {{0s, 500}, {3s, -500}, {-2s, 0}, {100s, 20}}, 5);
    lab.run_until(20s);
    lab.part(side);
    lab.run_until(80s);
    lab.part({});
    lab.run_until(140s);
    EXPECT_THAT(lab.findings(), IsEmpty());
    print("cut off for 60 s", figures(lab, 80s));
    // Two sessions exist from the start, minutes apart.
    ClockLab two({20.0, 10.0, 0.05, 0.0, 0.0}, {{0s, 500}, {3s, -500}, {-2s, 0}, {100s, 20}}, 6);
    two.part(side);
    two.run_until(20s);
    two.part({});
    two.run_until(60s);
    EXPECT_THAT(two.findings(), IsEmpty());
    std::printf("two sessions met: in step after %.2f s\n", to_seconds(recovered(two, 20s, 10ms)));
    EXPECT_LT(recovered(two, 20s, 10ms), 15s);
  }
}

// Peer 4 receives peer 2 alone, which follows peer 1.
TEST(SessionTime, OneThatFollowsAFollowerKnowsTheErrorOfBoth) {
  ClockLab lab(kLan, {{0s, 500}, {3s, -500}, {-2s, 0}, {1s, 500}}, 9);
  for (const std::size_t other : {0, 2}) {
    lab.set_link(other, 3, {5.0, 0.0, 1.0, 0.0, 0.0});
    lab.set_link(3, other, {5.0, 0.0, 1.0, 0.0, 0.0});
  }
  for (Duration t = 5s; t < 60s; t += 100ms) {
    lab.run_until(t);
    ASSERT_EQ(lab.peer(3).follows(), PeerId{2});
    const Duration error = lab.session_now(3) - lab.session_now(0);
    ASSERT_LE(std::chrono::abs(error), *lab.peer(3).clock().error_bound(lab.host_now(3)));
  }
  EXPECT_THAT(lab.findings(), IsEmpty());
}

// ---- the operating systems' clocks ----

TEST(SessionTime, GoodOsClocksSeeThroughAOneSidedDelay) {
  ClockLab lab({1.0, 0.2, 0.0, 0.0, 0.0}, {{0s, 500, 800us, 1ms}, {3s, -500, -900us, 2ms}, {-2s, 100}}, 7);
  lab.set_link(0, 1, {500.0, 0.0, 0.0, 0.0, 0.0});
  lab.run_until(60s);
  EXPECT_THAT(lab.findings(), IsEmpty());
  const Figures f = figures(lab, 58s);
  print("one-sided 500 ms, OS clocks 1 and 2 ms", f);
  for (const ClockLab::Sample& s : lab.samples()) {
    if (s.peer != 1 || s.at < 58s) continue;
    ASSERT_LE(std::chrono::abs(s.error), 3ms);
    ASSERT_LE(s.bound, 5500us)
        << "3 ms, 0.5 s under way, and to the next hello what it follows of 1 s of drift and may be wrong about";
  }
}

// One of the operating systems' clocks is an hour off and claims to be good: the peers believe the stamps.
TEST(SessionTime, AnOsClockThatContradictsTheStampsIsNotBelieved) {
  ClockLab lab(kLan, {{0s, 500, 0s, 1ms}, {3s, -500, 1h, 1ms}}, 7);
  lab.run_until(30s);
  EXPECT_THAT(lab.findings(), IsEmpty());
  EXPECT_GT(lab.peer(1).counters().os_clocks_doubted, 0u);
  const Figures f = figures(lab, 20s);
  EXPECT_LE(f.p99, kAim);
}

// Setting it moves no host's time and no session's.
TEST(SessionTime, AnOsClockThatIsSetChangesNothing) {
  for (const Duration by : {-10s, 10s}) {
    ClockLab lab(kLan, {{0s, 500, 0s, 1ms}, {3s, -500, 0s, 1ms}, {-2s, 0, 0s, 1ms}}, 7);
    lab.run_until(30s);
    lab.set_os_clock(1, by, 1ms);  // says nothing of it
    lab.run_until(40s);
    lab.set_os_clock(1, by, std::nullopt);
    lab.run_until(60s);
    EXPECT_THAT(lab.findings(), IsEmpty());
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(lab.steps(i), 0u);
    EXPECT_LE(figures(lab, 20s).p99, kAim);
  }
}

// Whatever the network and the hosts do, no peer's time runs backwards, and none is farther off than its bound.
class AnyTrouble : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, AnyTrouble, testing::Range<std::uint64_t>(1, 41), testing::PrintToStringParamName());

TEST_P(AnyTrouble, NeitherRunsBackNorExceedsTheBound) {
  std::mt19937_64 random(GetParam());
  const auto draw = [&](double most) { return most * static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<ClockLab::HostSettings> hosts(2 + random() % 7);
  for (auto& h : hosts) {
    h.ahead = from_seconds(draw(20.0) - 10.0);
    h.drift_ppm = static_cast<int>(random() % 1001) - 500;
    const Duration error = from_seconds(draw(0.02));
    if (random() % 2 == 0) h.os_bound = error + 1us;
    h.os_error = random() % 2 == 0 ? error : -error;
  }
  const auto link = [&] {
    const double latency_ms = draw(500.0);
    return config::LinkSettings{latency_ms, latency_ms * draw(0.5), draw(0.2), draw(0.1), draw(0.25)};
  };
  ClockLab lab(link(), hosts, GetParam());
  for (int i = 0; i < 3; ++i) lab.set_link(random() % hosts.size(), random() % hosts.size(), link());
  Duration now{0};
  const auto go_on = [&](double most_s) { lab.run_until(now += from_seconds(1.0 + draw(most_s))); };
  for (int event = 0; event < 6; ++event) {
    const std::size_t who = random() % hosts.size();
    go_on(15.0);
    switch (random() % 4) {
      case 0:
        lab.suspend(who, true);
        go_on(30.0);
        lab.wake(who);
        break;
      case 1:
        lab.leave(who);
        go_on(15.0);
        lab.start(who);
        break;
      case 2:
        lab.part({who});
        go_on(30.0);
        lab.part({});
        break;
      case 3:
        lab.set_os_clock(who, 10s, std::nullopt);
        break;
    }
  }
  go_on(30.0);
  EXPECT_THAT(lab.findings(), IsEmpty());
}

}  // namespace peerd::sim::clock_test
