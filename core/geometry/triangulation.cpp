#include "core/geometry/triangulation.hpp"

#include <cassert>
#include <cmath>

namespace peerd {
namespace {

constexpr std::array<CornerTriangle, 3> kFewCorners = {{{0, 0, 0}, {0, 1, 1}, {0, 1, 2}}};

// The sums are Newell's: component k is twice the area of the projection along axis k, counter-clockwise positive.
class AreaVector {
 public:
  AreaVector(std::span<const Eigen::Vector3f> vertices, std::span<const std::int32_t> polygon)
      : vertices_(vertices), polygon_(polygon) {
    const auto from_first = [&](std::size_t i) {
      std::array<double, 3> d;
      for (std::size_t k = 0; k < 3; ++k) d[k] = static_cast<double>(at(i, k)) - static_cast<double>(at(0, k));
      return d;
    };
    std::array<double, 3> products{};
    std::array<double, 3> p = from_first(1);
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      const std::array<double, 3> q = from_first(i);
      for (std::size_t k = 0; k < 3; ++k) {
        const double left = p[(k + 1) % 3] * q[(k + 2) % 3], right = p[(k + 2) % 3] * q[(k + 1) % 3];
        rounded_[k] += left - right;
        products[k] += std::abs(left) + std::abs(right);
      }
      p = q;
    }
    // Five steps round: both factors of a product, the product, the difference of two, and n sums at most, each by u =
    // 2^-53. The bound is twice as much and more, which takes care of the higher powers of u and of its own rounding.
    for (std::size_t k = 0; k < 3; ++k) error_[k] = static_cast<double>(polygon.size() + 8) * 0x1p-52 * products[k];
  }

  [[nodiscard]] std::size_t largest() const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (larger(k, best)) best = k;
    }
    return best;
  }

  [[nodiscard]] int sign(std::size_t k) const {
    if (std::abs(rounded_[k]) >= error_[k]) return (rounded_[k] > 0.0) - (rounded_[k] < 0.0);
    ExactSum area;
    add_to(area, k, 1);
    return area.sign();
  }

 private:
  [[nodiscard]] float at(std::size_t corner, std::size_t k) const {
    return vertices_[static_cast<std::size_t>(polygon_[corner])][static_cast<Eigen::Index>(k)];
  }

  // Returns |a| > |b|.
  [[nodiscard]] bool larger(std::size_t a, std::size_t b) const {
    const double size_a = std::abs(rounded_[a]), size_b = std::abs(rounded_[b]);
    if (size_a - error_[a] > size_b + error_[b]) return true;
    if (size_a + error_[a] < size_b - error_[b]) return false;
    ExactSum difference;
    add_to(difference, a, sign(a));
    add_to(difference, b, -sign(b));
    return difference.sign() > 0;
  }

  void add_to(ExactSum& sum, std::size_t k, int factor) const {
    if (factor == 0) return;
    const std::size_t x = (k + 1) % 3, y = (k + 2) % 3;
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      const std::size_t j = i + 1 == polygon_.size() ? 0 : i + 1;
      if (factor > 0) {
        sum.add(at(i, x), at(j, y)), sum.subtract(at(i, y), at(j, x));
      } else {
        sum.subtract(at(i, x), at(j, y)), sum.add(at(i, y), at(j, x));
      }
    }
  }

  std::span<const Eigen::Vector3f> vertices_;
  std::span<const std::int32_t> polygon_;
  std::array<double, 3> rounded_{}, error_{};
};

void project(std::span<const Eigen::Vector3f> vertices, std::span<const std::int32_t> polygon,
             std::vector<PlanePoint>& points) {
  const AreaVector area(vertices, polygon);
  const std::size_t k = area.largest();
  auto x = static_cast<Eigen::Index>((k + 1) % 3), y = static_cast<Eigen::Index>((k + 2) % 3);
  if (area.sign(k) < 0) std::swap(x, y);
  points.clear();
  for (const std::int32_t corner : polygon) {
    const Eigen::Vector3f& v = vertices[static_cast<std::size_t>(corner)];
    points.push_back({v[x], v[y]});
  }
}

// A convex polygon never turns to the right, where coming straight back counts as a turn to the left. Then the
// directions of its edges go around a whole number of times, and change between forward and backward (by x, then by y)
// twice each time.
bool is_convex(std::span<const PlanePoint> points) {
  std::size_t last = points.size() - 1;
  while (last > 0 && points[last] == points[0]) --last;
  if (last == 0) return true;
  PlanePoint a = points[last], b = points[0];
  bool forward = lexicographically_less(a, b);
  int changes = 0;
  for (std::size_t i = 1; i <= last + 1; ++i) {
    const PlanePoint& c = points[i <= last ? i : 0];
    if (c == b) continue;  // no edge
    if (orient2d(a, b, c) < 0) return false;
    if (lexicographically_less(b, c) != forward && ++changes > 2) return false;
    forward = lexicographically_less(b, c);
    a = b;
    b = c;
  }
  return true;
}

}  // namespace

bool has_front(std::span<const Eigen::Vector3f> vertices, std::span<const std::int32_t> polygon) {
  if (polygon.size() < 3) return false;
  const AreaVector area(vertices, polygon);
  return area.sign(0) != 0 || area.sign(1) != 0 || area.sign(2) != 0;
}

std::span<const CornerTriangle> Triangulator::triangulate(std::span<const Eigen::Vector3f> vertices,
                                                          std::span<const std::int32_t> polygon) {
  assert(!polygon.empty() && polygon.size() < (1U << 28));  // AreaVector's sums are within ExactSum's limit
  if (polygon.size() <= 3) return std::span(&kFewCorners[polygon.size() - 1], 1);
  project(vertices, polygon, points_);
  triangles_.clear();
  if (is_convex(points_)) {
    for (std::uint32_t i = 1; i + 1 < points_.size(); ++i) triangles_.push_back({0, i, i + 1});
  } else {
    ear_clipping_.cut(points_, triangles_);
  }
  assert(triangles_.size() == triangle_count(polygon.size()));
  return triangles_;
}

}  // namespace peerd
