#include "core/sin_cos.hpp"

#include <cmath>
#include <numbers>

namespace peerd {

SinCos sin_cos(double x) {
  const auto small = [](double y) {
    const auto [sinc, cos] = sinc_cos(y * y);
    return SinCos{y * sinc, cos};
  };
  if (std::abs(x) <= std::numbers::pi / 4.0) return small(x);  // it would stay, but for -0
  constexpr double kHalfPi = std::numbers::pi / 2.0;
  constexpr double kHalfPiRest = 6.123233995736766e-17;  // pi/2 - kHalfPi
  // A smaller number is its own remainder.
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
