#pragma once
#include <limits>

#include "collision/contact/contact.hpp"
#include "collision/contact/separating_axis.hpp"

namespace peerd::collision {

inline constexpr double kNever = std::numeric_limits<double>::infinity();  // [s]

// Two convex pieces and their motion. The answers are those of first_contact() for this pair alone.
struct PairQuery {
  const Solid& collider;
  const Solid& collidee;
  const KinematicState& collider_motion;
  const KinematicState& collidee_motion;
  double horizon_s;
};

// Bounds of the rounding of a gap and of its rates; at(s) bounds that of the gap after s seconds [m].
struct RoundingBound {
  double gap_m;              // of the gap at time 0
  double speed_m_s;          // of the gap's first derivative
  double half_acceleration;  // of half the gap's second derivative [m/s^2]

  [[nodiscard]] double at(double s) const { return gap_m + s * (speed_m_s + s * half_acceleration); }
};
static_assert(std::numeric_limits<double>::is_iec559);  // the bounds are of IEEE operations
[[nodiscard]] RoundingBound rounding_bound(const PairQuery& query, double radius_sum_m);

// The contact of two pieces whose orientations are constant, in closed form.
[[nodiscard]] Contact translational_contact(const PairQuery& query, double radius_sum_m, const Mat3& R_world_collider,
                                            const Mat3& R_world_collidee);

// The contact of two pieces of which at least one turns, by conservative advancement.
[[nodiscard]] Contact rotational_contact(const PairQuery& query, double radius_sum_m);

}  // namespace peerd::collision
