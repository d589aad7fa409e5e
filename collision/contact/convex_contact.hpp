#pragma once
#include <limits>

#include "collision/contact/contact.hpp"
#include "collision/contact/separating_axis.hpp"

namespace peerd::collision {

inline constexpr double kNever = std::numeric_limits<double>::infinity();  // [s]

// One convex pair of a query. The answers are those of first_contact for this pair alone.
struct PairQuery {
  const Solid& collider;
  const Solid& collidee;
  const KinematicState& collider_motion;
  const KinematicState& collidee_motion;
  double horizon_s;
};

// What the rounding of a gap and of its rates is bounded by, after s seconds: at(s) [m].
struct RoundingBound {
  double gap_m;              // at time 0
  double speed_m_s;          // of the first derivative
  double half_acceleration;  // of the coefficient of t^2 [m/s^2]

  [[nodiscard]] double at(double s) const { return gap_m + s * (speed_m_s + s * half_acceleration); }
};
[[nodiscard]] RoundingBound rounding_bound(const PairQuery& query, double radius_sum_m);

// Both orientations constant: closed form.
[[nodiscard]] Contact translational_contact(const PairQuery& query, double radius_sum_m, const Mat3& R_world_collider,
                                            const Mat3& R_world_collidee);

// At least one body turns: conservative advancement.
[[nodiscard]] Contact rotational_contact(const PairQuery& query, double radius_sum_m);

}  // namespace peerd::collision
