#include "replication/settings/output/tick_grid.hpp"

namespace peerd::replication {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t floor_divide(std::int64_t a, std::int64_t b) { return a >= 0 ? a / b : (a - b + 1) / b; }

}  // namespace

std::int64_t TickGrid::number_at(SimTime t) const {
  const std::int64_t ns = t.time_since_epoch().count();
  const std::int64_t seconds = floor_divide(ns, kSecond_ns), rest_ns = ns - seconds * kSecond_ns;
  assert(rest_ns >= 0 && rest_ns < kSecond_ns);
  // The last k with time_of(k) <= t: time_of() rounds down, so a tick's own time must give the tick back.
  return seconds * hz_ + ((rest_ns + 1) * hz_ - 1) / kSecond_ns;
}

SimTime TickGrid::time_of(std::int64_t number) const {
  const std::int64_t hz = hz_, seconds = floor_divide(number, hz);
  return SimTime{std::chrono::seconds(seconds) + Duration{(number - seconds * hz) * kSecond_ns / hz}};
}

}  // namespace peerd::replication
