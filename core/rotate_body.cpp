#include "core/rotate_body.hpp"

#include <cmath>

namespace peerd {

Quat rotated_in_body_frame(const Quat& orientation, const Vec3& rotation_body_rad) {
  Quat q = orientation * quat_exp(rotation_body_rad);
  const double off = q.squaredNorm() - 1.0;
  if (std::abs(off) < 1e-8) {  // 1 / sqrt(1 + off) but for a term in off^2, less than any rounding
    q.coeffs() *= 1.0 - 0.5 * off;
  } else {
    q.normalize();
  }
  return q;
}

}  // namespace peerd
