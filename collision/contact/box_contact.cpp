#include "collision/contact/box_contact.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "collision/exact/ordered_sums.hpp"

namespace peerd::collision {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kStepsMax = 1u << 14;

// The signed gap along each axis; the side on which the collider is: +1 above, -1 below.
struct AxisGap {
  double gap_m;
  int side;
};
AxisGap gap_along(int axis, const WorldBox& a, const WorldBox& b) {
  const double above = a.lo[axis] - b.hi[axis], below = b.lo[axis] - a.hi[axis];
  return above >= below ? AxisGap{above, 1} : AxisGap{below, -1};
}

WorldBox box_at(std::span<const MovingBody> all, double s) {
  WorldBox box;
  for (const MovingBody& one : all) {
    const KinematicState state = advance(one.motion, s);
    box.merge(tight_box({one.body, state}));
  }
  return box;
}

// The most that any vertex moves along an axis in the direction `sign`, until the end [m/s].
double speed_along(int axis, int sign, std::span<const MovingBody> all, double s, double left_s) {
  double most = -kInfinite;
  for (const MovingBody& one : all) {
    const KinematicState& m = one.motion;
    const double turn = magnitude(m.angular_velocity_body) * one.body.extent_m();
    const double now = sign * (m.velocity[axis] + s * m.acceleration[axis]);
    most = std::max(most, now + std::max(0.0, sign * m.acceleration[axis] * left_s) + turn);
  }
  return most;
}

bool has_vertices(std::span<const MovingBody> all) {
  return std::ranges::any_of(all, [](const MovingBody& one) { return !one.body.vertices().empty(); });
}

}  // namespace

WorldBox tight_box(const MovingBody& m) {
  const Mat3 R = m.motion.orientation.toRotationMatrix();
  WorldBox box;
  for (const Vec3& v : m.body.vertices()) box.merge(Vec3(rotate(R, v) + m.motion.position));
  return box;
}

double box_gap_m(std::span<const MovingBody> a, std::span<const MovingBody> b) {
  if (!has_vertices(a) || !has_vertices(b)) return kInfinite;
  const WorldBox of_a = box_at(a, 0.0), of_b = box_at(b, 0.0);
  double greatest = -kInfinite;
  for (int axis = 0; axis < 3; ++axis) greatest = std::max(greatest, gap_along(axis, of_a, of_b).gap_m);
  return greatest;
}

Contact first_box_contact(std::span<const MovingBody> collider, std::span<const MovingBody> collidee, double horizon_s,
                          double margin_m) {
  assert(horizon_s >= 0.0 && margin_m >= 0.0);
  Contact contact;
  if (!has_vertices(collider) || !has_vertices(collidee)) return contact;
  contact.collidee_shape = collidee.front().body.object;
  const double near_m = margin_m + kAdvancementTolerance_m, least_m = margin_m + 0.5 * kAdvancementTolerance_m;
  for (double s = 0.0;; ++contact.iterations) {
    const WorldBox a = box_at(collider, s), b = box_at(collidee, s);
    double step_s = 0.0, greatest = -kInfinite;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [gap, side] = gap_along(axis, a, b);
      if (gap > greatest) {
        greatest = gap;
        contact.normal_world = contact.separating_normal_world = side * Vec3::Unit(axis);
      }
      if (gap <= near_m) continue;
      const double left_s = horizon_s - s;
      const double closing =
          speed_along(axis, -side, collider, s, left_s) + speed_along(axis, side, collidee, s, left_s);
      step_s = std::max(step_s, closing > 0.0 ? (gap - least_m) / closing : kInfinite);
    }
    if (greatest <= near_m) {
      contact.state = greatest < -near_m && s == 0.0 ? ContactState::kOverlapped : ContactState::kContact;
      contact.time_s = s;
      return contact;
    }
    if (!(s + step_s <= horizon_s)) return contact;
    s += step_s;
    if (contact.iterations == kStepsMax) {
      contact.state = ContactState::kFailed;
      contact.time_s = s;
      return contact;
    }
  }
}

double boxes_overlap_for_s(std::span<const MovingBody> a, std::span<const MovingBody> b, double horizon_s) {
  const WorldBox of_a = box_at(a, 0.0), of_b = box_at(b, 0.0);
  double least_s = horizon_s;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {1, -1}) {
      // How deep a's low side is below b's high side, or the other way round, and how fast the two may part.
      const double depth = side > 0 ? of_b.hi[axis] - of_a.lo[axis] : of_a.hi[axis] - of_b.lo[axis];
      if (!(depth > 0.0)) return 0.0;
      const double parting = speed_along(axis, side, a, 0.0, horizon_s) + speed_along(axis, -side, b, 0.0, horizon_s);
      if (parting > 0.0) least_s = std::min(least_s, depth / parting);
    }
  }
  return least_s;
}

}  // namespace peerd::collision
