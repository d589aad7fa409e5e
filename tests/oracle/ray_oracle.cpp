// The triangle is {a + u (b - a) + v (c - a) : u, v, 1 - u - v >= 0}, so the ray meets it where
//   t d = (a - o) + u e + v f,   0 <= t, 0 <= u, 0 <= v, u + v <= 1:
// three linear equations for t, u and v. Gauss's elimination solves them, whatever their rank is; what stays free is a
// polygon or a segment of (t, u, v), whose least t is at a corner, where as many of the bounds are met with equality as
// there are free unknowns. So all ways of choosing up to three bounds are tried, each added as an equation; where the
// solution is then a single point and keeps all bounds, it is a candidate.
#include "tests/oracle/ray_oracle.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace peerd::oracle {
namespace {

using Rational = mpq_class;
using Row = std::array<Rational, 4>;  // of t, u, v, and the right side

// The solution, if there is exactly one.
std::optional<std::array<Rational, 3>> solve(std::vector<Row> rows) {
  for (std::size_t column = 0; column < 3; ++column) {
    std::size_t pivot = column;
    while (pivot < rows.size() && sgn(rows[pivot][column]) == 0) ++pivot;
    if (pivot == rows.size()) return std::nullopt;
    std::swap(rows[column], rows[pivot]);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (r == column || sgn(rows[r][column]) == 0) continue;
      const Rational factor = rows[r][column] / rows[column][column];
      for (std::size_t k = 0; k < 4; ++k) rows[r][k] -= factor * rows[column][k];
    }
  }
  for (std::size_t r = 3; r < rows.size(); ++r) {
    if (sgn(rows[r][3]) != 0) return std::nullopt;
  }
  return std::array<Rational, 3>{rows[0][3] / rows[0][0], rows[1][3] / rows[1][1], rows[2][3] / rows[2][2]};
}

double nearest(const Rational& x) {
  double low = x.get_d();  // towards zero
  double high = std::nextafter(low, std::numeric_limits<double>::infinity());
  while (Rational(low) > x) high = std::exchange(low, std::nextafter(low, -1.0));
  const Rational below = x - Rational(low), above = Rational(high) - x;
  if (below != above) return below < above ? low : high;
  int exponent = 0;
  const double significand = std::frexp(low, &exponent);
  const int bits = std::min(53, exponent + 1074);
  return std::fmod(std::ldexp(significand, bits), 2.0) == 0.0 ? low : high;
}

}  // namespace

std::optional<double> first_parameter(const Point& origin, const Point& direction, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  std::vector<Row> equations;
  for (std::size_t k = 0; k < 3; ++k) {
    const Rational o(origin[k]), d(direction[k]), at_a(a[k]), at_b(b[k]), at_c(c[k]);
    equations.push_back({d, at_a - at_b, at_a - at_c, at_a - o});
  }
  const std::array<Row, 4> bounds = {Row{1, 0, 0, 0}, Row{0, 1, 0, 0}, Row{0, 0, 1, 0}, Row{0, 1, 1, 1}};
  std::optional<Rational> least;
  for (unsigned chosen = 0; chosen < 16; ++chosen) {
    std::vector<Row> rows = equations;
    for (std::size_t i = 0; i < 4; ++i) {
      if ((chosen >> i & 1u) != 0) rows.push_back(bounds[i]);
    }
    const auto x = solve(std::move(rows));
    if (!x) continue;
    const auto& [t, u, v] = *x;
    if (sgn(t) >= 0 && sgn(u) >= 0 && sgn(v) >= 0 && u + v <= 1 && (!least || t < *least)) least = t;
    if (chosen == 0) break;  // nothing is free: there is no other
  }
  if (!least) return std::nullopt;
  return nearest(*least);
}

}  // namespace peerd::oracle
