#include "core/geometry/planarity.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/geometry/plane_point.hpp"

namespace peerd {
namespace {

using Point = Eigen::Vector3f;

// An Expansion is an exact sum of binary64 numbers as numbers that don't overlap, the largest last (Shewchuk 1997,
// Grow-Expansion with the zeros left out). ExactSum takes products of two coordinates; a volume has products of three.
class Expansion {
 public:
  void add(double x) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = x + parts_[i], virtual_part = sum - x;
      const double lost = (x - (sum - virtual_part)) + (parts_[i] - virtual_part);
      if (lost != 0.0) parts_[kept++] = lost;
      x = sum;
    }
    if (x != 0.0) parts_[kept++] = x;
    size_ = kept;
  }

  // The product of two is exact in binary64 and has 48 bits; its halves of 24 have exact products with the third. All
  // are between 2^-447 and 2^384, so nothing under- or overflows.
  void add_product(float a, float b, float c) {
    const double ab = static_cast<double>(a) * static_cast<double>(b);
    const double high = std::bit_cast<double>(std::bit_cast<std::uint64_t>(ab) & ~std::uint64_t{0x1fff'ffff});
    add(high * static_cast<double>(c));
    if (ab != high) add((ab - high) * static_cast<double>(c));
  }

  // Adds the determinant of the three points.
  void add_determinant(const Point& a, const Point& b, const Point& c) {
    add_product(a.x(), b.y(), c.z()), add_product(-a.x(), b.z(), c.y());
    add_product(a.y(), b.z(), c.x()), add_product(-a.y(), b.x(), c.z());
    add_product(a.z(), b.x(), c.y()), add_product(-a.z(), b.y(), c.x());
  }

  [[nodiscard]] bool is_zero() const { return size_ == 0; }

 private:
  std::array<double, 48> parts_;  // 4 determinants of 6 products of 2 halves: each adds one part at most
  std::size_t size_ = 0;
};

// The expansion is det(a - d, b - d, c - d), multiplied out.
bool exactly_coplanar(const Point& a, const Point& b, const Point& c, const Point& d) {
  Expansion volume;
  volume.add_determinant(a, b, c);
  volume.add_determinant(a, d, b);
  volume.add_determinant(a, c, d);
  volume.add_determinant(b, d, c);
  return volume.is_zero();
}

}  // namespace

bool collinear(const Point& a, const Point& b, const Point& c) {
  for (Eigen::Index x = 0; x < 3; ++x) {
    const Eigen::Index y = (x + 1) % 3;
    if (orient2d({a[x], a[y]}, {b[x], b[y]}, {c[x], c[y]}) != 0) return false;
  }
  return true;
}

// The filter is Shewchuk's orient3d, whose bound is (7 + 56 u) u, u = 2^-53; nothing here under- or overflows. Without
// any product both sides are 0, and so is the volume.
bool coplanar(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Eigen::Vector3d p = a.cast<double>() - d.cast<double>(), q = b.cast<double>() - d.cast<double>(),
                        r = c.cast<double>() - d.cast<double>();
  const double qr_x = q.y() * r.z(), rq_x = q.z() * r.y();
  const double qr_y = q.z() * r.x(), rq_y = q.x() * r.z();
  const double qr_z = q.x() * r.y(), rq_z = q.y() * r.x();
  const double volume = p.x() * (qr_x - rq_x) + p.y() * (qr_y - rq_y) + p.z() * (qr_z - rq_z);
  const double sizes = std::abs(p.x()) * (std::abs(qr_x) + std::abs(rq_x)) +
                       std::abs(p.y()) * (std::abs(qr_y) + std::abs(rq_y)) +
                       std::abs(p.z()) * (std::abs(qr_z) + std::abs(rq_z));
  if (std::abs(volume) >= 0x1p-50 * sizes) return volume == 0.0;
  return exactly_coplanar(a, b, c, d);
}

// The first three that are not on a line span the plane.
bool coplanar(std::span<const Point> points) {
  const std::size_t n = points.size();
  if (n < 4) return true;
  std::size_t second = 1;
  while (second < n && points[second] == points[0]) ++second;
  std::size_t third = second + 1;
  while (third < n && collinear(points[0], points[second], points[third])) ++third;
  for (std::size_t i = third + 1; i < n; ++i) {
    if (!coplanar(points[0], points[second], points[third], points[i])) return false;
  }
  return true;
}

}  // namespace peerd
