#include "peerd/lab/chaos/skewed_clock.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::chaos {
namespace {

constexpr std::int64_t kMillion = 1'000'000;

}  // namespace

SkewedClock::SkewedClock(sim::VirtualTime now, HostTime begin, std::int64_t skew_ppm)
    : begin_(now), host_begin_(begin), skew_ppm_(skew_ppm) {
  assert(skew_ppm > -kMillion / 10 && skew_ppm < kMillion / 10);
}

HostTime SkewedClock::at(sim::VirtualTime t) const {
  assert(t >= begin_);
  const std::int64_t ns = (t - begin_).count();
  return host_begin_ + Duration{ns + ns / kMillion * skew_ppm_ + ns % kMillion * skew_ppm_ / kMillion};
}

sim::VirtualTime SkewedClock::when(HostTime host) const {
  if (host <= host_begin_) return begin_;
  const std::int64_t ns = (host - host_begin_).count();
  // The linear guess is wrong by a skew of the skew, and less than a nanosecond in a thousand by rounding.
  const std::int64_t rate = kMillion + skew_ppm_;
  sim::VirtualTime t = begin_ + Duration{ns / rate * kMillion + ns % rate * kMillion / rate};
  while (at(t) < host) t += Duration{1};
  while (t > begin_ && at(t - Duration{1}) >= host) t -= Duration{1};
  return t;
}

}  // namespace peerd::chaos
