#pragma once
#include <cstdint>

#include "core/time.hpp"
#include "peerd/lab/sim/network.hpp"

namespace peerd::chaos {

// The clock of a simulated host, which runs too fast or too slow. It never runs backwards.
class SkewedClock {
 public:
  SkewedClock() = default;
  // The clock says `begin` at `now`; a skew of 100 ppm gains 100 us a second. |skew_ppm| < 100,000.
  SkewedClock(sim::VirtualTime now, HostTime begin, std::int64_t skew_ppm);

  [[nodiscard]] HostTime at(sim::VirtualTime t) const;
  // The first instant at which the clock says `host` or more.
  [[nodiscard]] sim::VirtualTime when(HostTime host) const;

 private:
  sim::VirtualTime begin_{};
  HostTime host_begin_{};
  std::int64_t skew_ppm_ = 0;
};

}  // namespace peerd::chaos
