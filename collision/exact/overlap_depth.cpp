#include "collision/exact/overlap_depth.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "collision/exact/infinity.hpp"
#include "collision/exact/ordered_sums.hpp"
#include "collision/exact/orientation.hpp"
#include "collision/exact/scaled_integers.hpp"

namespace peerd::collision {
namespace {

using Int = ScaledIntegers::Int;

// An edge, from one corner of a triangle to another.
struct Edge {
  const Vec3 *from, *to;
  [[nodiscard]] Vec3 vector() const { return *to - *from; }
};

// Each difference of a corner of A and one of B, rounded once.
using CornerDifferences = std::array<Vec3, 9>;

// The product of two edges, and bounds of what its components are off by: 2^-53 times 3 for each of the two products,
// and 1 for their difference.
struct ProjectedAxis {
  Vec3 n, error;
  bool zero = true;  // certainly

  ProjectedAxis(const Vec3& u, const Vec3& v) {
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const double plus = u[i] * v[j], minus = u[j] * v[i];
      n[k] = plus - minus;
      error[k] = 8.0 * kUnitRoundoff * (std::abs(plus) + std::abs(minus)) + kUnderflow;
      // A difference is 0 only where the two numbers are equal.
      zero = zero && (u[i] == 0.0 || v[j] == 0.0) && (u[j] == 0.0 || v[i] == 0.0);
    }
  }
  // Whether the direction is known to 2^-36, and squares of the components are far from an underflow.
  [[nodiscard]] bool is_accurate() const {
    const double most = n.cwiseAbs().maxCoeff();
    return magnitude(error) <= 0x1p-36 * most && most > 0x1p-400;
  }
};

// The lesser depth along an axis, to both sides, rounded down; 0 where it may be none. Of each n.d the error is that of
// n times |d|, and 2^-53 of |n| |d| for each of a difference, three products and two sums.
double depth_along(const ProjectedAxis& axis, const CornerDifferences& differences) {
  assert(axis.is_accurate());
  double forth = -kInfinity, back = -kInfinity;
  for (const Vec3& d : differences) {
    const double along = dot(axis.n, d);
    const Vec3 sizes = d.cwiseAbs();
    const double off = dot(axis.error, sizes) + 8.0 * kUnitRoundoff * dot(axis.n.cwiseAbs(), sizes) + kUnderflow;
    forth = std::max(forth, along - off);
    back = std::max(back, -along - off);
  }
  const double depth = std::min(forth, back);
  if (!(depth > 0.0)) return 0.0;
  return depth / length(axis.n.cwiseAbs() + axis.error) * (1.0 - 0x1p-49);
}

// The root of square / divisor, times 2^exponent, rounded down.
double root_of_quotient(const Int& square, const Int& divisor, int exponent) {
  assert(square > 0 && divisor > 0);
  // The root gets 64 bits or more, of which as many are kept.
  const int missing_bits = 130 + static_cast<int>(msb(divisor)) - static_cast<int>(msb(square));
  const int shift = std::max(0, (missing_bits + 1) / 2);
  Int root = sqrt(Int((square << (2 * shift)) / divisor));
  const int dropped = std::max(0, static_cast<int>(msb(root)) - 63);
  root >>= dropped;
  const double rounded = std::ldexp(static_cast<double>(root) * (1.0 - 0x1p-51), exponent - shift + dropped);
  return rounded > 0x1p-1000 ? rounded : 0.0;
}

// The depth along an axis by integers, for edges that are parallel but for rounding. Where they are so exactly, the
// axis is none.
double depth_along_exact(const Edge& u, const Edge& v, const Triangle& a, const Triangle& b) {
  using Vector = std::array<Int, 3>;
  const ScaledIntegers scaled{a[0][0], a[0][1], a[0][2], a[1][0], a[1][1], a[1][2], a[2][0], a[2][1], a[2][2],
                              b[0][0], b[0][1], b[0][2], b[1][0], b[1][1], b[1][2], b[2][0], b[2][1], b[2][2]};
  const auto difference = [&](const Vec3& p, const Vec3& q) {
    return Vector{scaled(p[0]) - scaled(q[0]), scaled(p[1]) - scaled(q[1]), scaled(p[2]) - scaled(q[2])};
  };
  const auto product = [](const Vector& p, const Vector& q) { return Int(p[0] * q[0] + p[1] * q[1] + p[2] * q[2]); };
  const Vector e = difference(*u.to, *u.from), f = difference(*v.to, *v.from);
  const Vector n{e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
  const Int square = product(n, n);
  if (square == 0) return kInfinity;
  Int forth = product(n, difference(a[0], b[0])), back = -forth;
  for (const Vec3& p : a) {
    for (const Vec3& q : b) {
      const Int along = product(n, difference(p, q));
      forth = std::max(forth, along);
      back = std::max(back, Int(-along));
    }
  }
  const Int depth = std::min(forth, back);
  return depth > 0 ? root_of_quotient(Int(depth * depth), square, scaled.exponent()) : 0.0;
}

}  // namespace

double overlap_depth_m(const Triangle& a, const Triangle& b) {
  CornerDifferences differences;
  for (std::size_t i = 0; i < 9; ++i) differences[i] = a[i / 3] - b[i % 3];
  double least = kInfinity;
  const auto consider = [&](const Edge& u, const Edge& v) {
    if (least == 0.0) return;
    const ProjectedAxis axis(u.vector(), v.vector());
    if (axis.zero) return;
    least = std::min(least, axis.is_accurate() ? depth_along(axis, differences) : depth_along_exact(u, v, a, b));
  };
  const auto edge = [](const Triangle& t, std::size_t i) { return Edge{&t[i], &t[(i + 1) % 3]}; };
  for (const Triangle* const face : {&a, &b}) consider(edge(*face, 0), edge(*face, 1));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) consider(edge(a, i), edge(b, j));
  }
  assert(least >= 0.0);
  return least < kInfinity ? least : 0.0;  // without any axis both are of one line
}

}  // namespace peerd::collision
