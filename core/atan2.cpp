#include "core/atan2.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace peerd {
namespace {

constexpr double kAtanSixteenths[17] = {
    // The table holds atan(i / 16), rounded to the nearest.
    0.0,
    0x1.ff55bb72cfdeap-5,
    0x1.fd5ba9aac2f6ep-4,
    0x1.7b97b4bce5b02p-3,
    0x1.f5b75f92c80ddp-3,
    0x1.362773707ebccp-2,
    0x1.6f61941e4def1p-2,
    0x1.a64eec3cc23fdp-2,
    0x1.dac670561bb4fp-2,
    0x1.0657e94db30d0p-1,
    0x1.1e00babdefeb4p-1,
    0x1.345f01cce37bbp-1,
    0x1.4978fa3269ee1p-1,
    0x1.5d58987169b18p-1,
    0x1.700a7c5784634p-1,
    0x1.819d0b7158a4dp-1,
    0x1.921fb54442d18p-1,
};

// Returns atan(r), 0 <= r <= 1: atan(c) + atan((r - c) / (1 + r c)) with c the nearest sixteenth. The second argument
// is at most 1/32, where the first term of the series that is left out is below 1e-20 of the sum.
double atan_unit(double r) {
  const double sixteenth = std::nearbyint(16.0 * r);
  const double c = sixteenth / 16.0;
  const double z = (r - c) / (1.0 + r * c);
  const double z2 = z * z;
  double tail = 0.0;
  for (int n = 11; n > 1; n -= 2) tail = z2 * (1.0 / n - tail);
  return kAtanSixteenths[static_cast<int>(sixteenth)] + (z - z * tail);
}

}  // namespace

double atan2(double y, double x) {
  constexpr double kHalfPiRest = 6.123233995736766e-17;  // pi/2 minus its binary64
  const double ay = std::abs(y);
  const double ax = std::abs(x);
  if (!(std::isfinite(ax) && std::isfinite(ay))) return std::numeric_limits<double>::quiet_NaN();
  double angle = 0.0;  // angle of (ax, ay), in [0, pi/2]
  if (ay <= ax) {
    angle = ax == 0.0 ? 0.0 : atan_unit(ay / ax);
  } else {
    angle = std::numbers::pi / 2.0 - (atan_unit(ax / ay) - kHalfPiRest);
  }
  if (std::signbit(x)) angle = std::numbers::pi - (angle - 2.0 * kHalfPiRest);
  return std::copysign(angle, y);
}

}  // namespace peerd
