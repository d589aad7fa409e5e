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

}  // namespace peerd
