#include "collision/contact/sphere_contact.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <vector>

#include "collision/contact/separating_axis.hpp"
#include "collision/exact/ordered_sums.hpp"

namespace peerd::collision {
namespace {

// Coefficients of 1, t, .. t^4.
using Quartic = std::array<double, 5>;

// Narrower than the rounding of its ends: 2^-52 of the horizon.
constexpr int kHalvings = 52;

// A polynomial over an interval of time, by its five Bernstein coefficients: it lies in their hull, and has the first
// and the last of them at the ends (G. Farin, "Curves and Surfaces for CAGD").
struct Segment {
  Quartic b;
  double lo;  // part of the horizon at which it begins, a multiple of a power of two
  int depth;  // its width is 2^-depth of the horizon
};

Quartic bernstein(const Quartic& c, double horizon_s) {
  Quartic p = c;
  double power = 1.0;
  for (double& x : p) {
    x *= power;
    power *= horizon_s;
  }
  return {p[0], p[0] + p[1] / 4.0, p[0] + p[1] / 2.0 + p[2] / 6.0, p[0] + 0.75 * p[1] + 0.5 * p[2] + p[3] / 4.0,
          p[0] + p[1] + p[2] + p[3] + p[4]};
}

// De Casteljau's algorithm gives the coefficients of both halves.
std::array<Quartic, 2> halves(Quartic b) {
  std::array<Quartic, 2> out;
  for (std::size_t row = 0; row < 5; ++row) {
    out[0][row] = b[0];
    out[1][4 - row] = b[4 - row];
    for (std::size_t i = 0; i + row < 4; ++i) b[i] = 0.5 * b[i] + 0.5 * b[i + 1];
  }
  return out;
}

// The first time in [0, horizon_s] at which the polynomial is not positive, or -1. A time so near to a root that
// rounding can't tell counts.
double first_not_positive(const Quartic& c, double horizon_s, std::uint32_t& iterations) {
  std::array<Segment, kHalvings + 1> later;  // of each depth at most one waits
  std::size_t waiting = 0;
  Segment s{bernstein(c, horizon_s), 0.0, 0};
  for (;;) {
    ++iterations;
    if (std::ranges::all_of(s.b, [](double x) { return x > 0.0; })) {
      if (waiting == 0) return -1.0;
      s = later[--waiting];
      continue;
    }
    assert(s.lo >= 0.0 && s.lo < 1.0);
    if (s.b[0] <= 0.0 || s.depth == kHalvings) return s.lo * horizon_s;
    const auto [first, second] = halves(s.b);
    assert(waiting < later.size() && s.depth < kHalvings);
    later[waiting++] = {second, s.lo + std::ldexp(1.0, -s.depth - 1), s.depth + 1};
    s = {first, s.lo, s.depth + 1};
  }
}

Vec3 center_of(const MovingBody& m) {
  return m.motion.position + rotate(m.motion.orientation.toRotationMatrix(), m.body.sphere->center);
}

// The motion of the collider's sphere as seen from the collidee's. Spheres that are outside of each other touch where
// their centres are as far apart as the sum of their radii; one inside the other touches it at the difference.
struct Approach {
  Vec3 apart, velocity, half_acceleration;  // of the collider's centre against the collidee's
  double touching_m;                        // distance of the centres at which they touch
  double side = 1.0;                        // 1: they are outside of each other; -1: one is inside the other
  // Bounds of the rounding of the distance, of its rate, and of half its second derivative.
  double gap_error_m, speed_error_m_s, bend_error_m_s2;

  Approach(const MovingBody& a, const MovingBody& b, MeetAs as)
      : apart(center_of(a) - center_of(b)),
        velocity(a.motion.velocity - b.motion.velocity),
        half_acceleration(0.5 * (a.motion.acceleration - b.motion.acceleration)),
        touching_m(a.body.sphere->radius_m + b.body.sphere->radius_m) {
    const auto magnitudes = [](const Vec3& p, const Vec3& q) { return magnitude(p) + magnitude(q); };
    const double speed = magnitudes(a.motion.velocity, b.motion.velocity);
    assert(touching_m >= 0.0);
    gap_error_m = kRounding * (magnitudes(a.motion.position, b.motion.position) + touching_m +
                               magnitudes(a.body.sphere->center, b.body.sphere->center));
    speed_error_m_s = kRounding * speed;
    const auto [smaller_m, larger_m] = std::minmax({a.body.sphere->radius_m, b.body.sphere->radius_m});
    if (as != MeetAs::kSolids && larger_m - smaller_m > gap_error_m && length(apart) < larger_m) {
      touching_m = larger_m - smaller_m;
      side = -1.0;
    }
    bend_error_m_s2 = kRounding * (0.5 * magnitudes(a.motion.acceleration, b.motion.acceleration) +
                                   speed * magnitude(velocity) / touching_m);
  }

  // The square of the distance less the square of the distance at touching, as a polynomial of time [m^2]; positive
  // while they are apart.
  [[nodiscard]] Quartic polynomial() const {
    const double d = length(apart);
    Quartic f = {(d - touching_m) * (d + touching_m), 2.0 * dot(apart, velocity),
                 dot(velocity, velocity) + 2.0 * dot(apart, half_acceleration), 2.0 * dot(velocity, half_acceleration),
                 dot(half_acceleration, half_acceleration)};
    for (double& x : f) x *= side;
    return f;
  }
  // The normal of a contact at that time, facing the collider.
  [[nodiscard]] Vec3 normal(double t) const {
    const Vec3 d = apart + t * (velocity + t * half_acceleration);
    const double size = length(d);
    return size > 0.0 ? Vec3(side * (d / size)) : Vec3(Vec3::UnitY());
  }
};

// The polynomial divided by time: without the root at 0 of a touch from which the spheres part or in which they stay.
Quartic without_root(const Quartic& c) { return {c[1], c[2], c[3], c[4], 0.0}; }

}  // namespace

bool meet_as_spheres(const MovingBody& a, const MovingBody& b) {
  const auto round = [](const MovingBody& m) {
    if (!m.body.sphere) return false;
    return m.body.sphere->center.isZero(0.0) || m.motion.angular_velocity_body.isZero(0.0);
  };
  return round(a) && round(b);
}

bool spheres_within(const MovingBody& a, const MovingBody& b, double distance_m, MeetAs as) {
  assert(a.body.sphere && b.body.sphere && distance_m >= 0.0);
  const Approach way(a, b, as);
  return way.side * (length(way.apart) - way.touching_m) <= distance_m;
}

Contact sphere_contact(const MovingBody& collider, const MovingBody& collidee, double horizon_s, MeetAs as) {
  assert(meet_as_spheres(collider, collidee) && horizon_s >= 0.0);
  const Approach way(collider, collidee, as);
  Quartic f = way.polynomial();
  Contact contact;
  contact.collidee_shape = collidee.body.sphere->shape;
  const auto finish = [&](ContactState state, double t) {
    contact.state = state;
    contact.time_s = t;
    contact.normal_world = contact.separating_normal_world = way.normal(t);
    return contact;
  };
  const double distance = length(way.apart), gap = way.side * (distance - way.touching_m);
  const Vec3 n = way.normal(0.0);
  double speed = dot(n, way.velocity);
  const bool touches = gap <= way.gap_error_m && gap >= -(way.gap_error_m + kClockTick_s * std::abs(speed));
  if (!touches && gap <= 0.0) return finish(ContactState::kOverlapped, 0.0);
  if (touches) {
    if (std::abs(speed) <= way.speed_error_m_s) speed = 0.0;
    // Half the distance's second derivative: what passes across comes apart, too.
    double bend = dot(n, way.half_acceleration) + way.side * 0.5 * (dot(way.velocity, way.velocity) - speed * speed) /
                                                      std::max(distance, way.touching_m);
    if (std::abs(bend) <= way.bend_error_m_s2) bend = 0.0;
    if (speed < 0.0) return finish(ContactState::kContact, 0.0);
    const bool too_low =
        bend < 0.0 && (speed * speed <= -4.0 * bend * way.gap_error_m || speed <= -bend * kClockTick_s);
    if (too_low) {
      contact.resting = true;
      return finish(ContactState::kContact, 0.0);
    }
    if (speed == 0.0 && bend == 0.0) return {};  // they stay as they are
    f = without_root(f);
    if (speed == 0.0) f = without_root(f);
  }
  const double t = first_not_positive(f, horizon_s, contact.iterations);
  assert(t <= horizon_s);
  return t < 0.0 ? Contact{} : finish(ContactState::kContact, t);
}

}  // namespace peerd::collision
