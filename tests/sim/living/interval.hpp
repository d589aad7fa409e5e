#pragma once
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

// Interval arithmetic (Moore 1966): an operation's result holds what the exact operation gives for any numbers of its
// operands. Nothing overflows at the sizes of a living world.
namespace peerd::living {

// The next number down or up, or one a little farther: a number's ulp is at most 2^-52 of it, and every operation of
// IEEE 754 is within half an ulp of the exact result.
[[nodiscard]] inline double down(double x) { return x - std::abs(x) * 0x1p-52 - 1e-300; }
[[nodiscard]] inline double up(double x) { return x + std::abs(x) * 0x1p-52 + 1e-300; }

struct Interval {
  double lo = 0.0, hi = 0.0;

  constexpr Interval() = default;
  constexpr Interval(double exact) : lo(exact), hi(exact) {}  // NOLINT: a number is an interval
  constexpr Interval(double low, double high) : lo(low), hi(high) { assert(low <= high); }
  [[nodiscard]] double mid() const { return 0.5 * (lo + hi); }
  // How far any number of it is from mid(), at most.
  [[nodiscard]] double radius() const { return up(std::max(hi - mid(), mid() - lo)); }
};

inline Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }
inline Interval operator+(const Interval& a, const Interval& b) { return {down(a.lo + b.lo), up(a.hi + b.hi)}; }
inline Interval operator-(const Interval& a, const Interval& b) { return {down(a.lo - b.hi), up(a.hi - b.lo)}; }
inline Interval operator*(const Interval& a, const Interval& b) {
  const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  return {down(std::min({p, q, r, s})), up(std::max({p, q, r, s}))};
}
// The divisor does not hold 0.
inline Interval operator/(const Interval& a, const Interval& b) {
  assert(b.lo > 0.0 || b.hi < 0.0);
  const double p = a.lo / b.lo, q = a.lo / b.hi, r = a.hi / b.lo, s = a.hi / b.hi;
  return {down(std::min({p, q, r, s})), up(std::max({p, q, r, s}))};
}
[[nodiscard]] inline Interval square_root(const Interval& a) {
  return {std::max(0.0, down(std::sqrt(std::max(a.lo, 0.0)))), up(std::sqrt(std::max(a.hi, 0.0)))};
}

// Sine and cosine by Taylor's series, for angles of -3.5 to 3.5 rad. Terms alternate and, from the sixth on, fall, so
// the rest of the series is within the first term that is left out.
[[nodiscard]] inline Interval series(const Interval& first, const Interval& x, int index) {
  assert(x.lo >= -3.5 && x.hi <= 3.5);
  Interval sum = first, term = first;
  const Interval square = x * x;
  for (int k = index; k < index + 36; k += 2) {
    term = -(term * square / Interval(double(k) * (k + 1)));
    sum = sum + term;
  }
  const double rest = std::max(std::abs(term.lo), std::abs(term.hi));
  return sum + Interval(-rest, rest);
}
[[nodiscard]] inline Interval sine(const Interval& x) { return series(x, x, 2); }
[[nodiscard]] inline Interval cosine(const Interval& x) { return series(Interval(1.0), x, 1); }

// The angle of 0 to pi/2 whose cosine is that: a guess, widened until the cosines of its ends enclose it.
[[nodiscard]] inline Interval arc_cosine(const Interval& cosine_of) {
  assert(cosine_of.lo > 0.0);
  const double guess = std::acos(std::min(cosine_of.mid(), 1.0));
  for (double width = 1e-16;; width *= 2.0) {
    const Interval angle(std::max(0.0, guess - width), guess + width);
    const bool low_enough = angle.lo == 0.0 || cosine(Interval(angle.lo)).lo >= cosine_of.hi;
    if (low_enough && cosine(Interval(angle.hi)).hi <= cosine_of.lo) return angle;
  }
}

using Point = std::array<Interval, 3>;

inline Point operator+(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
[[nodiscard]] inline Interval dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
[[nodiscard]] inline Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

using Matrix = std::array<Point, 3>;  // rows

[[nodiscard]] inline Point times(const Matrix& m, const Point& p) { return {dot(m[0], p), dot(m[1], p), dot(m[2], p)}; }
[[nodiscard]] inline Matrix transposed(const Matrix& m) {
  Matrix out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) out[i][k] = m[k][i];
  }
  return out;
}
[[nodiscard]] inline Matrix times(const Matrix& a, const Matrix& b) {
  const Matrix columns = transposed(b);
  Matrix out;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point column = times(a, columns[k]);
    for (std::size_t i = 0; i < 3; ++i) out[i][k] = column[i];
  }
  return out;
}

// A map of p to linear * p + offset.
struct Map {
  Matrix linear{Point{1.0, 0.0, 0.0}, Point{0.0, 1.0, 0.0}, Point{0.0, 0.0, 1.0}};
  Point offset{};
};
[[nodiscard]] inline Point times(const Map& m, const Point& p) { return times(m.linear, p) + m.offset; }
[[nodiscard]] inline Map times(const Map& a, const Map& b) {
  return {times(a.linear, b.linear), times(a.linear, b.offset) + a.offset};
}

}  // namespace peerd::living
