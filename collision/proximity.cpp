#include "collision/proximity.hpp"

#include <cmath>
#include <limits>

#include "collision/ordered_sums.hpp"
#include "collision/quadratic.hpp"

namespace peerd::collision {
namespace {

Vec3 sphere_center(const MovingBody& m) {
  return m.motion.position + rotate(m.motion.orientation.toRotationMatrix(), m.body.center);
}

}  // namespace

double proximity_time_s(const MovingBody& p, const MovingBody& q) {
  const Vec3 d0 = sphere_center(q) - sphere_center(p);
  const Vec3 u = q.motion.velocity - p.motion.velocity;
  const double r = p.body.radius_m + q.body.radius_m;
  const Quadratic apart{dot(d0, d0) - r * r, 2.0 * dot(d0, u), dot(u, u)};
  if (apart.c0 <= 0.0) return 0.0;
  const double d = discriminant(apart);
  if (apart.c2 == 0.0 || d < 0.0) return std::numeric_limits<double>::infinity();
  // Apart now, so both roots lie on the same side of 0: the nearer one is the answer.
  const auto [first, second] = roots(apart, d);
  return first >= 0.0 ? first : -2.0 * second;
}

}  // namespace peerd::collision
