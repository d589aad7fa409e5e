#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "collision/tree/float4.hpp"
#include "core/math.hpp"

namespace peerd::collision {

// A box with axes of its own, in a tree's numbers. What is in it is no farther from `center` along axis k than half[k],
// but for the rounding of `center` itself.
struct OrientedBox {
  std::array<float, 3> center{}, half{};
  std::array<std::array<float, 3>, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // by axis, then component

  // Half of what is in proportion to a surface.
  [[nodiscard]] float half_area() const { return half[0] * half[1] + half[1] * half[2] + half[2] * half[0]; }
};

// An axis-aligned box, as the largest of all -x, -y, -z and of all x, y, z: so that all is maxima.
struct Bounds4 {
  Float4 minus_lo = all4(-__builtin_inff()), hi = minus_lo;

  void merge(const Bounds4& other) {
    minus_lo = max4(minus_lo, other.minus_lo);
    hi = max4(hi, other.hi);
  }
  void merge(Float4 p) { merge({-p, p}); }
  [[nodiscard]] Float4 sides() const { return hi + minus_lo; }
  [[nodiscard]] float half_area() const {
    const Float4 d = sides();
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  }
};

// The same box with the axes of the frame.
[[nodiscard]] OrientedBox axis_aligned_box(const Bounds4& bounds);

// The eigenvectors of a symmetric matrix, one a column, by Jacobi's rotations: IEEE operations in a written order. They
// are right-handed and orthogonal but for a few roundings, whatever the matrix is, and approximate as eigenvectors.
[[nodiscard]] Mat3 principal_axes(const Mat3& matrix);

// Gathers triangles, first for a box's axes and then for its extents along them. All are within `bounds`.
class BoxFit {
 public:
  explicit BoxFit(const Bounds4& bounds);

  // Sums up the moments of the triangles' areas: each(use) calls use() with the corners of each.
  template <class Each>
  void weigh(Each each) {
    const Float4 middle = middle_, to_unit = to_unit_;
    float areas = 0.0f;
    Float4 first{}, of_x{}, of_y{}, of_z{};
    each([&](Float4 p, Float4 q, Float4 r) {
      const Float4 a = (p - middle) * to_unit, b = (q - middle) * to_unit, c = (r - middle) * to_unit;
      const Float4 u = b - a, v = c - a;
      const Float4 n = Float4{u[1], u[2], u[0], 0} * Float4{v[2], v[0], v[1], 0} -
                       Float4{u[2], u[0], u[1], 0} * Float4{v[1], v[2], v[0], 0};
      const Float4 square = n * n;
      const float area = __builtin_sqrtf((square[0] + square[1]) + square[2]);
      const Float4 sum = (a + b) + c;
      areas += area;
      first += all4(area) * sum;
      const auto second = [&](int k) {
        return all4(area) * (((all4(sum[k]) * sum + all4(a[k]) * a) + all4(b[k]) * b) + all4(c[k]) * c);
      };
      of_x += second(0), of_y += second(1), of_z += second(2);
    });
    area_ = areas;
    first_ = first;
    second_[0] = of_x, second_[1] = of_y, second_[2] = of_z;
  }
  // Chooses the axes of what was weighed: false where there are none better than the frame's.
  [[nodiscard]] bool turn();
  void turn_to(const std::array<std::array<float, 3>, 3>& axes);

  // Widens the box for triangles, as in weigh(), or for a box.
  template <class Each>
  void add(Each each) {
    const Float4 middle = middle_, x = columns_[0], y = columns_[1], z = columns_[2];
    const auto along = [&](Float4 p) {
      const Float4 l = p - middle;
      return (all4(l[0]) * x + all4(l[1]) * y) + all4(l[2]) * z;
    };
    Float4 most = extent_.hi, least = -extent_.minus_lo;
    each([&](Float4 p, Float4 q, Float4 r) {
      const Float4 a = along(p), b = along(q), c = along(r);
      most = max4(max4(most, a), max4(b, c));
      least = min4(min4(least, a), min4(b, c));
    });
    extent_ = {-least, most};
  }
  void add(const OrientedBox& box);
  // The box, or that with the axes of the frame where it is smaller.
  [[nodiscard]] OrientedBox box() const;

 private:
  Bounds4 bounds_;
  Float4 middle_, to_unit_;  // moments are those of numbers that are 1 at most
  float area_ = 0.0f;
  Float4 first_{};      // twice the area times three times the centroid
  Float4 second_[3]{};  // twelve times the second moments, by row, twice
  bool turned_ = false;
  Float4 columns_[3]{};  // the axes: by component, then axis
  Bounds4 extent_;       // along the axes, from the middle
};

}  // namespace peerd::collision
