#include "collision/exact/ray_triangle.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "collision/exact/triangle_touch.hpp"

namespace peerd::collision {
namespace {

using detail::Projection;

struct Orient2dSigns {
  OrientationCounters& counters;
  [[nodiscard]] int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j) const {
    return collision::orient2d(a, b, c, i, j, counters);
  }
};

int sign_of(double x) { return (x > 0.0) - (x < 0.0); }

// The index of a coordinate along which the direction has a component: that of the largest.
int axis_of(const Vec3& direction) {
  int axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  assert(axis >= 0 && axis < 3 && direction[axis] != 0.0);
  return axis;
}

// The side of a point on the ray's line: -1 behind the origin, 0 at it, 1 ahead.
int ahead(const Ray& ray, const Vec3& p, int axis) {
  return (p[axis] > ray.origin[axis] ? 1 : p[axis] < ray.origin[axis] ? -1 : 0) * sign_of(ray.direction[axis]);
}

std::optional<double> at_point(const Ray& ray, const Vec3& p, OrientationCounters& counters) {
  const int axis = axis_of(ray.direction);
  if (ahead(ray, p, axis) < 0) return std::nullopt;
  return point_parameter(p, ray.origin, ray.direction, axis, counters);
}

// A segment both of whose ends are on the ray's line.
std::optional<double> at_segment_along(const Ray& ray, const Vec3& p, const Vec3& q, OrientationCounters& counters) {
  const int axis = axis_of(ray.direction);
  const int side_p = ahead(ray, p, axis), side_q = ahead(ray, q, axis);
  if (side_p * side_q <= 0) return 0.0;
  if (side_p < 0) return std::nullopt;
  const bool p_first = (p[axis] < q[axis]) == (ray.direction[axis] > 0.0);
  return point_parameter(p_first ? p : q, ray.origin, ray.direction, axis, counters);
}

// A closed segment of a plane that the ray is in, too; its ends may be equal.
std::optional<double> at_segment(const Ray& ray, const Vec3& p, const Vec3& q, OrientationCounters& counters) {
  for (const auto& [i, j] : detail::kProjections) {
    const int side_p = orient2d_along(ray.origin, p, ray.direction, i, j, counters);
    const int side_q = orient2d_along(ray.origin, q, ray.direction, i, j, counters);
    if (side_p == 0 && side_q == 0) continue;
    // An end is off the ray's line, and so it is in this projection: which maps the plane one to one.
    if (side_p == 0) return at_point(ray, p, counters);
    if (side_q == 0) return at_point(ray, q, counters);
    if (side_p == side_q || orient2d(ray.origin, p, q, i, j, counters) * side_p < 0) return std::nullopt;
    return line_parameter(p, q, ray.origin, ray.direction, i, j, counters);
  }
  return at_segment_along(ray, p, q, counters);
}

// The ray is in the triangle's plane; or the triangle has no area, and where its ends are off the ray's line they are
// in a plane with it.
std::optional<double> in_plane(const Ray& ray, const Triangle& t, OrientationCounters& counters) {
  Orient2dSigns signs{counters};
  const Projection* const projection = detail::area_projection(t, signs);
  if (projection == nullptr) {
    const detail::Segment hull = detail::hull_of_collinear(t);
    return at_segment(ray, hull.p, hull.q, counters);
  }
  if (detail::contains(t, ray.origin, *projection, signs)) return 0.0;
  std::optional<double> first;
  for (std::size_t e = 0; e < 3; ++e) {
    const auto at = at_segment(ray, t[e], t[(e + 1) % 3], counters);
    if (at && (!first || *at < *first)) first = at;
  }
  return first;
}

}  // namespace

bool is_usable(const Ray& ray) {
  for (int k = 0; k < 3; ++k) {  // not one comparison holds for what is no number
    if (!(std::abs(ray.origin[k]) <= 0x1p130 && std::abs(ray.direction[k]) <= 0x1p500)) return false;
  }
  return ray.direction.cwiseAbs().maxCoeff() >= 0x1p-500 && ray.longest >= 0.0;
}

// With x where the line meets the plane, A = a - x and so on, and x - o parallel to d,
//   |a - o, b - o, d| = |A, B, d|,
// and A x B is the normal times the signed area of xab. So the three volumes have the signs, up to a common one, of the
// areas of xab, xbc and xca, which sum up to that of abc.
std::optional<double> first_parameter(const Ray& ray, const Triangle& t, OrientationCounters& counters) {
  const Vec3 &o = ray.origin, &d = ray.direction;
  int least = 1, most = -1;
  for (std::size_t e = 0; e < 3; ++e) {
    const int side = volume_sign_along(o, t[e], t[(e + 1) % 3], d, counters);
    least = std::min(least, side);
    most = std::max(most, side);
    // A triangle without an area, or one in whose plane the ray is, has no two signs; one along whose plane, but off
    // it, the ray goes may have, and isn't met.
    if (least < 0 && most > 0) return std::nullopt;
  }
  const int facing = volume_sign_along(t[0], t[1], t[2], d, counters);
  const int side = volume_sign(t[0], t[1], t[2], o, counters);
  if (facing == 0) return side == 0 ? in_plane(ray, t, counters) : std::nullopt;
  if (side == 0) return 0.0;
  if (side == facing) return std::nullopt;  // it goes away from the plane
  return plane_parameter(t[0], t[1], t[2], o, d, counters);
}

}  // namespace peerd::collision
