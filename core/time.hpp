#pragma once
#include <chrono>
#include <cmath>
#include <cstdint>

namespace peerd {

using Duration = std::chrono::nanoseconds;

// SimClock is a chrono clock with no now(): time can only arrive as an argument. int64 nanoseconds last 292 years.
template <class Tag>
struct InjectedClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<InjectedClock>;
  static constexpr bool is_steady = true;
};

// A time of the clock of this computer; two hosts may differ by seconds.
using HostTime = InjectedClock<struct HostClockTag>::time_point;
// A time that all peers of a session agree on (replication/session/session_clock.hpp turns one into the other).
using SimTime = InjectedClock<struct SessionClockTag>::time_point;

[[nodiscard]] constexpr double to_seconds(Duration d) { return static_cast<double>(d.count()) / 1e9; }
[[nodiscard]] inline Duration from_seconds(double s) { return Duration{std::llround(s * 1e9)}; }

// The last multiple of `step` > 0 since the epoch that is not after t.
[[nodiscard]] constexpr SimTime floor_to(SimTime t, Duration step) {
  const std::int64_t ns = t.time_since_epoch().count(), n = step.count();
  return SimTime{Duration{(ns >= 0 ? ns / n : -((-ns + n - 1) / n)) * n}};
}

}  // namespace peerd
