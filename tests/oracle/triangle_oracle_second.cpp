// Linear programming: weights l, m >= 0 with
//   l0 a0 + l1 a1 + l2 a2 - m0 b0 - m1 b1 - m2 b2 = 0   (three rows, one an axis),   sum l = 1,   sum m = 1.
// Phase one of the simplex method minimizes the sum of one artificial variable a row. It reaches zero if there are such
// weights, which are then a common point. Else its dual (d, s, t) has d.a_i + s <= 0, t - d.b_j <= 0 and s + t > 0, so
// that d.a_i <= -s < t <= d.b_j: d separates. No case depends on how degenerate the triangles are.
#include "tests/oracle/triangle_oracle_second.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

namespace peerd::oracle {
namespace {

using Integer = mpz_class;
using Rational = mpq_class;
using Direction = std::array<Rational, 3>;

// Points: a0 a1 a2 b0 b1 b2.
Point point_of(const Triangle& a, const Triangle& b, std::size_t i) { return i < 3 ? a[i] : b[i - 3]; }

// The tableau holds integers over one common denominator (Edmonds 1967; Avis, "lrs", 2000): each division is exact.
class PhaseOne {
 public:
  PhaseOne(const Triangle& a, const Triangle& b) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 6; ++i) lcm(scale_[k], Rational(point_of(a, b, i)[k]).get_den());
      for (std::size_t i = 0; i < 6; ++i) {
        const Rational coordinate = Rational(point_of(a, b, i)[k]) * scale_[k];
        table_[k][i] = i < 3 ? coordinate.get_num() : Integer(-coordinate.get_num());
      }
    }
    for (std::size_t i = 0; i < 6; ++i) table_[i < 3 ? 3 : 4][i] = 1;
    table_[3][kRight] = table_[4][kRight] = 1;
    for (std::size_t row = 0; row < kRows; ++row) {
      basis_[row] = kReal + row;
      table_[row][kReal + row] = 1;
      for (std::size_t column = 0; column < kColumns; ++column) {
        if (column < kReal || column == kRight) table_[kCost][column] -= table_[row][column];
      }
    }
  }

  // Bland's rule, the lowest index always, which cannot cycle. An artificial variable that has left does not return.
  void solve() {
    while (const std::optional<std::size_t> column = entering()) pivot(leaving(*column), *column);
  }

  bool feasible() const { return sgn(table_[kCost][kRight]) == 0; }

  // The points a0 a1 a2 b0 b1 b2, all times common().
  std::array<Integer, 6> weights() const {
    std::array<Integer, 6> result;
    for (std::size_t row = 0; row < kRows; ++row) {
      if (basis_[row] < kReal) result[basis_[row]] = table_[row][kRight];
    }
    return result;
  }
  const Integer& common() const { return denominator_; }

  // The dual of a row is 1 less the reduced cost of its artificial variable; each axis' row was scaled.
  Direction direction() const {
    Direction result;
    for (std::size_t k = 0; k < 3; ++k) result[k] = scale_[k] * (denominator_ - table_[kCost][kReal + k]);
    return result;
  }

 private:
  static constexpr std::size_t kRows = 5, kCost = kRows, kReal = 6, kRight = kReal + kRows, kColumns = kRight + 1;

  static void lcm(Integer& sum, const Integer& value) { mpz_lcm(sum.get_mpz_t(), sum.get_mpz_t(), value.get_mpz_t()); }

  std::optional<std::size_t> entering() const {
    for (std::size_t column = 0; column < kReal; ++column) {
      if (sgn(table_[kCost][column]) < 0) return column;
    }
    return std::nullopt;
  }

  std::size_t leaving(std::size_t column) const {
    std::optional<std::size_t> best;
    for (std::size_t row = 0; row < kRows; ++row) {
      if (sgn(table_[row][column]) <= 0) continue;
      if (best) {  // the lowest ratio right / entry
        const Integer here = table_[row][kRight] * table_[*best][column];
        const Integer there = table_[*best][kRight] * table_[row][column];
        if (here > there || (here == there && basis_[row] > basis_[*best])) continue;
      }
      best = row;
    }
    if (!best) throw std::logic_error("a sum of weights without a lower bound");
    return *best;
  }

  void pivot(std::size_t row, std::size_t column) {
    const Integer by = table_[row][column];
    for (std::size_t i = 0; i <= kCost; ++i) {
      if (i == row) continue;
      const Integer factor = table_[i][column];
      for (std::size_t j = 0; j < kColumns; ++j) {
        Integer& entry = table_[i][j];
        entry *= by;
        if (sgn(factor) != 0) entry -= factor * table_[row][j];
        mpz_divexact(entry.get_mpz_t(), entry.get_mpz_t(), denominator_.get_mpz_t());
      }
    }
    denominator_ = by;
    basis_[row] = column;
  }

  std::array<std::array<Integer, kColumns>, kRows + 1> table_;
  std::array<std::size_t, kRows> basis_{};
  Integer denominator_ = 1;
  std::array<Integer, 3> scale_{1, 1, 1};
};

bool is_common_point(const Triangle& a, const Triangle& b, const std::array<Integer, 6>& weights) {
  if (std::ranges::any_of(weights, [](const Integer& weight) { return sgn(weight) < 0; })) return false;
  const Integer sum_a = weights[0] + weights[1] + weights[2], sum_b = weights[3] + weights[4] + weights[5];
  if (sum_a != sum_b || sgn(sum_a) == 0) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    Rational in_a, in_b;
    for (std::size_t i = 0; i < 3; ++i) {
      in_a += weights[i] * Rational(a[i][k]);
      in_b += weights[i + 3] * Rational(b[i][k]);
    }
    if (in_a != in_b) return false;
  }
  return true;
}

bool separates(const Triangle& a, const Triangle& b, const Direction& direction) {
  const auto along = [&](const Point& point) {
    return Rational(direction[0] * Rational(point[0]) + direction[1] * Rational(point[1]) +
                    direction[2] * Rational(point[2]));
  };
  return std::max({along(a[0]), along(a[1]), along(a[2])}) < std::min({along(b[0]), along(b[1]), along(b[2])});
}

}  // namespace

bool touch_by_simplex(const Triangle& a, const Triangle& b) {
  PhaseOne problem(a, b);
  problem.solve();
  const bool proved =
      problem.feasible() ? is_common_point(a, b, problem.weights()) : separates(a, b, problem.direction());
  if (!proved) throw std::logic_error("the answer has no proof");
  return problem.feasible();
}

}  // namespace peerd::oracle
