#include "collision/tree/realignment.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace peerd::collision {
namespace {

// A direction as multiples of three of the k directions, each times a sign.
struct Combination {
  std::array<std::array<int, 3>, 3> directions;
  std::array<double, 3> weights;
};

// Serves directions with a >= b >= c >= 0. The unit normals of a k-DOP are the corners of a polytope that is symmetric
// under exchange and reflection of axes, so its facets over this sixth of an octant serve all directions.
template <int K>
Combination in_sorted_octant(double a, double b, double c) {
  assert(!(a < b) && !(b < c) && !(c < 0.0));
  if constexpr (K == 6) return {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {a, b, c}};
  if constexpr (K == 14) return {{{{1, 0, 0}, {1, 1, 1}, {1, 1, -1}}}, {a - b, (b + c) / 2, (b - c) / 2}};
  if constexpr (K == 26) return {{{{1, 0, 0}, {1, 1, 0}, {1, 1, 1}}}, {a - b, b - c, c}};
  if constexpr (K == 18) {
    if (b + c >= a) return {{{{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}}, {(a + b - c) / 2, (a + c - b) / 2, (b + c - a) / 2}};
    return {{{{1, 0, 0}, {1, 1, 0}, {1, 0, 1}}}, {a - b - c, b, c}};
  }
}

template <int K>
Combination combination_for(const Vec3& d) {
  std::array<int, 3> axis = {0, 1, 2};
  std::ranges::stable_sort(axis, std::greater(), [&](int i) { return std::abs(d[i]); });
  const Combination sorted = in_sorted_octant<K>(std::abs(d[axis[0]]), std::abs(d[axis[1]]), std::abs(d[axis[2]]));
  Combination out = sorted;
  for (std::size_t m = 0; m < 3; ++m) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto to = static_cast<std::size_t>(axis[i]);
      out.directions[m][to] = d[axis[i]] < 0.0 ? -sorted.directions[m][i] : sorted.directions[m][i];
    }
    out.weights[m] = std::max(0.0, sorted.weights[m]);  // rounding; the residual pays for it
  }
  return out;
}

// The slab of a direction, and whether the direction is the slab's or the opposite one.
template <int K>
std::pair<std::uint32_t, double> slab_of(const std::array<int, 3>& direction) {
  constexpr auto all = kdop_directions<K>();
  const std::array<int, 3> opposite = {-direction[0], -direction[1], -direction[2]};
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    if (all[i] == direction) return {i, 1.0};
    if (all[i] == opposite) return {i, -1.0};
  }
  std::unreachable();
}

}  // namespace

template <int K>
Realignment<K>::Realignment(const RelativeMotion& new_from_old, double extent_m) {
  constexpr auto directions = kdop_directions<K>();
  assert(extent_m >= 0.0);
  const Mat3 back = new_from_old.rotation.transpose();
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Vec3 d(directions[i][0], directions[i][1], directions[i][2]);
    const Vec3 in_old = multiply(back, d);
    const Combination combination = combination_for<K>(in_old);
    Vec3 residual = in_old;
    for (std::size_t m = 0; m < 3; ++m) {
      const auto [slab, sign] = slab_of<K>(combination.directions[m]);
      terms_[i][m] = {sign * combination.weights[m], slab};
      for (int k = 0; k < 3; ++k)
        residual[k] -= combination.weights[m] * combination.directions[m][static_cast<std::size_t>(k)];
    }
    offset_[i] = along(directions[i], new_from_old.translation);
    // The padding covers what the combination misses of the direction, and 64 roundings of the largest numbers that
    // occur: here, in the sums of a node's slabs, and in new_from_old(vertex).
    const double missed = std::abs(residual[0]) + std::abs(residual[1]) + std::abs(residual[2]);
    const Vec3& t = new_from_old.translation;
    const double largest = 3.0 * extent_m + (std::abs(t[0]) + std::abs(t[1]) + std::abs(t[2]));
    assert(!(missed < 0.0));
    pad_[i] = (missed + 0x1p-52) * 2.0 * extent_m + 64 * 0x1p-53 * largest + 0x1p-1000;  // and any underflow
  }
}

template class Realignment<6>;
template class Realignment<14>;
template class Realignment<18>;
template class Realignment<26>;

}  // namespace peerd::collision
