#include "core/math.hpp"

#include <cmath>

#include "core/sin_cos.hpp"

namespace peerd {

// The result has length 1 but for some roundings: callers that turn something by it normalise the product.
Quat quat_exp(const Vec3& rotation_rad) {
  const double half2 = 0.25 * rotation_rad.squaredNorm();
  if (half2 <= kSincCosMax) {
    const auto [sinc, cos] = sinc_cos(half2);
    const Vec3 v = (0.5 * sinc) * rotation_rad;
    return Quat(cos, v.x(), v.y(), v.z());
  }
  const double half = std::sqrt(half2);
  const auto [sin, cos] = sin_cos(half);
  const Vec3 v = (0.5 * sin / half) * rotation_rad;
  return Quat(cos, v.x(), v.y(), v.z());
}

double angle_between(const Quat& a, const Quat& b) {
  const Quat d = a.conjugate() * b;
  return 2.0 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

}  // namespace peerd
