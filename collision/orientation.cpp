#include "collision/orientation.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <initializer_list>
#include <limits>

#include "collision/expansion.hpp"

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
bool every_product_is_zero(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto zero = [&](int i, const Vec3& p) { return p[i] == a[i]; };
  for (int i = 0; i < 3; ++i) {
    const int j = kNext[i], k = kAfterNext[i];
    if (!zero(i, d) && !((zero(j, b) || zero(k, c)) && (zero(k, b) || zero(j, c)))) return false;
  }
  return true;
}

// Three vectors as rows: their rounded coordinates and what was rounded away.
struct Differences {
  TwoTerms u[3], v[3], w[3];

  Differences(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    for (int i = 0; i < 3; ++i) {
      u[i] = two_difference(b[i], a[i]);
      v[i] = two_difference(c[i], a[i]);
      w[i] = two_difference(d[i], a[i]);
    }
  }
  [[nodiscard]] bool exact() const {
    for (int i = 0; i < 3; ++i) {
      if (u[i].tail != 0.0 || v[i].tail != 0.0 || w[i].tail != 0.0) return false;
    }
    return true;
  }
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
// the products of two tails and its own roundings, is below 70 u^2 times the permanent. 0: uncertain.
int sign_in_twice_the_precision(const Differences& m) {
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
  const double value = head + tail;
  const double bound = 128.0 * kUnitRoundoff * kUnitRoundoff * permanent;
  return (value > bound) - (-value > bound);
}

Expansion<192> full_determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto row = [&](int i) {
    const int j = kNext[i], k = kAfterNext[i];
    const Expansion<2> w = exact_difference(d[i], a[i]);
    return product(determinant(exact_difference(b[j], a[j]), exact_difference(b[k], a[k]), exact_difference(c[j], a[j]),
                               exact_difference(c[k], a[k])),
                   w);
  };
  return sum(sum(row(0), row(1)), row(2));
}

// Coordinates as integers, times a common power of two.
class Integers {
 public:
  using Int = boost::multiprecision::cpp_int;

  Integers(std::initializer_list<double> coordinates) {
    for (const double x : coordinates) {
      int exponent = 0;
      if (std::frexp(x, &exponent) != 0.0) least_ = std::min(least_, exponent);
    }
  }
  [[nodiscard]] Int operator()(double x) const {
    int exponent = 0;
    const double significand = std::frexp(x, &exponent);
    if (significand == 0.0) return 0;
    return Int(static_cast<std::int64_t>(std::ldexp(significand, 53))) << (exponent - least_);
  }

 private:
  int least_ = std::numeric_limits<int>::max();
};

}  // namespace

int volume_sign_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, OrientationCounters& counters) {
  ++counters.exact;
  if (d == b || d == c || every_product_is_zero(a, b, c, d)) return 0;
  if (in_range({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]})) {
    const Differences differences(a, b, c, d);
    if (const int sign = sign_in_twice_the_precision(differences); sign != 0) return sign;
    return differences.exact() ? determinant_of_heads(differences).sign() : full_determinant(a, b, c, d).sign();
  }
  ++counters.wide;
  const Integers of({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]});
  Integers::Int volume = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = kNext[i], k = kAfterNext[i];
    const auto minus_a = [&](const Vec3& p, int axis) { return Integers::Int(of(p[axis]) - of(a[axis])); };
    volume += (minus_a(b, j) * minus_a(c, k) - minus_a(b, k) * minus_a(c, j)) * minus_a(d, i);
  }
  return volume.sign();
}

int turn_sign_exact(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j, OrientationCounters& counters) {
  ++counters.exact;
  if (in_range({a[i], a[j], b[i], b[j], c[i], c[j]})) {
    return determinant(exact_difference(b[i], a[i]), exact_difference(b[j], a[j]), exact_difference(c[i], a[i]),
                       exact_difference(c[j], a[j]))
        .sign();
  }
  ++counters.wide;
  const Integers of({a[i], a[j], b[i], b[j], c[i], c[j]});
  const Integers::Int area =
      (of(b[i]) - of(a[i])) * (of(c[j]) - of(a[j])) - (of(b[j]) - of(a[j])) * (of(c[i]) - of(a[i]));
  return area.sign();
}

}  // namespace peerd::collision
