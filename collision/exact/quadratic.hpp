#pragma once
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace peerd::collision {

// A closed interval of times [s]; empty when begin > end.
struct TimeInterval {
  double begin = std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();

  [[nodiscard]] static constexpr TimeInterval always() {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
};

// A set of at most two disjoint intervals of time, the earlier one first.
struct TimeSet {
  TimeInterval first, second;

  // The least member >= t; +inf when there is none.
  [[nodiscard]] double next(double t) const {
    if (first.begin <= first.end && t <= first.end) return t < first.begin ? first.begin : t;
    if (second.begin <= second.end && t <= second.end) return t < second.begin ? second.begin : t;
    return std::numeric_limits<double>::infinity();
  }
};

// c0 + c1 t + c2 t^2.
struct Quadratic {
  double c0 = 0.0, c1 = 0.0, c2 = 0.0;

  [[nodiscard]] double at(double t) const { return c0 + t * (c1 + t * c2); }
  [[nodiscard]] double rate(double t) const { return c1 + 2.0 * t * c2; }
};

// c1^2 - 4 c0 c2 without cancellation: where the two products nearly meet, their rounding errors are taken back by fma
// (Kahan, "On the cost of floating-point computation without extra-precise arithmetic", 2004). std::fma rounds once on
// every machine, so peers agree.
[[nodiscard]] inline double discriminant(const Quadratic& q) {
  const double square = q.c1 * q.c1, product = 4.0 * q.c0 * q.c2;
  const double d = square - product;
  if (3.0 * std::abs(d) >= square + std::abs(product)) return d;
  const double square_error = std::fma(q.c1, q.c1, -square);
  const double product_error = std::fma(4.0 * q.c0, q.c2, -product);
  return d + (square_error - product_error);
}

// Both real roots in order, for c2 != 0 and d = discriminant(q) >= 0. One root comes from the sum that can't cancel,
// the other from the product of the roots; as c2 -> 0 the far one grows to infinity and the near one becomes -c0/c1, so
// no threshold on c2 is needed.
[[nodiscard]] inline std::pair<double, double> roots(const Quadratic& q, double d) {
  assert(q.c2 != 0.0 && !(d < 0.0));
  const double w = -0.5 * (q.c1 + std::copysign(std::sqrt(d), q.c1));
  if (w == 0.0) return {0.0, 0.0};
  const double r = w / q.c2, s = q.c0 / w;
  return r < s ? std::pair{r, s} : std::pair{s, r};
}

// The set of all t with q(t) <= 0.
[[nodiscard]] inline TimeSet non_positive(const Quadratic& q) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  if (q.c2 == 0.0) {
    if (q.c1 == 0.0) return {q.c0 <= 0.0 ? TimeInterval::always() : TimeInterval{}, {}};
    const double root = -q.c0 / q.c1;
    return {q.c1 > 0.0 ? TimeInterval{-inf, root} : TimeInterval{root, inf}, {}};
  }
  const double d = discriminant(q);
  if (d < 0.0) return {q.c2 < 0.0 ? TimeInterval::always() : TimeInterval{}, {}};
  const auto [r, s] = roots(q, d);
  return q.c2 > 0.0 ? TimeSet{{r, s}, {}} : TimeSet{{-inf, r}, {s, inf}};
}

// The first t > 0 at which q, positive at 0, comes down to 0; +inf when it never does.
[[nodiscard]] inline double first_descent(const Quadratic& q) {
  const TimeSet set = non_positive(q);
  return set.next(0.0);
}

}  // namespace peerd::collision
