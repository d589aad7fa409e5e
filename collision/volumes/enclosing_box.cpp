#include "collision/volumes/enclosing_box.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "collision/tree/oriented_box.hpp"
#include "core/box.hpp"

namespace peerd::collision {
namespace {

constexpr std::size_t kFacesTried = 16'000;

// Corners of the convex hull of points in the plane, counter-clockwise (Andrew, "Another efficient algorithm for convex
// hulls in two dimensions", 1979). Rounded: it only proposes axes.
std::vector<Eigen::Vector2d> flat_hull(std::vector<Eigen::Vector2d> points) {
  std::ranges::sort(points,
                    [](const auto& a, const auto& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  std::vector<Eigen::Vector2d> out;
  for (int half = 0; half < 2; ++half) {
    const std::size_t begin = out.size();
    for (const Eigen::Vector2d& p : points) {
      const auto turns_left = [&] {
        const Eigen::Vector2d u = out.back() - out[out.size() - 2], v = p - out.back();
        return u.x() * v.y() - u.y() * v.x() > 0.0;
      };
      while (out.size() >= begin + 2 && !turns_left()) out.pop_back();
      out.push_back(p);
    }
    out.pop_back();
    std::ranges::reverse(points);
  }
  return out;
}

// The smallest box with an axis along `normal`: by the smallest rectangle around what is seen along it, which has a
// side along an edge of that (Freeman and Shapira, CACM 18(7), 1975).
EnclosingBox box_on(const Vec3& normal, std::span<const Vec3> points) {
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Eigen::Vector2d> flat;
  flat.reserve(points.size());
  for (const Vec3& p : points) flat.emplace_back(u.dot(p), v.dot(p));
  const auto outline = flat_hull(std::move(flat));
  double least = std::numeric_limits<double>::infinity();
  Eigen::Vector2d best(1.0, 0.0);
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    const double length = edge.norm();
    if (!(length > 0.0)) continue;
    const Eigen::Vector2d along = edge / length, across(-along.y(), along.x());
    Eigen::Vector2d lo = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), hi = -lo;
    for (const Eigen::Vector2d& p : outline) {
      const Eigen::Vector2d q(along.dot(p), across.dot(p));
      lo = lo.cwiseMin(q), hi = hi.cwiseMax(q);
    }
    const double area = (hi - lo).prod();
    if (area < least) least = area, best = along;
  }
  Mat3 axes;
  axes.row(0) = normal.transpose();
  axes.row(1) = (best.x() * u + best.y() * v).transpose();
  axes.row(2) = normal.cross(Vec3(axes.row(1))).transpose();
  return box_along(axes, points);
}

// Turns a box by ever smaller steps, for as long as that makes it smaller.
EnclosingBox turned_smaller(EnclosingBox box, std::span<const Vec3> points) {
  for (double step = 0.25; step > 1e-5;) {
    bool smaller = false;
    for (int i = 0; i < 6 && !smaller; ++i) {
      const Vec3 turn = (i % 2 == 0 ? step : -step) * Vec3::Unit(i / 2);
      const EnclosingBox next = box_along(quat_exp(turn).toRotationMatrix() * box.axes, points);
      smaller = volume(next) < volume(box);
      if (smaller) box = next;
    }
    if (!smaller) step /= 2.0;
  }
  return box;
}

Mat3 principal_rows(std::span<const Vec3> points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& p : points) covariance += (p - mean) * (p - mean).transpose();
  return principal_axes(covariance).transpose();
}

}  // namespace

EnclosingBox box_along(const Mat3& axes, std::span<const Vec3> points) {
  assert(!points.empty());
  WorldBox box;
  for (const Vec3& p : points) box.merge(Vec3(axes * p));
  return {axes, box.hi - box.lo};
}

EnclosingBox small_box(const ConvexHull& hull) {
  assert(!hull.triangles.empty());
  const std::span<const Vec3> points = hull.corners;
  const std::size_t stride = hull.triangles.size() / kFacesTried + 1;
  EnclosingBox of_faces = box_along(Mat3::Identity(), points);
  for (std::size_t i = 0; i < hull.triangles.size(); i += stride) {
    const auto& [a, b, c] = hull.triangles[i];
    const Vec3 normal = (points[b] - points[a]).cross(points[c] - points[a]);
    const double length = normal.norm();
    if (!(length > 0.0)) continue;  // rounded away
    const EnclosingBox box = box_on(normal / length, points);
    if (volume(box) < volume(of_faces)) of_faces = box;
  }
  EnclosingBox best = of_faces;
  for (const EnclosingBox& start :
       {of_faces, box_along(Mat3::Identity(), points), box_along(principal_rows(points), points)}) {
    const EnclosingBox box = turned_smaller(start, points);
    if (volume(box) < volume(best)) best = box;
  }
  return best;
}

double volume(const EnclosingBox& box) { return box.sides.prod(); }

}  // namespace peerd::collision
