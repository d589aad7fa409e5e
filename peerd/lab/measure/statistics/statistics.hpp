#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace peerd::measure {

// Statistics of a set of samples with equal weights. All are zero for an empty set, because JSON has no NaN; `count`
// distinguishes it.
struct Statistics {
  std::size_t count = 0;
  double mean = 0.0;
  double rms = 0.0;
  double p99 = 0.0;  // nearest rank: the least sample that at least 99 % of the samples do not exceed
  double max = 0.0;
  bool p99_exact = true;  // false: within RunningStatistics::kP99Error
};

[[nodiscard]] Statistics statistics(std::vector<double> samples);

struct TimedValue {
  double t_s = 0.0;
  double value = 0.0;
};

// The time integral by the trapezoid rule from the first sample to the last; 0 for fewer than two. Times must not
// decrease.
[[nodiscard]] double integral(std::span<const TimedValue> samples);

}  // namespace peerd::measure
