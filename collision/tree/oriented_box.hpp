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
  [[nodiscard]] float half_area() const {
    const Float4 d = hi + minus_lo;
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

  // The moments of the triangles' areas.
  void weigh(Float4 p, Float4 q, Float4 r) {
    const Float4 a = (p - middle_) * to_unit_, b = (q - middle_) * to_unit_, c = (r - middle_) * to_unit_;
    const Float4 u = b - a, v = c - a;
    const Float4 n = Float4{u[1], u[2], u[0], 0} * Float4{v[2], v[0], v[1], 0} -
                     Float4{u[2], u[0], u[1], 0} * Float4{v[1], v[2], v[0], 0};
    const Float4 square = n * n;
    const float area = __builtin_sqrtf((square[0] + square[1]) + square[2]);
    const Float4 sum = (a + b) + c;
    area_ += area;
    first_ += all4(area) * sum;
    for (int k = 0; k < 3; ++k) {
      second_[k] += all4(area) * (((all4(sum[k]) * sum + all4(a[k]) * a) + all4(b[k]) * b) + all4(c[k]) * c);
    }
  }
  // Chooses the axes of what was weighed: false where there are none better than the frame's.
  [[nodiscard]] bool turn();
  void turn_to(const std::array<std::array<float, 3>, 3>& axes);

  // Widens the box for a point, or for a box.
  void add(Float4 p) {
    const Float4 l = p - middle_;
    extent_.merge((all4(l[0]) * columns_[0] + all4(l[1]) * columns_[1]) + all4(l[2]) * columns_[2]);
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
