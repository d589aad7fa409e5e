#include "core/sin_cos.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace peerd {
namespace {

// 1 / (n (n - 1)) for n = kLast, kLast - 2, ..: a product costs a fifth of a quotient.
template <int kLast>
constexpr auto kSteps = [] {
  std::array<double, kLast / 2> steps{};
  for (int i = 0, n = kLast; n > 1; ++i, n -= 2) steps[static_cast<std::size_t>(i)] = 1.0 / (n * (n - 1));
  return steps;
}();

// Taylor series by Horner's rule, |x| <= pi/4: the first term left out is below 1e-19.
SinCos sin_cos_small(double x) {
  const double x2 = x * x;
  double s = 1.0, c = 1.0;
  for (const double step : kSteps<17>) s = 1.0 - s * (x2 * step);
  for (const double step : kSteps<18>) c = 1.0 - c * (x2 * step);
  return {x * s, c};
}

}  // namespace

SinCos sin_cos(double x) {
  if (std::abs(x) <= std::numbers::pi / 4.0) return sin_cos_small(x);  // it would stay, but for -0
  constexpr double kHalfPi = std::numbers::pi / 2.0;
  constexpr double kHalfPiRest = 6.123233995736766e-17;  // pi/2 - kHalfPi
  // Of what is smaller the remainder is x itself.
  if (!(std::abs(x) <= std::numbers::pi)) x = std::remainder(x, 2.0 * std::numbers::pi);
  const double quarter = std::nearbyint(x / kHalfPi);  // -2 .. 2
  const auto [s, c] = sin_cos_small((x - quarter * kHalfPi) - quarter * kHalfPiRest);
  switch (static_cast<int>(quarter)) {
    case 1:
      return {c, -s};
    case -1:
      return {-c, s};
    case 2:
    case -2:
      return {-s, -c};
    default:
      return {s, c};
  }
}

}  // namespace peerd
