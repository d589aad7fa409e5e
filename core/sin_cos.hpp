#pragma once

namespace peerd {

struct SinCos {
  double sin = 0.0;
  double cos = 1.0;
};

// Sine and cosine of x [rad] by operations that IEEE 754 defines to the last bit: + - * /, remainder, rounding. The C
// library's may differ in the last place from one version to the next, and peers would not agree on where things touch.
// Error below 1e-15 for |x| <= 2 pi; it grows by 2.5e-16 with each further turn.
[[nodiscard]] SinCos sin_cos(double x);

// sin(x)/x and cos(x) for 0 <= x^2 <= (pi/4)^2, by the same operations: a rotation by a vector needs no root of its
// square.
struct SincCos {
  double sinc = 1.0;
  double cos = 1.0;
};
inline constexpr double kSincCosMax = 0.616850275068084914;  // (pi/4)^2
[[nodiscard]] SincCos sinc_cos(double x2);

}  // namespace peerd
