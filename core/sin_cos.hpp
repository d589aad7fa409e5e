#pragma once
#include <array>
#include <cstddef>

namespace peerd {

struct SinCos {
  double sin = 0.0;
  double cos = 1.0;
};

// Returns sine and cosine of x [rad] by operations that IEEE 754 defines to the last bit: + - * /, remainder, rounding.
// Those of the C library may differ in the last place from one version to the next, and peers would not agree on where
// things touch. The error is below 1e-15 for |x| <= 2 pi; it grows by 2.5e-16 with each further turn.
[[nodiscard]] SinCos sin_cos(double x);

// Returns sin(x)/x and cos(x) for 0 <= x^2 <= (pi/4)^2, by the same operations: a rotation by a vector needs no root of
// its square.
struct SincCos {
  double sinc = 1.0;
  double cos = 1.0;
};
inline constexpr double kSincCosMax = 0.616850275068084914;  // (pi/4)^2
[[nodiscard]] inline SincCos sinc_cos(double x2);

namespace detail {

// The coefficients of the two Taylor series in x^2: (-1)^k / (2k + 1)! and (-1)^k / (2k)!, from the last k on.
template <int kLast>
inline constexpr auto kSincCosTerms = [] {
  std::array<std::array<double, 2>, kLast + 1> terms{};
  double factorial = 1.0;  // (2k)!: whole, and below 2^53
  for (int k = 0; k <= kLast; ++k) {
    if (k > 0) factorial *= (2 * k - 1) * (2 * k);
    const double sign = k % 2 == 0 ? 1.0 : -1.0;
    terms[static_cast<std::size_t>(kLast - k)] = {sign / (factorial * (2 * k + 1)), sign / factorial};
  }
  return terms;
}();

template <int kLast>
[[gnu::always_inline]] inline SincCos sinc_cos_to(double x2) {
  using Lanes [[gnu::vector_size(16)]] = double;  // both by Horner's rule at once
  Lanes sum{};
#pragma GCC unroll 16
  for (const auto& [sinc, cos] : kSincCosTerms<kLast>) sum = sum * x2 + Lanes{sinc, cos};
  return {sum[0], sum[1]};
}

}  // namespace detail

// The first terms that are left out are below 2e-18 and, up to pi/4, 3e-18.
SincCos sinc_cos(double x2) { return x2 < 0.03 ? detail::sinc_cos_to<5>(x2) : detail::sinc_cos_to<8>(x2); }

}  // namespace peerd
