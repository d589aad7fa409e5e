#pragma once
#include <array>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <limits>

namespace peerd::collision {

// Exact sums and products of binary64 numbers, after J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and
// Fast Robust Geometric Predicates", Discrete & Computational Geometry 18 (1997), sections 2.4 to 2.8. A value is an
// unevaluated sum of binary64 terms that do not overlap, smallest first. Exact as long as nothing over- or underflows:
// every bit of every product must lie within 2^-1074 .. 2^1023, which the caller has made sure of.

// Dekker, Knuth and Veltkamp need binary64 rounded to nearest after each operation.
static_assert(std::numeric_limits<double>::is_iec559 && std::numeric_limits<double>::digits == 53);
static_assert(FLT_EVAL_METHOD == 0);

// a + b = head + tail, head being the rounded sum.
struct TwoTerms {
  double head, tail;
};

// Theorem 7 (Knuth).
[[nodiscard]] inline TwoTerms two_sum(double a, double b) {
  const double head = a + b;
  const double b_part = head - a;
  const double a_part = head - b_part;
  return {head, (a - a_part) + (b - b_part)};
}

// Theorem 6 (Dekker): |a| >= |b|.
[[nodiscard]] inline TwoTerms fast_two_sum(double a, double b) {
  const double head = a + b;
  return {head, b - (head - a)};
}

[[nodiscard]] inline TwoTerms two_difference(double a, double b) { return two_sum(a, -b); }

// Theorem 17 (Veltkamp): 26 bits and the rest.
[[nodiscard]] inline TwoTerms split(double a) {
  const double c = 134217729.0 * a;  // 2^27 + 1
  const double head = c - (c - a);
  return {head, a - head};
}

// Theorem 18 (Dekker). `b_halves` is split(b), which a caller that multiplies by b often makes once. Without fma, which
// not every machine that must agree has.
[[nodiscard]] inline TwoTerms two_product(double a, double b, const TwoTerms& b_halves) {
  const double head = a * b;
  const TwoTerms a_halves = split(a);
  const double rest =
      ((head - a_halves.head * b_halves.head) - a_halves.tail * b_halves.head) - a_halves.head * b_halves.tail;
  return {head, a_halves.tail * b_halves.tail - rest};
}

// An expansion has at most N terms, none of them zero.
template <std::size_t N>
class Expansion {
 public:
  static_assert(N >= 2);
  Expansion() = default;
  explicit Expansion(const TwoTerms& two) {
    append(two.tail);
    append(two.head);
  }

  void append(double term) {
    if (term != 0.0) terms_[size_++] = term;
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double operator[](std::size_t i) const { return terms_[i]; }
  // The largest term outweighs all others.
  [[nodiscard]] int sign() const { return size_ == 0 ? 0 : terms_[size_ - 1] > 0.0 ? 1 : -1; }

 private:
  std::array<double, N> terms_;  // terms beyond size_ are never read
  std::size_t size_ = 0;
};

// fast_expansion_sum of section 2.4, zero terms left out; with b negated where `sign_of_b` is -1.
template <std::size_t M, std::size_t N>
[[nodiscard]] Expansion<M + N> sum(const Expansion<M>& a, const Expansion<N>& b, double sign_of_b = 1.0) {
  Expansion<M + N> out;
  std::size_t i = 0, j = 0;
  const auto smaller = [&] {
    const bool from_a = j == b.size() || (i < a.size() && std::abs(a[i]) < std::abs(b[j]));
    return from_a ? a[i++] : sign_of_b * b[j++];
  };
  const std::size_t count = a.size() + b.size();
  if (count == 0) return out;
  double carried = smaller();
  for (std::size_t n = 1; n < count; ++n) {
    const TwoTerms step = two_sum(carried, smaller());
    out.append(step.tail);
    carried = step.head;
  }
  out.append(carried);
  return out;
}

template <std::size_t M, std::size_t N>
[[nodiscard]] Expansion<M + N> difference(const Expansion<M>& a, const Expansion<N>& b) {
  return sum(a, b, -1.0);
}

// scale_expansion of section 2.5, zero terms left out.
template <std::size_t M>
[[nodiscard]] Expansion<2 * M> product(const Expansion<M>& a, double b) {
  Expansion<2 * M> out;
  if (a.size() == 0 || b == 0.0) return out;
  const TwoTerms b_halves = split(b);
  const TwoTerms first = two_product(a[0], b, b_halves);
  out.append(first.tail);
  double carried = first.head;
  for (std::size_t i = 1; i < a.size(); ++i) {
    const TwoTerms term = two_product(a[i], b, b_halves);
    const TwoTerms low = two_sum(carried, term.tail);
    out.append(low.tail);
    const TwoTerms high = fast_two_sum(term.head, low.head);
    out.append(high.tail);
    carried = high.head;
  }
  out.append(carried);
  return out;
}

template <std::size_t M>
[[nodiscard]] Expansion<4 * M> product(const Expansion<M>& a, const Expansion<2>& b) {
  if (b.size() == 0) return {};
  const Expansion<2 * M> low = product(a, b[0]);
  return sum(low, b.size() == 1 ? Expansion<2 * M>() : product(a, b[1]));
}

}  // namespace peerd::collision
