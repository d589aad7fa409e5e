#pragma once
#include <span>

namespace peerd::measure {

// The mean of a number over runs that differ in their seed alone, and the half width of its 95 % confidence interval: t
// s / sqrt(n), where t is the 0.975 quantile of Student's distribution for n - 1 degrees of freedom (Student, The
// probable error of a mean, Biometrika 6, 1908). It is exact where the number is normally distributed. It is 0 for one
// value, which has no spread.
struct Interval {
  double mean = 0.0;
  double half_width = 0.0;
};
[[nodiscard]] Interval interval_95(std::span<const double> values);

}  // namespace peerd::measure
