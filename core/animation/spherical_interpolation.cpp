#include "core/animation/spherical_interpolation.hpp"

#include <cmath>

#include "core/atan2.hpp"
#include "core/sin_cos.hpp"
#include "core/transform.hpp"

namespace peerd::animation {
namespace {

// The largest w of a half turn whose ends have angles in binary32: 2^-23 is half the distance of two such angles near
// pi.
constexpr double kHalfTurn = 0x1p-23;

double dot(const Vec3& a, const Vec3& b) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; }
double length(const Vec3& v) { return std::sqrt(dot(v, v)); }

}  // namespace

Quat quat_from_axis_angle(const Vec3& axis, double angle_rad) {
  const double norm = length(axis);
  if (norm == 0.0 || angle_rad == 0.0) return Quat::Identity();
  const auto [s, c] = sin_cos(0.5 * angle_rad);
  return {c, s * (axis[0] / norm), s * (axis[1] / norm), s * (axis[2] / norm)};
}

Vec3 rotation_between(const Quat& a, const Quat& b) {
  const Quat d = multiply(Quat(a.w(), -a.x(), -a.y(), -a.z()), b);
  const Vec3 v(d.x(), d.y(), d.z());
  const double sine = length(v);
  if (sine == 0.0) return Vec3::Zero();
  const bool backwards = d.w() < -kHalfTurn;
  const double angle = 2.0 * peerd::atan2(sine, backwards ? -d.w() : d.w());
  return (backwards ? -angle / sine : angle / sine) * v;
}

Quat rotated_in_body_frame(const Quat& a, const Vec3& r) {
  const double angle = length(r);
  if (angle == 0.0) return a;
  const auto [s, c] = sin_cos(0.5 * angle);
  const double k = s / angle;
  return normalized(multiply(a, Quat(c, k * r[0], k * r[1], k * r[2])));
}

Vec3 slerp(const Vec3& p, const Vec3& q, double fraction) {
  const double lp = length(p);
  const double lq = length(q);
  if (lp == 0.0 || lq == 0.0) return p + fraction * (q - p);
  const Vec3 u = p / lp;
  const Vec3 v = q / lq;
  const double cosine = dot(u, v);
  Vec3 side = v - cosine * u;  // across u, towards v
  double sine = length(side);
  if (sine < 1e-12 && cosine < 0.0) {
    int least = 0;
    for (int i = 1; i < 3; ++i) {
      if (std::abs(u[i]) < std::abs(u[least])) least = i;
    }
    side = Vec3::Unit(least) - u[least] * u;
    side /= length(side);
    sine = 0.0;
  } else if (sine > 0.0) {
    side /= sine;
  }
  const auto [s, c] = sin_cos(fraction * peerd::atan2(sine, cosine));
  return (lp + fraction * (lq - lp)) * (c * u + s * side);
}

}  // namespace peerd::animation
