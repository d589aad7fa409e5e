#pragma once
#include <chrono>
#include <cmath>
#include <cstdint>

namespace peerd {

using Duration = std::chrono::nanoseconds;

// A chrono clock with no now(): time can only arrive as an argument. int64 nanoseconds last 292 years.
template <class Tag>
struct ToldClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ToldClock>;
  static constexpr bool is_steady = true;
};

// What this computer's clock says; two hosts may differ by seconds.
using HostTime = ToldClock<struct HostClockTag>::time_point;
// What all peers of a session agree on (replication/session/session_clock.hpp turns one into the other).
using SimTime = ToldClock<struct SessionClockTag>::time_point;

[[nodiscard]] constexpr double to_seconds(Duration d) { return static_cast<double>(d.count()) / 1e9; }
[[nodiscard]] inline Duration from_seconds(double s) { return Duration{std::llround(s * 1e9)}; }

}  // namespace peerd
