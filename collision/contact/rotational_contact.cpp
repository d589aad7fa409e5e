#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "collision/contact/contact_polygon.hpp"
#include "collision/contact/convex_contact.hpp"
#include "collision/exact/quadratic.hpp"

namespace peerd::collision {
namespace {

// Both bodies at one instant, in the world frame.
struct Instant {
  Mat3 R_a, R_b;
  Vec3 p, v, half_acceleration;  // of the collider relative to the collidee
  Vec3 w_a, w_b;                 // [rad/s], world
};
Instant instant_at(const PairQuery& query, double t) {
  const KinematicState a = advance(query.collider_motion, t), b = advance(query.collidee_motion, t);
  Instant now{a.orientation.toRotationMatrix(), b.orientation.toRotationMatrix(), {}, {}, {}, {}, {}};
  now.p = a.position - b.position;
  now.v = a.velocity - b.velocity;
  now.half_acceleration = 0.5 * (a.acceleration - b.acceleration);
  now.w_a = rotate(now.R_a, a.angular_velocity_body);
  now.w_b = rotate(now.R_b, b.angular_velocity_body);
  return now;
}

double largest_radius(const Solid& solid) {
  double radius2 = 0.0;
  for (const Vec3& v : solid.vertices) radius2 = std::max(radius2, dot(v, v));
  return std::sqrt(radius2);
}

// Bounds of how fast rotation changes the vertices' distances along any direction [m/s], and of the change of that rate
// [m/s^2].
struct RotationBounds {
  double speed, curvature;
};

// Lower bound of the gap along the fixed direction n, s seconds on: each vertex moves along n by its present rate, less
// at most half the centripetal acceleration |w|^2 r times s^2. F(s) = min over collider vertices - max over collidee
// vertices + k s^2 with k <= 0, hence concave: F(s) >= 0 means F >= 0 all the way to s.
class LowerBound {
 public:
  LowerBound(const PairQuery& query, const Instant& now, const RotationBounds& turning, const Vec3& n)
      : a_(query.collider.vertices),
        b_(query.collidee.vertices),
        n_a_(rotate_back(now.R_a, n)),
        n_b_(rotate_back(now.R_b, n)),
        turn_a_(rotate_back(now.R_a, n.cross(now.w_a))),  // n . (w x r) = (n x w) . r
        turn_b_(rotate_back(now.R_b, n.cross(now.w_b))),
        offset_(dot(n, now.p)),
        rate_(dot(n, now.v)),
        k_(std::min(0.0, dot(n, now.half_acceleration) - 0.5 * turning.curvature)) {
    assert(!a_.empty() && !b_.empty());
    assert(k_ <= 0.0);  // the bound is concave
  }

  // The constraint that binds after s seconds, as the quadratic of its two vertices.
  [[nodiscard]] Quadratic binding(double s) const {
    Quadratic q{offset_, rate_, k_};
    double least = kNever, most = -kNever;
    Quadratic at_a, at_b;
    for (const Vec3& x : a_) {
      const Quadratic f{dot(n_a_, x), dot(turn_a_, x), 0.0};
      if (const double value = f.at(s); value < least || (value == least && f.c1 < at_a.c1)) {
        least = value;
        at_a = f;
      }
    }
    for (const Vec3& x : b_) {
      const Quadratic f{dot(n_b_, x), dot(turn_b_, x), 0.0};
      if (const double value = f.at(s); value > most || (value == most && f.c1 > at_b.c1)) {
        most = value;
        at_b = f;
      }
    }
    assert(q.c2 <= 0.0);
    q.c0 += at_a.c0 - at_b.c0;
    q.c1 += at_a.c1 - at_b.c1;
    return q;
  }

  // The longest s <= limit for which the bound, raised by `lift` [m], stays >= 0.
  [[nodiscard]] double step(double limit, double lift) const {
    double s = limit;
    while (s > 0.0) {
      Quadratic q = binding(s);
      q.c0 = std::max(0.0, q.c0 + lift);
      double root = q.c1 > 0.0 && q.c2 < 0.0 ? -q.c1 / q.c2 : q.c1 > 0.0 ? kNever : 0.0;
      if (q.c0 > 0.0) root = first_descent(q);
      if (!(root < s)) break;
      s = root;
    }
    return s;
  }

  // The rate of the gap from now on: of its touching vertices, those within e of the support.
  [[nodiscard]] double rate(double e) const {
    const double low = extent_along(n_a_, a_).low, high = extent_along(n_b_, b_).high;
    double least = kNever, most = -kNever;
    for (const Vec3& x : a_) {
      if (dot(n_a_, x) <= low + e) least = std::min(least, dot(turn_a_, x));
    }
    for (const Vec3& x : b_) {
      if (dot(n_b_, x) >= high - e) most = std::max(most, dot(turn_b_, x));
    }
    return rate_ + least - most;
  }
  [[nodiscard]] double curvature() const { return k_; }

 private:
  std::span<const Vec3> a_, b_;
  Vec3 n_a_, n_b_, turn_a_, turn_b_;
  double offset_, rate_, k_;
};

struct Axis {
  Vec3 n = Vec3::Zero();
  double gap = -kNever;
};
Axis widest(const PairQuery& query, const Instant& now) {
  Axis best;
  for_each_gap(query.collider, now.R_a, query.collidee, now.R_b, now.p, [&](const Vec3& n, double gap) {
    if (gap > best.gap) best = {n, gap};
    return true;
  });
  return best;
}

// Far away the first-order bound reaches further: closing speed at most n.v + |w| r, exact for the acceleration.
double far_step(const Instant& now, const RotationBounds& turning, const Axis& axis) {
  return first_descent({axis.gap, dot(axis.n, now.v) - turning.speed, dot(axis.n, now.half_acceleration)});
}

// A summary of the axes whose gaps are within reach of touching.
struct Touch {
  double parting_step = 0.0;  // how long at least the bodies stay apart now, along the axis that parts
  Axis closing;               // the collidee's face if it is among those that close, else the widest
  double closing_rate = kNever;
};
Touch examine_touch(const PairQuery& query, const Instant& now, const RotationBounds& turning, const RoundingBound& e,
                    double window, double limit) {
  Touch touch;
  bool closing_is_face = false;
  const double still = e.speed_m_s + kRounding * turning.speed;
  for_each_gap(query.collider, now.R_a, query.collidee, now.R_b, now.p, [&](const Vec3& n, double gap) {
    if (gap < -window) return true;
    const LowerBound bound(query, now, turning, n);
    const double rate = bound.rate(e.gap_m), k = bound.curvature();
    if (rate > still) {
      // Rising rate^2 / 4|k|: less than the rounding bound, or back within a tick, is resting.
      if (rate * rate > -4.0 * k * e.gap_m && rate > -k * kClockTick_s) {
        touch.parting_step = std::max(touch.parting_step, bound.step(limit, std::max(0.0, -gap)));
      }
      return true;
    }
    const bool is_face = face_along(query.collidee, now.R_b, n) >= 0;
    if (touch.closing_rate == kNever || (is_face && !closing_is_face) ||
        (is_face == closing_is_face && gap > touch.closing.gap)) {
      touch.closing = {n, gap};
      touch.closing_rate = rate;
      closing_is_face = is_face;
    }
    return true;
  });
  return touch;
}

// The velocity of the collider's first support point along -n against the collidee's material at that place [m/s].
Vec3 approach_velocity(const PairQuery& query, const Instant& now, const Vec3& n) {
  const Vec3 n_a = rotate_back(now.R_a, n);
  const Vec3* lowest = query.collider.vertices.data();
  for (const Vec3& x : query.collider.vertices) {
    if (dot(n_a, x) < dot(n_a, *lowest)) lowest = &x;
  }
  const Vec3 r = rotate(now.R_a, *lowest);
  return now.v + now.w_a.cross(r) - now.w_b.cross(Vec3(r + now.p));
}

}  // namespace

Contact rotational_contact(const PairQuery& query, double radius_sum_m) {
  const RoundingBound e0 = rounding_bound(query, radius_sum_m);
  const double w_a = length(query.collider_motion.angular_velocity_body);
  const double w_b = length(query.collidee_motion.angular_velocity_body);
  const double r_a = largest_radius(query.collider), r_b = largest_radius(query.collidee);
  const RotationBounds turning{w_a * r_a + w_b * r_b, w_a * w_a * r_a + w_b * w_b * r_b};

  assert(query.horizon_s >= 0.0 && std::isfinite(query.horizon_s));
  assert(!(turning.speed < 0.0) && !(turning.curvature < 0.0));
  const double tolerance_m = advancement_tolerance_m(r_a, r_b);
  Contact contact;
  double t = 0.0;
  while (contact.iterations < kAdvancementCap) {
    ++contact.iterations;
    const Instant now = instant_at(query, t);
    const RoundingBound e{e0.at(t), e0.speed_m_s + 2.0 * t * e0.half_acceleration, e0.half_acceleration};
    const double left = query.horizon_s - t;
    const Axis axis = widest(query, now);
    if (axis.gap > tolerance_m) {
      const LowerBound bound(query, now, turning, axis.n);
      const double step = std::max(far_step(now, turning, axis), bound.step(2.0 * left, 0.0));
      assert(!(step < 0.0));
      if (step > left) return contact;
      t += step;
      continue;
    }
    const double window = e.gap_m + kClockTick_s * (length(now.v) + turning.speed);
    const Touch touch = examine_touch(query, now, turning, e, window, 2.0 * left);
    if (axis.gap >= -window && touch.parting_step > 0.0) {
      // Half way is where a bound without a gap stands highest.
      const double step = 0.5 * touch.parting_step;
      if (step >= left) return contact;
      t += step;
      continue;
    }
    const bool overlapped = t == 0.0 && axis.gap < -window;
    const Vec3 n = overlapped || touch.closing_rate == kNever ? axis.n : touch.closing.n;
    assert(t >= 0.0 && t <= query.horizon_s * (1.0 + 0x1p-50));
    contact.state = overlapped ? ContactState::kOverlapped : ContactState::kContact;
    contact.time_s = t;
    contact.resting = !overlapped && t == 0.0 && touch.closing_rate >= -(e.speed_m_s + kRounding * turning.speed);
    set_contact_polygon(contact, query.collidee, now.R_b, n, approach_velocity(query, now, n), e.gap_m);
    if (overlapped) contact.normal_world = contact.separating_normal_world = n;
    return contact;
  }
  contact.state = ContactState::kFailed;
  contact.time_s = t;
  return contact;
}

}  // namespace peerd::collision
