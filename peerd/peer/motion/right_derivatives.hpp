#pragma once
#include <cmath>
#include <limits>

namespace peerd::motion {

// Value, first and second right-hand derivative of f at t.
struct RightDerivatives {
  double value = 0.0, first = 0.0, second = 0.0;
};

// Takes forward differences over ever shorter steps. The step that agrees best with the one before it wins (after C. J.
// F. Ridders, "Accurate computation of F'(x) and F'(x)F''(x)", 1982), so that a step ends before a corner shortly after
// t. The five-point stencils have errors of h^4 f5/5 and 5 h^3 f5/6, against rounding of about 6 |f| eps / h and 30 |f|
// eps / h^2. They take differences from f(t), so that the derivatives of what does not change are zero.
template <class F>
[[nodiscard]] RightDerivatives right_derivatives(const F& f, double t) {
  constexpr double kLongestStep_s = 1.0 / 128.0;
  constexpr int kSteps = 14;  // down to a microsecond, where rounding costs 0.5 m/s^2 at 100 m
  RightDerivatives best, last;
  best.value = f(t);
  double best_change = std::numeric_limits<double>::infinity();
  double h = kLongestStep_s;
  double f4 = f(t + 4.0 * h), f2 = f(t + 2.0 * h);
  for (int step = 0; step < kSteps; ++step, h *= 0.5) {
    const double f1 = f(t + h), f3 = f(t + 3.0 * h);
    const double d1 = f1 - best.value, d2 = f2 - best.value, d3 = f3 - best.value, d4 = f4 - best.value;
    const double first = (48.0 * d1 - 36.0 * d2 + 16.0 * d3 - 3.0 * d4) / (12.0 * h);
    const double second = (-104.0 * d1 + 114.0 * d2 - 56.0 * d3 + 11.0 * d4) / (12.0 * h * h);
    const double change = step == 0 ? best_change : std::abs(second - last.second) + std::abs(first - last.first);
    if (step == 0 || change < best_change) {
      best_change = change;
      best.first = first;
      best.second = second;
    }
    if (change == 0.0) break;
    last.first = first;
    last.second = second;
    f4 = f2;
    f2 = f1;
  }
  return best;
}

}  // namespace peerd::motion
