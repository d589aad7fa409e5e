#include "collision/contact/convex_contact.hpp"

namespace peerd::collision {

RoundingBound rounding_bound(const PairQuery& query, double radius_sum_m) {
  const KinematicState &a = query.collider_motion, &b = query.collidee_motion;
  return {kRounding * (sum_of_magnitudes(a.position, b.position) + radius_sum_m),
          kRounding * sum_of_magnitudes(a.velocity, b.velocity),
          kRounding * 0.5 * sum_of_magnitudes(a.acceleration, b.acceleration)};
}

}  // namespace peerd::collision
