#pragma once
#include <span>

namespace peerd::report {

// What runs that differ in their seed alone say of a number: its mean over them, and how far the mean of ever more of
// them may lie from that, at 95 % confidence: t s / sqrt(n), t being the 0.975 quantile of Student's distribution for
// n - 1 degrees of freedom (Student, The probable error of a mean, Biometrika 6, 1908). Exact where the number is
// normally distributed. 0 for one value, which says nothing about it.
struct Interval {
  double mean = 0.0;
  double half_width = 0.0;
};
[[nodiscard]] Interval interval_95(std::span<const double> values);

}  // namespace peerd::report
