#include "peerd/lab/measure/statistics/statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd::measure {

Statistics statistics(std::vector<double> samples) {
  Statistics s{.count = samples.size()};
  if (samples.empty()) return s;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  s.max = samples.front();
  for (const double x : samples) {
    sum += x;
    sum_of_squares += x * x;
    s.max = std::max(s.max, x);
  }
  const auto n = static_cast<double>(samples.size());
  s.mean = sum / n;
  s.rms = std::sqrt(sum_of_squares / n);
  const std::size_t rank = (99 * samples.size() + 99) / 100;  // ceil(0.99 n) in integers: 100 samples give the 99th
  const auto nth = samples.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::ranges::nth_element(samples, nth);
  s.p99 = *nth;
  return s;
}

double integral(std::span<const TimedValue> samples) {
  double area = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    assert(samples[i].t_s >= samples[i - 1].t_s);
    area += (samples[i].t_s - samples[i - 1].t_s) * 0.5 * (samples[i].value + samples[i - 1].value);
  }
  return area;
}

}  // namespace peerd::measure
