#pragma once
#include <cmath>

#include "core/geometry/exact_sum.hpp"

namespace peerd {

// A point of a plane, of finite binary32 coordinates as they were written.
struct PlanePoint {
  float x = 0, y = 0;
  friend bool operator==(const PlanePoint&, const PlanePoint&) = default;  // -0 == 0
};

// Orders points by x, then by y. Along a line this is one of its two directions.
[[nodiscard]] inline bool lexicographically_less(const PlanePoint& a, const PlanePoint& b) {
  return a.x < b.x || (a.x == b.x && a.y < b.y);
}

[[nodiscard]] inline int orient2d_exact(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  ExactSum area;
  area.add(a.x, b.y), area.subtract(a.y, b.x);
  area.add(b.x, c.y), area.subtract(b.y, c.x);
  area.add(c.x, a.y), area.subtract(c.y, a.x);
  return area.sign();
}

// 1 if a b c is a turn to the left (y up, x to the right), -1 to the right, 0 if there's no area between them.
// Exact. Filter: Shewchuk's orient2d, whose bound is (3 + 16 u) u, u = 2^-53; nothing here under- or overflows. Without
// any product both are 0, and so is the bound.
[[nodiscard]] inline int orient2d(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const auto minus = [](float l, float r) { return static_cast<double>(l) - static_cast<double>(r); };
  const double left = minus(a.x, c.x) * minus(b.y, c.y);
  const double right = minus(a.y, c.y) * minus(b.x, c.x);
  const double area = left - right;
  if (std::abs(area) >= 0x1p-51 * (std::abs(left) + std::abs(right))) return (area > 0.0) - (area < 0.0);
  return orient2d_exact(a, b, c);
}

}  // namespace peerd
