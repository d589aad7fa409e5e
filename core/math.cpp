#include "core/math.hpp"

#include <cmath>

#include "core/sin_cos.hpp"

namespace peerd {

// Of length 1 but for some roundings: whoever turns something by it normalises the product.
Quat quat_exp(const Vec3& rotation_rad) {
  const double angle2 = rotation_rad.squaredNorm();
  if (angle2 < 1e-6) {  // the series' next terms are below 1e-21
    const Vec3 v = (0.5 - angle2 / 48.0 + angle2 * angle2 / 3840.0) * rotation_rad;
    return Quat(1.0 - angle2 / 8.0 + angle2 * angle2 / 384.0, v.x(), v.y(), v.z());
  }
  const double angle = std::sqrt(angle2);
  const auto [sin, cos] = sin_cos(0.5 * angle);
  const Vec3 v = (sin / angle) * rotation_rad;
  return Quat(cos, v.x(), v.y(), v.z());
}

double angle_between(const Quat& a, const Quat& b) {
  const Quat d = a.conjugate() * b;
  return 2.0 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

}  // namespace peerd
