#include "collision/engines/box_volumes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "collision/engines/volume_tree.hpp"
#include "core/box.hpp"

namespace peerd::collision::engines {
namespace {

// The box along these axes around triangles of a soup.
Box around_along(const Mat3& axes, const TriangleSoup& soup, std::span<const std::uint32_t> faces) {
  WorldBox sides;  // along the axes
  for (const std::uint32_t face : faces) {
    for (const Vec3& corner : soup.triangle(face)) sides.merge(Vec3(axes.transpose() * corner));
  }
  Box box;
  box.orientation = axes;
  box.center = axes * ((sides.lo + sides.hi) / 2.0);
  box.half = (sides.hi - sides.lo) / 2.0 + Vec3::Constant(kRounding * largest_coordinate(soup.box));
  return box;
}

// The mean place and the covariance of the triangles' area, or of their corners where they have none. Places are taken
// from the first corner, in units of the largest distance along an axis, so that no product overflows.
Mat3 covariance(const TriangleSoup& soup, std::span<const std::uint32_t> faces) {
  const Vec3 origin = soup.triangle(faces.front())[0];
  double extent = 0.0;
  for (const std::uint32_t face : faces) {
    for (const Vec3& corner : soup.triangle(face)) extent = std::max(extent, (corner - origin).cwiseAbs().maxCoeff());
  }
  Mat3 second = Mat3::Zero(), flat_second = Mat3::Zero();
  Vec3 first = Vec3::Zero(), flat_first = Vec3::Zero();
  double area = 0.0;
  for (const std::uint32_t face : faces) {
    const Triangle t = soup.triangle(face);
    const std::array<Vec3, 3> at{(t[0] - origin) / extent, (t[1] - origin) / extent, (t[2] - origin) / extent};
    const double weight = (at[1] - at[0]).cross(at[2] - at[0]).norm() / 2.0;
    const Vec3 sum = at[0] + at[1] + at[2];
    Mat3 corners = Mat3::Zero();
    for (const Vec3& corner : at) corners += corner * corner.transpose();
    second += weight / 12.0 * (sum * sum.transpose() + corners);
    first += weight / 3.0 * sum;
    area += weight;
    flat_second += corners / 3.0;
    flat_first += sum / 3.0;
  }
  const bool is_flat = !(area > 0.0);
  const double weight = is_flat ? static_cast<double>(faces.size()) : area;
  const Vec3 mean = (is_flat ? flat_first : first) / weight;
  return (is_flat ? flat_second : second) / weight - mean * mean.transpose();
}

// The eigenvectors of the covariance; the soup's own axes where they are no numbers.
Mat3 principal_axes(const TriangleSoup& soup, std::span<const std::uint32_t> faces) {
  const Mat3 spread = covariance(soup, faces);
  if (!spread.allFinite()) return Mat3::Identity();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread);
  const Mat3& axes = solver.eigenvectors();
  return solver.info() == Eigen::Success && axes.allFinite() ? axes : Mat3::Identity();
}

}  // namespace

std::array<Vec3, 3> Box::axes() const {
  std::array<int, 3> order{0, 1, 2};
  std::ranges::stable_sort(order, [this](int i, int j) { return half[i] > half[j]; });
  return {orientation.col(order[0]), orientation.col(order[1]), orientation.col(order[2])};
}

BoxTest::BoxTest(const RelativeMotion& a_from_b, double extent_a_m, double extent_b_m)
    : a_from_b_(a_from_b),
      room_m_(8.0 * kRounding * (extent_a_m + extent_b_m + a_from_b.translation.cwiseAbs().maxCoeff())) {}

bool BoxTest::operator()(const Box& a, const Box& b) const {
  // B in A's frame, along A's axes.
  const Mat3 r = a.orientation.transpose() * (a_from_b_.rotation * b.orientation);
  const Vec3 t = a.orientation.transpose() * (a_from_b_(b.center) - a.center);
  const Mat3 s = r.cwiseAbs();
  for (int i = 0; i < 3; ++i) {
    if (std::abs(t[i]) > a.half[i] + s.row(i).dot(b.half) + room_m_) return false;
    if (std::abs(t.dot(r.col(i))) > b.half[i] + s.col(i).dot(a.half) + room_m_) return false;
  }
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const double reach_a = a.half[i1] * s(i2, j) + a.half[i2] * s(i1, j);
      const double reach_b = b.half[j1] * s(i, j2) + b.half[j2] * s(i, j1);
      if (std::abs(t[i2] * r(i1, j) - t[i1] * r(i2, j)) > reach_a + reach_b + room_m_) return false;
    }
  }
  return true;
}

OrientedBox OrientedBox::around(const TriangleSoup& soup, std::span<const std::uint32_t> faces) {
  return {around_along(principal_axes(soup, faces), soup, faces)};
}

AlignedBox AlignedBox::around(const TriangleSoup& soup, std::span<const std::uint32_t> faces) {
  return {around_along(Mat3::Identity(), soup, faces)};
}

}  // namespace peerd::collision::engines
