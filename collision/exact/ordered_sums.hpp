#pragma once
#include <cmath>

#include "core/math.hpp"

// Sums from left to right, in scalar operations. Eigen's own dot() and norm() add in an order that depends on the
// instruction set, and a contact time that two peers compute must have the same bits.
namespace peerd::collision {

[[nodiscard]] inline double dot(const Vec3& a, const Vec3& b) { return a.x() * b.x() + a.y() * b.y() + a.z() * b.z(); }
[[nodiscard]] inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
[[nodiscard]] inline Vec3 unit(const Vec3& a) { return a / length(a); }
// At least the length, without a root.
[[nodiscard]] inline double magnitude(const Vec3& a) { return std::abs(a.x()) + std::abs(a.y()) + std::abs(a.z()); }
[[nodiscard]] inline double sum_of_magnitudes(const Vec3& a, const Vec3& b) { return magnitude(a) + magnitude(b); }

// R v, and R^T v.
[[nodiscard]] inline Vec3 rotate(const Mat3& R, const Vec3& v) {
  return {R(0, 0) * v.x() + R(0, 1) * v.y() + R(0, 2) * v.z(), R(1, 0) * v.x() + R(1, 1) * v.y() + R(1, 2) * v.z(),
          R(2, 0) * v.x() + R(2, 1) * v.y() + R(2, 2) * v.z()};
}
[[nodiscard]] inline Vec3 rotate_back(const Mat3& R, const Vec3& v) {
  return {dot(R.col(0), v), dot(R.col(1), v), dot(R.col(2), v)};
}

}  // namespace peerd::collision
