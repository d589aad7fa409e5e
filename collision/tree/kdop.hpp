#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "core/math.hpp"

namespace peerd::collision {

// The directions of a discrete oriented polytope with k faces, k/2 pairs of parallel ones: the axes, then the diagonals
// of the sides of a cube (k = 18, in the order of the thesis's listing 3.2), those of the cube (14), or both (26).
template <int K>
constexpr auto kdop_directions() {
  static_assert(K == 6 || K == 14 || K == 18 || K == 26);
  constexpr std::array<std::array<int, 3>, 3> axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  constexpr std::array<std::array<int, 3>, 6> sides = {
      {{1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, -1, 0}, {1, 0, -1}, {0, 1, -1}}};
  constexpr std::array<std::array<int, 3>, 4> corners = {{{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}}};
  std::array<std::array<int, 3>, K / 2> out{};
  auto end = std::ranges::copy(axes, out.begin()).out;
  if constexpr (K >= 18) end = std::ranges::copy(sides, end).out;
  if constexpr (K == 14 || K == 26) std::ranges::copy(corners, end);
  return out;
}

// Unlike a unit direction's, these dot products are sums: without a multiplication, and nearly without rounding.
[[nodiscard]] inline double along(const std::array<int, 3>& direction, const Vec3& p) {
  return (direction[0] * p[0] + direction[1] * p[1]) + direction[2] * p[2];
}

// A slab for each direction. The empty k-DOP has lo = +inf, hi = -inf: merging ignores it, and it overlaps nothing.
template <int K, class Scalar>
struct BasicKdop {
  static constexpr std::size_t kSlabs = K / 2;
  static constexpr auto kDirections = kdop_directions<K>();
  std::array<Scalar, kSlabs> lo, hi;  // [m], times the direction's length

  [[nodiscard]] static BasicKdop empty() {
    BasicKdop out;
    out.lo.fill(std::numeric_limits<Scalar>::infinity());
    out.hi.fill(-std::numeric_limits<Scalar>::infinity());
    return out;
  }
  void merge(const BasicKdop& other) {
    for (std::size_t i = 0; i < kSlabs; ++i) {
      lo[i] = std::min(lo[i], other.lo[i]);
      hi[i] = std::max(hi[i], other.hi[i]);
    }
  }
};

// Stored slabs, rounded outwards from the real numbers' ones.
template <int K>
using Kdop = BasicKdop<K, float>;
// Slabs during a computation.
template <int K>
using WideKdop = BasicKdop<K, double>;

// Whether two closed k-DOPs may overlap: no slab separates them. NaN, as where slabs are infinite, separates nothing.
template <int K, class A, class B>
[[nodiscard]] bool overlap(const BasicKdop<K, A>& a, const BasicKdop<K, B>& b) {
  for (std::size_t i = 0; i < a.kSlabs; ++i) {
    if (static_cast<double>(a.lo[i]) > static_cast<double>(b.hi[i]) ||
        static_cast<double>(b.lo[i]) > static_cast<double>(a.hi[i])) {
      return false;
    }
  }
  return true;
}

}  // namespace peerd::collision
