#include "collision/triangle_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision/ordered_sums.hpp"

namespace peerd::collision {
namespace {

double clamped(double x) { return x > 0.0 ? std::min(x, 1.0) : 0.0; }  // what is no number becomes 0

// C. Ericson, Real-Time Collision Detection (2005), 5.1.9: closest points of segments.
void consider_edges(const Vec3& p, const Vec3& p_end, const Vec3& q, const Vec3& q_end, double& least, Vec3& on_a,
                    Vec3& on_b) {
  const Vec3 d = p_end - p, e = q_end - q, r = p - q;
  const double a = dot(d, d), c = dot(e, e), f = dot(e, r), b = dot(d, e), g = dot(d, r);
  double s = clamped((b * f - g * c) / (a * c - b * b));
  double t = (b * s + f) / c;
  if (!(t >= 0.0)) {
    t = 0.0;
    s = clamped(-g / a);
  } else if (t > 1.0) {
    t = 1.0;
    s = clamped((b - g) / a);
  }
  const Vec3 x = p + d * s, y = q + e * t, gap = y - x;
  const double square = dot(gap, gap);
  if (square < least) {
    least = square;
    on_a = x;
    on_b = y;
  }
}

// A point over the inside of a triangle; where it is nearest to an edge or a corner, the edges' pairs have it.
bool foot(const Triangle& t, const Vec3& p, Vec3& out) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0], w = p - t[0];
  const Vec3 n = u.cross(v);
  const double square = dot(n, n);
  const double y = dot(w.cross(v), n) / square, z = dot(u.cross(w), n) / square;
  if (!(y >= 0.0 && z >= 0.0 && y + z <= 1.0)) return false;
  out = t[0] + u * y + v * z;
  return true;
}

}  // namespace

TriangleDistance triangle_distance(const Triangle& a, const Triangle& b) {
  OrientationCounters ignored;
  if (touch(a, b, ignored)) return {0.0, a[0], a[0]};
  double least = std::numeric_limits<double>::infinity();
  TriangleDistance out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      consider_edges(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3], least, out.on_a, out.on_b);
    }
  }
  const auto consider_corner = [&](const Vec3& corner, const Triangle& of, bool corner_is_of_a) {
    Vec3 there;
    if (!foot(of, corner, there)) return;
    const Vec3 gap = there - corner;
    if (const double square = dot(gap, gap); square < least) {
      least = square;
      out.on_a = corner_is_of_a ? corner : there;
      out.on_b = corner_is_of_a ? there : corner;
    }
  };
  for (std::size_t i = 0; i < 3; ++i) {
    consider_corner(a[i], b, true);
    consider_corner(b[i], a, false);
  }
  out.distance = std::sqrt(least);
  return out;
}

}  // namespace peerd::collision
