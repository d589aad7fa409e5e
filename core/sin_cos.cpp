#include "core/sin_cos.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace peerd {
namespace {

// Of the two Taylor series in x^2: (-1)^k / (2k + 1)! and (-1)^k / (2k)!, from the last k on. Up to pi/4 the first
// terms left out are below 3e-18.
constexpr auto kTerms = [] {
  constexpr int kLast = 8;
  std::array<std::array<double, 2>, kLast + 1> terms{};
  double factorial = 1.0;  // of 2k: whole, and below 2^53
  for (int k = 0; k <= kLast; ++k) {
    if (k > 0) factorial *= (2 * k - 1) * (2 * k);
    const double sign = k % 2 == 0 ? 1.0 : -1.0;
    terms[static_cast<std::size_t>(kLast - k)] = {sign / (factorial * (2 * k + 1)), sign / factorial};
  }
  return terms;
}();

}  // namespace

SincCos sinc_cos(double x2) {
  using Lanes [[gnu::vector_size(16)]] = double;  // both by Horner's rule at once
  Lanes sum{};
#pragma GCC unroll 9
  for (const auto& [sinc, cos] : kTerms) sum = sum * x2 + Lanes{sinc, cos};
  return {sum[0], sum[1]};
}

SinCos sin_cos(double x) {
  const auto small = [](double y) {
    const auto [sinc, cos] = sinc_cos(y * y);
    return SinCos{y * sinc, cos};
  };
  if (std::abs(x) <= std::numbers::pi / 4.0) return small(x);  // it would stay, but for -0
  constexpr double kHalfPi = std::numbers::pi / 2.0;
  constexpr double kHalfPiRest = 6.123233995736766e-17;  // pi/2 - kHalfPi
  // Of what is smaller the remainder is x itself.
  if (!(std::abs(x) <= std::numbers::pi)) x = std::remainder(x, 2.0 * std::numbers::pi);
  const double quarter = std::nearbyint(x / kHalfPi);  // -2 .. 2
  const auto [s, c] = small((x - quarter * kHalfPi) - quarter * kHalfPiRest);
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
