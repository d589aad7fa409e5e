#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/transform.hpp"

namespace peerd {

// A closed axis-aligned box. The empty box is lo = +inf, hi = -inf: it is inside every box, and merging it changes
// nothing. Merging only selects among its inputs' numbers, so a union has the same value in whatever order it is taken.
template <class Scalar>
struct AxisBox {
  using Point = Eigen::Matrix<Scalar, 3, 1>;
  Point lo = Point::Constant(std::numeric_limits<Scalar>::infinity());
  Point hi = Point::Constant(-std::numeric_limits<Scalar>::infinity());

  [[nodiscard]] bool is_empty() const { return !(lo[0] <= hi[0] && lo[1] <= hi[1] && lo[2] <= hi[2]); }
  [[nodiscard]] bool contains(const Point& p) const { return contains(AxisBox{p, p}); }
  [[nodiscard]] bool contains(const AxisBox& other) const {
    if (other.is_empty()) return true;
    for (int i = 0; i < 3; ++i) {
      if (!(lo[i] <= other.lo[i] && other.hi[i] <= hi[i])) return false;
    }
    return true;
  }
  void merge(const AxisBox& other) {
    for (int i = 0; i < 3; ++i) {
      if (other.lo[i] < lo[i]) lo[i] = other.lo[i];
      if (other.hi[i] > hi[i]) hi[i] = other.hi[i];
    }
  }
  void merge(const Point& p) { merge(AxisBox{p, p}); }
  friend bool operator==(const AxisBox& a, const AxisBox& b) { return a.lo == b.lo && a.hi == b.hi; }
};

// The box of the binary32 vertices of a Shape in its own frame [m]. It is exact, as its sides are coordinates of
// vertices.
using LocalBox = AxisBox<float>;
// A box in the world frame [m].
using WorldBox = AxisBox<double>;

// The largest absolute value of a side [m], at least 0.
[[nodiscard]] inline double largest_coordinate(const WorldBox& box) {
  double most = 0.0;
  for (int i = 0; i < 3; ++i) most = std::max({most, std::abs(box.lo[i]), std::abs(box.hi[i])});
  return most;
}

// Returns a box that contains m * p for every p in `box`: as the reals have it, and as multiply(m.linear, p) + m.offset
// rounds it. It is wider than the tight one by at most 2^-49 of the largest |m.linear| * |p| + |m.offset| along an axis
// (and 2^-1021 m). It is unbounded along an axis where its numbers overflow. `box` must be finite or empty; empty stays
// empty.
[[nodiscard]] WorldBox transformed(const Affine& m, const LocalBox& box);

}  // namespace peerd
