#include "peerd/lab/measure/statistics/interval.hpp"

#include <cmath>

#include <boost/math/distributions/students_t.hpp>

namespace peerd::measure {

Interval interval_95(std::span<const double> values) {
  if (values.empty()) return {};
  const auto n = static_cast<double>(values.size());
  double sum = 0.0;
  for (const double x : values) sum += x;
  const double mean = sum / n;
  if (values.size() == 1) return {mean, 0.0};
  double squares = 0.0;
  for (const double x : values) squares += (x - mean) * (x - mean);
  const double t = boost::math::quantile(boost::math::students_t(n - 1.0), 0.975);
  return {mean, t * std::sqrt(squares / (n - 1.0) / n)};
}

}  // namespace peerd::measure
