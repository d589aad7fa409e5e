#pragma once
#include <cmath>
#include <utility>
#include <vector>

namespace peerd::bench {

// The exponent of y = c x^e through the points (x, y), by least squares of the logarithms.
[[nodiscard]] inline double fitted_exponent(const std::vector<std::pair<double, double>>& points) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [size, cost] : points) {
    const double lx = std::log(size), ly = std::log(cost);
    n += 1, x += lx, y += ly, xx += lx * lx, xy += lx * ly;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace peerd::bench
