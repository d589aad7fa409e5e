#include "peerd/lab/measure/statistics/interval.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace peerd::measure::interval_test {

// n numbers whose mean is 0 and whose standard deviation is 1: the half width is t / sqrt(n).
std::vector<double> standard(std::size_t n) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) values.push_back(i % 2 == 0 ? 1.0 : -1.0);
  const double scale = std::sqrt(static_cast<double>(n - 1) / static_cast<double>(n));
  for (double& x : values) x *= scale;
  return values;
}

struct Quantile {
  std::size_t n;  // even
  double t;       // for n - 1 degrees of freedom: NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2
};
TEST(Interval, IsStudents) {
  for (const auto& [n, t] : {Quantile{2, 12.706}, {4, 3.182}, {6, 2.571}, {10, 2.262}, {20, 2.093}, {30, 2.045}}) {
    const Interval i = interval_95(standard(n));
    EXPECT_NEAR(i.mean, 0.0, 1e-12) << n;
    EXPECT_NEAR(i.half_width * std::sqrt(static_cast<double>(n)), t, 5e-4) << n;
  }
}

TEST(Interval, OfOneOrNone) {
  EXPECT_EQ(interval_95(std::vector{3.0}).mean, 3.0);
  EXPECT_EQ(interval_95(std::vector{3.0}).half_width, 0.0);
  EXPECT_EQ(interval_95({}).mean, 0.0);
}

}  // namespace peerd::measure::interval_test
