#pragma once
#include "collision/exact/expansion.hpp"

namespace peerd::collision {

// A number of twice the precision of binary64: the unevaluated sum of two, |low| at most half a unit in the last place
// of high. After T. J. Dekker, "A Floating-Point Technique for Extending the Available Precision", Numerische
// Mathematik 18 (1971), with the sum of Knuth; relative errors below 2^-100 where nothing over- or underflows. What is
// infinite becomes no number at all.
struct DoubleDouble {
  double high = 0.0, low = 0.0;

  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double x) : high(x) {}  // NOLINT: every binary64 number is one
  explicit constexpr DoubleDouble(const TwoTerms& sum) : high(sum.head), low(sum.tail) {}
  explicit operator double() const { return high; }
};

[[nodiscard]] inline DoubleDouble operator-(const DoubleDouble& a) {
  DoubleDouble out(-a.high);
  out.low = -a.low;
  return out;
}
[[nodiscard]] inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const TwoTerms high = two_sum(a.high, b.high), low = two_sum(a.low, b.low);
  const TwoTerms sum = fast_two_sum(high.head, high.tail + low.head);
  return DoubleDouble(fast_two_sum(sum.head, sum.tail + low.tail));
}
[[nodiscard]] inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
[[nodiscard]] inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const TwoTerms high = two_product(a.high, b.high, split(b.high));
  return DoubleDouble(fast_two_sum(high.head, high.tail + (a.high * b.low + a.low * b.high)));
}
[[nodiscard]] inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
  const double first = a.high / b.high;
  const double second = (a - b * first).high / b.high;
  const double third = (a - b * first - b * second).high / b.high;
  return DoubleDouble(fast_two_sum(first, second)) + third;
}
[[nodiscard]] inline bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
  return a.high < b.high || (a.high == b.high && a.low < b.low);
}
[[nodiscard]] inline bool operator>(const DoubleDouble& a, const DoubleDouble& b) { return b < a; }
[[nodiscard]] inline bool operator>=(const DoubleDouble& a, const DoubleDouble& b) {
  return a.high > b.high || (a.high == b.high && a.low >= b.low);
}
[[nodiscard]] inline bool operator<=(const DoubleDouble& a, const DoubleDouble& b) { return b >= a; }

}  // namespace peerd::collision
