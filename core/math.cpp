#include "core/math.hpp"

#include <cmath>

namespace peerd {

Quat quat_exp(const Vec3& rotation_rad) {
  const double angle2 = rotation_rad.squaredNorm();
  // sin(a/2)/a = 1/2 - a^2/48 + ..; the next term, a^4/3840, is below one ulp of 1/2 for a^2 < 1e-6.
  const double angle = std::sqrt(angle2);
  const double scale = angle2 < 1e-6 ? 0.5 - angle2 / 48.0 : std::sin(0.5 * angle) / angle;
  const double w = angle2 < 1e-6 ? 1.0 - angle2 / 8.0 : std::cos(0.5 * angle);
  const Vec3 v = scale * rotation_rad;
  return Quat(w, v.x(), v.y(), v.z()).normalized();
}

double angle_between(const Quat& a, const Quat& b) {
  const Quat d = a.conjugate() * b;
  return 2.0 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

}  // namespace peerd
