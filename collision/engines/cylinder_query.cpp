#include "collision/engines/cylinder_query.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "collision/engines/visited_pairs.hpp"
#include "collision/engines/volume_tree.hpp"
#include "core/box.hpp"

namespace peerd::collision::engines {
namespace {

// The world's +Y in the frame of a pose.
Vec3 up_in(const Pose& pose) { return pose.orientation.toRotationMatrix().transpose() * Vec3::UnitY(); }

double cross_2d(const Vec3& p, const Vec3& q) { return p.x() * q.y() - p.y() * q.x(); }
double length_2d(const Vec3& p) { return std::hypot(p.x(), p.y()); }

// The distance of the origin from a segment, along x and y [m].
double distance_2d(const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const double squared = way.x() * way.x() + way.y() * way.y();
  const double along = squared > 0.0 ? -(from.x() * way.x() + from.y() * way.y()) / squared : 0.0;
  return length_2d(from + std::clamp(along, 0.0, 1.0) * way);
}

// Whether the origin is in the triangle, along x and y; on its border either answer will do.
bool is_inside_2d(const Triangle& t) {
  const double a = cross_2d(t[0], t[1]), b = cross_2d(t[1], t[2]), c = cross_2d(t[2], t[0]);
  return (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
}

// Whether a triangle may meet the upright cylinder around the origin, z up. What is further off than `room_m` does not.
bool may_meet(const Triangle& t, const Cylinder& cylinder, double room_m) {
  const double radius = cylinder.radius_m + room_m;
  double low = std::min({t[0].z(), t[1].z(), t[2].z()}), high = std::max({t[0].z(), t[1].z(), t[2].z()});
  if (low > cylinder.high_m + room_m || high < cylinder.low_m - room_m) return false;
  if (!is_inside_2d(t) &&
      std::min({distance_2d(t[0], t[1]), distance_2d(t[1], t[2]), distance_2d(t[2], t[0])}) > radius)
    return false;
  // The heights that the triangle's plane has over the circle.
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double slope = length_2d(normal) / std::abs(normal.z());
  if (!std::isfinite(slope)) return true;
  const double middle = t[0].z() + (normal.x() * t[0].x() + normal.y() * t[0].y()) / normal.z();
  const double reach = radius * slope + room_m * (1.0 + slope);
  return !(middle - reach > cylinder.high_m || middle + reach < cylinder.low_m);
}

}  // namespace

Cylinder cylinder_around(const TriangleSoup& soup, const Vec3& direction) {
  Cylinder cylinder;
  cylinder.center = (soup.box.lo + soup.box.hi) / 2.0;
  cylinder.low_m = std::numeric_limits<double>::infinity();
  cylinder.high_m = -cylinder.low_m;
  for (const TriangleSoup::Face& face : soup.faces) {
    for (const std::uint32_t corner : face.corners) {
      const Vec3 arm = soup.vertices[corner] - cylinder.center;
      const double height = arm.dot(direction);
      cylinder.low_m = std::min(cylinder.low_m, height);
      cylinder.high_m = std::max(cylinder.high_m, height);
      cylinder.radius_m = std::max(cylinder.radius_m, (arm - height * direction).norm());
    }
  }
  return cylinder;
}

bool is_terrain(const TriangleSoup& soup, const Vec3& up) {
  bool faces_up = false, faces_down = false;
  for (std::uint32_t i = 0; i < soup.faces.size() && !(faces_up && faces_down); ++i) {
    const Triangle t = soup.triangle(i);
    const double facing = (t[1] - t[0]).cross(t[2] - t[0]).dot(up);
    faces_up = faces_up || facing > 0.0;
    faces_down = faces_down || facing < 0.0;
  }
  return faces_up != faces_down;
}

// Objects that turn about the vertical alone, as most do, are measured once.
CylinderQuery::Measured CylinderQuery::measured(const NumberedSoup& of, const Vec3& up) {
  const Vec3 direction = axis_ == CylinderAxis::kWorld ? up : Vec3::UnitY();
  if (measured_.size() >= kMeasuredMax) measured_.clear();
  Measured& known = measured_[of.number];
  if (known.direction != direction) {
    known = {direction, cylinder_around(*of.soup, direction), is_terrain(*of.soup, direction)};
  }
  return known;
}

// Calls `found` with pairs of polygons until it returns true, and returns whether it did.
template <class Found>
bool CylinderQuery::search(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b, Found found) {
  const Vec3 up = up_in(a.pose);
  const Measured of_a = measured(a, up), of_b = measured(b, up_in(b.pose));
  const double room_m =
      8.0 * kRounding *
      (largest_coordinate(a.soup->box) + largest_coordinate(b.soup->box) + a_from_b.translation.cwiseAbs().maxCoeff());
  // From A's frame to one with z up.
  Mat3 rows;
  rows.row(0) = up.unitOrthogonal();
  rows.row(1) = up.cross(Vec3(rows.row(0)));
  rows.row(2) = up;
  const Vec3 center_a = rows * of_a.cylinder.center, center_b = rows * a_from_b(of_b.cylinder.center);
  const Vec3 between = center_b - center_a;
  ++counters_.bv_tests;
  if (between.z() + of_b.cylinder.low_m > of_a.cylinder.high_m + room_m) return false;
  if (between.z() + of_b.cylinder.high_m < of_a.cylinder.low_m - room_m) return false;
  if (length_2d(between) > of_a.cylinder.radius_m + of_b.cylinder.radius_m + room_m) return false;
  const std::uint32_t first_a = a.soup->faces.front().polygon, first_b = b.soup->faces.front().polygon;
  if (of_a.is_terrain == of_b.is_terrain) return found(PolygonPair{first_a, first_b});
  const TriangleSoup& terrain = of_a.is_terrain ? *a.soup : *b.soup;
  const Cylinder& cylinder = of_a.is_terrain ? of_b.cylinder : of_a.cylinder;
  const Vec3& center = of_a.is_terrain ? center_b : center_a;
  for (std::uint32_t i = 0; i < terrain.faces.size(); ++i) {
    Triangle t = terrain.triangle(i);
    for (Vec3& corner : t) corner = rows * (of_a.is_terrain ? corner : a_from_b(corner)) - center;
    ++counters_.bv_tests;
    if (!may_meet(t, cylinder, room_m)) continue;
    const std::uint32_t polygon = terrain.faces[i].polygon;
    if (found(of_a.is_terrain ? PolygonPair{polygon, first_b} : PolygonPair{first_a, polygon})) return true;
  }
  return false;
}

bool CylinderQuery::find_pair(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b,
                              PolygonPair& pair) {
  return first_visited([&](auto found) { return search(a, b, a_from_b, found); }, pair);
}

std::vector<PolygonPair> CylinderQuery::all_pairs(const NumberedSoup& a, const NumberedSoup& b,
                                                  const RelativeMotion& a_from_b) {
  return all_visited([&](auto found) { return search(a, b, a_from_b, found); });
}

}  // namespace peerd::collision::engines
