#include "collision/exact/orientation.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <initializer_list>
#include <optional>

#include "collision/exact/expansion.hpp"
#include "collision/exact/scaled_integers.hpp"

namespace peerd::collision {
namespace {

// Every bit of a coordinate is a multiple of 2^(exponent - 52), so within these bounds every bit of a product of three
// differences is at least 2^(3 * (-300 - 52)) = 2^-1056, and all sums stay below 2^(3 * 302 + 3). split() is safe too.
constexpr double kLeastCoordinate = 0x1p-300;
constexpr double kLargestCoordinate = 0x1p300;

bool in_range(std::initializer_list<double> coordinates) {
  double least = kLeastCoordinate, most = 0.0;
  for (const double x : coordinates) {
    const double size = std::abs(x);
    least = std::min(least, size == 0.0 ? kLeastCoordinate : size);
    most = std::max(most, size);
  }
  return least >= kLeastCoordinate && most <= kLargestCoordinate;
}

Expansion<2> exact_difference(double a, double b) { return Expansion<2>(two_difference(a, b)); }

Expansion<16> determinant(const Expansion<2>& a, const Expansion<2>& b, const Expansion<2>& c, const Expansion<2>& d) {
  return difference(product(a, d), product(b, c));
}

constexpr int kNext[] = {1, 2, 0}, kAfterNext[] = {2, 0, 1};

// Whether each product of the determinant has a factor that is 0: a common point, or a plane along two of the axes, as
// floors are. Where coordinates are equal, so that no rounding and no underflow is in it.
template <class LastIsZero>
bool every_product_is_zero(const Vec3& a, const Vec3& b, const Vec3& c, LastIsZero last_is_zero) {
  const auto zero = [&](int i, const Vec3& p) { return p[i] == a[i]; };
  for (int i = 0; i < 3; ++i) {
    const int j = kNext[i], k = kAfterNext[i];
    if (!last_is_zero(i) && !((zero(j, b) || zero(k, c)) && (zero(k, b) || zero(j, c)))) return false;
  }
  return true;
}

// A vector: its rounded coordinates and what was rounded away.
struct Difference {
  TwoTerms at[3];

  Difference(const Vec3& b, const Vec3& a) {
    for (int i = 0; i < 3; ++i) at[i] = two_difference(b[i], a[i]);
  }
  explicit Difference(const Vec3& direction) {
    for (int i = 0; i < 3; ++i) at[i] = {direction[i], 0.0};
  }
  [[nodiscard]] const TwoTerms& operator[](int i) const { return at[i]; }
  [[nodiscard]] bool exact() const { return at[0].tail == 0.0 && at[1].tail == 0.0 && at[2].tail == 0.0; }
};

// Three of them as rows of a matrix.
struct Differences {
  Difference u, v, w;
  [[nodiscard]] bool exact() const { return u.exact() && v.exact() && w.exact(); }
};

// Shewchuk's stage B: exact for the heads.
Expansion<24> determinant_of_heads(const Differences& m) {
  const auto minor = [&](int j, int k) {
    const auto exact_product = [](double a, double b) { return Expansion<2>(two_product(a, b, split(b))); };
    return difference(exact_product(m.u[j].head, m.v[k].head), exact_product(m.u[k].head, m.v[j].head));
  };
  const auto row = [&](int i) { return product(minor(kNext[i], kAfterNext[i]), m.w[i].head); };
  return sum(sum(row(0), row(1)), row(2));
}

// In place of Shewchuk's stage C: twice the precision, tails to first order, and without a branch. What it leaves out,
// the products of two tails and its own roundings, is below 70 u^2 times the permanent, and `error` is beyond that.
struct DoubleDoubleSum {
  double head, tail, error;

  [[nodiscard]] int sign() const {  // 0: uncertain
    const double value = head + tail;
    return (value > error) - (-value > error);
  }
};
DoubleDoubleSum in_double_double(const Differences& m) {
  double head = 0.0, tail = 0.0, permanent = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = kNext[i], k = kAfterNext[i];
    const TwoTerms &uj = m.u[j], &uk = m.u[k], &vj = m.v[j], &vk = m.v[k], &w = m.w[i];
    const TwoTerms plus = two_product(uj.head, vk.head, split(vk.head));
    const TwoTerms minus = two_product(uk.head, vj.head, split(vj.head));
    const TwoTerms minor = two_difference(plus.head, minus.head);
    const double minor_tail = (minor.tail + (plus.tail - minus.tail)) +
                              ((uj.head * vk.tail + vk.head * uj.tail) - (uk.head * vj.tail + vj.head * uk.tail));
    const TwoTerms term = two_product(w.head, minor.head, split(minor.head));
    const TwoTerms sum = two_sum(head, term.head);
    head = sum.head;
    tail += sum.tail + (term.tail + (w.head * minor_tail + w.tail * minor.head));
    permanent += (std::abs(plus.head) + std::abs(minus.head)) * std::abs(w.head);
  }
  return {head, tail, 128.0 * kUnitRoundoff * kUnitRoundoff * permanent};
}

Expansion<192> full_determinant(const Differences& m) {
  const auto row = [&](int i) {
    const int j = kNext[i], k = kAfterNext[i];
    const auto of = [](const TwoTerms& x) { return Expansion<2>(x); };
    return product(determinant(of(m.u[j]), of(m.u[k]), of(m.v[j]), of(m.v[k])), of(m.w[i]));
  };
  return sum(sum(row(0), row(1)), row(2));
}

int exact_sign(const Differences& m) {
  if (const int sign = in_double_double(m).sign(); sign != 0) return sign;
  return m.exact() ? determinant_of_heads(m).sign() : full_determinant(m).sign();
}

// An exact value in two numbers. At most 192 terms make as many roundings in the tail, each of at most that many tails
// of u of their sizes.
template <std::size_t N>
DoubleDoubleSum condensed(const Expansion<N>& x) {
  double head = 0.0, tail = 0.0, size = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const TwoTerms sum = two_sum(head, x[i]);
    head = sum.head;
    tail += sum.tail;
    size += std::abs(x[i]);
  }
  return {head, tail, 0x1p18 * kUnitRoundoff * kUnitRoundoff * size};
}

using Int = ScaledIntegers::Int;
struct IntVector {
  Int x[3];
};

IntVector minus(const ScaledIntegers& of, const Vec3& b, const Vec3& a) {
  IntVector out;
  for (int i = 0; i < 3; ++i) out.x[i] = of(b[i]) - of(a[i]);
  return out;
}

IntVector integers(const ScaledIntegers& of, const Vec3& direction) {
  return {{of(direction[0]), of(direction[1]), of(direction[2])}};
}

Int area(const IntVector& u, const IntVector& v, int i, int j) { return u.x[i] * v.x[j] - u.x[j] * v.x[i]; }

Int volume(const IntVector& u, const IntVector& v, const IntVector& w) {
  Int out = 0;
  for (int i = 0; i < 3; ++i) out += area(u, v, kNext[i], kAfterNext[i]) * w.x[i];
  return out;
}

// |numerator / denominator| * 2^exponent, to nearest, ties to even.
double rounded_quotient(Int numerator, Int denominator, int exponent) {
  assert(!denominator.is_zero());
  if (numerator.is_zero()) return 0.0;
  numerator = abs(numerator);
  denominator = abs(denominator);
  // A quotient of 55 or 56 bits; the last one is set, too, where there is more behind it.
  const int shift = 55 - (static_cast<int>(msb(numerator)) - static_cast<int>(msb(denominator)));
  if (shift > 0) numerator <<= shift;
  if (shift < 0) denominator <<= -shift;
  exponent -= shift;
  Int quotient, rest;
  divide_qr(numerator, denominator, quotient, rest);
  auto bits = static_cast<std::uint64_t>(quotient);
  if (!rest.is_zero()) bits |= 1;
  // Subnormal numbers have fewer bits than 53.
  const int drop = std::max(static_cast<int>(std::bit_width(bits)) - 53, -1074 - exponent);
  if (drop > 60) return 0.0;
  const std::uint64_t half = std::uint64_t{1} << (drop - 1), lost = bits & (2 * half - 1);
  bits >>= drop;
  if (lost > half || (lost == half && (bits & 1) != 0)) ++bits;
  return std::ldexp(static_cast<double>(bits), exponent + drop);
}

// The same, of two determinants in twice the precision; none where that leaves it open.
std::optional<double> rounded_quotient(const DoubleDoubleSum& a, const DoubleDoubleSum& b) {
  constexpr double kLeast = 0x1p-900;  // below that, tails would underflow
  const TwoTerms n = two_sum(a.head, a.tail), d = two_sum(b.head, b.tail);
  const double guess = n.head / d.head;
  if (!(std::abs(n.head) >= kLeast && std::abs(d.head) >= kLeast && std::abs(guess) >= kLeast)) return std::nullopt;
  const TwoTerms back = two_product(guess, d.head, split(d.head));
  const double correction = (((n.head - back.head) - back.tail) + (n.tail - guess * d.tail)) / d.head;
  const TwoTerms quotient = two_sum(guess, correction);
  // The errors of the two, at most 2 u |guess| of which a few u are wrong in the correction, and twice all that.
  const double error = 2.0 * ((a.error + std::abs(guess) * b.error) / std::abs(d.head) +
                              16.0 * kUnitRoundoff * kUnitRoundoff * std::abs(guess));
  const double low = quotient.head + (quotient.tail - error), high = quotient.head + (quotient.tail + error);
  if (!(low == quotient.head && high == quotient.head)) return std::nullopt;
  return std::abs(quotient.head);
}

}  // namespace

int volume_sign_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, OrientationCounters& counters) {
  ++counters.exact;
  if (d == b || d == c || every_product_is_zero(a, b, c, [&](int i) { return d[i] == a[i]; })) return 0;
  if (in_range({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]})) {
    return exact_sign({{b, a}, {c, a}, {d, a}});
  }
  ++counters.wide;
  const ScaledIntegers of({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]});
  return volume(minus(of, b, a), minus(of, c, a), minus(of, d, a)).sign();
}

int volume_sign_along_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& direction,
                            OrientationCounters& counters) {
  ++counters.exact;
  if (every_product_is_zero(a, b, c, [&](int i) { return direction[i] == 0.0; })) return 0;
  const Vec3& d = direction;
  if (in_range({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]})) {
    return exact_sign({{b, a}, {c, a}, Difference(d)});
  }
  ++counters.wide;
  const ScaledIntegers of({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]}), along({d[0], d[1], d[2]});
  return volume(minus(of, b, a), minus(of, c, a), integers(along, d)).sign();
}

int orient2d_exact(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j, OrientationCounters& counters) {
  ++counters.exact;
  if (in_range({a[i], a[j], b[i], b[j], c[i], c[j]})) {
    return determinant(exact_difference(b[i], a[i]), exact_difference(b[j], a[j]), exact_difference(c[i], a[i]),
                       exact_difference(c[j], a[j]))
        .sign();
  }
  ++counters.wide;
  const ScaledIntegers of({a[i], a[j], b[i], b[j], c[i], c[j]});
  const Int turn = (of(b[i]) - of(a[i])) * (of(c[j]) - of(a[j])) - (of(b[j]) - of(a[j])) * (of(c[i]) - of(a[i]));
  return turn.sign();
}

int orient2d_along_exact(const Vec3& a, const Vec3& b, const Vec3& direction, int i, int j,
                         OrientationCounters& counters) {
  ++counters.exact;
  const Vec3& d = direction;
  if (in_range({a[i], a[j], b[i], b[j], d[i], d[j]})) {
    const auto of = [](double x) { return Expansion<2>(TwoTerms{x, 0.0}); };
    return determinant(exact_difference(b[i], a[i]), exact_difference(b[j], a[j]), of(d[i]), of(d[j])).sign();
  }
  ++counters.wide;
  const ScaledIntegers of({a[i], a[j], b[i], b[j]}), along({d[i], d[j]});
  const Int turn = (of(b[i]) - of(a[i])) * along(d[j]) - (of(b[j]) - of(a[j])) * along(d[i]);
  return turn.sign();
}

double plane_parameter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& origin, const Vec3& direction,
                       OrientationCounters& counters) {
  const Vec3 &o = origin, &d = direction;
  if (in_range({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], o[0], o[1], o[2], d[0], d[1], d[2]})) {
    const Difference u(b, a), v(c, a);
    const Differences height{u, v, {a, o}}, descent{u, v, Difference(d)};
    if (const auto t = rounded_quotient(in_double_double(height), in_double_double(descent))) return *t;
    if (const auto t = rounded_quotient(condensed(full_determinant(height)), condensed(full_determinant(descent)))) {
      return *t;
    }
  }
  ++counters.quotients;
  const ScaledIntegers of({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], o[0], o[1], o[2]}),
      along({d[0], d[1], d[2]});
  const IntVector u = minus(of, b, a), v = minus(of, c, a);
  return rounded_quotient(volume(u, v, minus(of, a, o)), volume(u, v, integers(along, d)),
                          of.exponent() - along.exponent());
}

double line_parameter(const Vec3& a, const Vec3& b, const Vec3& origin, const Vec3& direction, int i, int j,
                      OrientationCounters& counters) {
  const Vec3 &o = origin, &d = direction;
  if (in_range({a[i], a[j], b[i], b[j], o[i], o[j], d[i], d[j]})) {
    const auto of = [](double x) { return Expansion<2>(TwoTerms{x, 0.0}); };
    const auto height = determinant(exact_difference(a[i], o[i]), exact_difference(a[j], o[j]),
                                    exact_difference(b[i], o[i]), exact_difference(b[j], o[j]));
    const auto descent = determinant(of(d[i]), of(d[j]), exact_difference(b[i], a[i]), exact_difference(b[j], a[j]));
    if (const auto t = rounded_quotient(condensed(height), condensed(descent))) return *t;
  }
  ++counters.quotients;
  const ScaledIntegers of({a[i], a[j], b[i], b[j], o[i], o[j]}), along({d[i], d[j]});
  const auto difference = [&](const Vec3& p, const Vec3& q, int k) { return Int(of(p[k]) - of(q[k])); };
  return rounded_quotient(difference(a, o, i) * difference(b, o, j) - difference(a, o, j) * difference(b, o, i),
                          along(d[i]) * difference(b, a, j) - along(d[j]) * difference(b, a, i),
                          of.exponent() - along.exponent());
}

double point_parameter(const Vec3& a, const Vec3& origin, const Vec3& direction, int i, OrientationCounters& counters) {
  const TwoTerms to = two_difference(a[i], origin[i]);
  if (to.head == 0.0) return 0.0;
  if (in_range({a[i], origin[i], direction[i]})) {
    if (const auto t = rounded_quotient({to.head, to.tail, 0.0}, {direction[i], 0.0, 0.0})) return *t;
  }
  ++counters.quotients;
  const ScaledIntegers of({a[i], origin[i]}), along({direction[i]});
  return rounded_quotient(of(a[i]) - of(origin[i]), along(direction[i]), of.exponent() - along.exponent());
}

}  // namespace peerd::collision
