#include "peerd/net/host_clock.hpp"

#include <time.h>

#include <cassert>

namespace peerd::net {
namespace {

Duration read_clock(clockid_t id) {
  timespec t{};
  [[maybe_unused]] const int failed = clock_gettime(id, &t);
  assert(!failed);  // both clocks exist on every Linux
  return std::chrono::seconds{t.tv_sec} + std::chrono::nanoseconds{t.tv_nsec};
}

// The midpoint halves what a badly timed preemption can cost.
Duration wall_minus_boot_time() {
  const Duration before = read_clock(CLOCK_BOOTTIME);
  const Duration wall = read_clock(CLOCK_REALTIME);
  const Duration after = read_clock(CLOCK_BOOTTIME);
  return wall - (before + (after - before) / 2);
}

}  // namespace

HostClock::HostClock(Duration test_offset) : epoch_minus_boot_time_(wall_minus_boot_time() + test_offset) {}

HostTime HostClock::now() const { return HostTime{epoch_minus_boot_time_ + read_clock(CLOCK_BOOTTIME)}; }

HostClock::Pair HostClock::pair_with_wall() const {
  const HostTime before = now();
  const Duration wall = read_clock(CLOCK_REALTIME);
  return {before, wall, now()};
}

Duration HostClock::minus_wall() const { return epoch_minus_boot_time_ - wall_minus_boot_time(); }

}  // namespace peerd::net
