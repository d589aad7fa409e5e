// Whether two triangles touch depends on the signs of determinants of their corners alone: volumes of four corners and,
// where all of those that matter are 0, areas of three in the coordinate planes and orders of two along the axes. With
// corners that are linear in time these are polynomials in time, of degree 3, 2 and 1, with integer coefficients once
// all is multiplied by a power of two. Between two neighbouring roots of all of them nothing changes, so it takes an
// exact test at one time of each such interval and at each root. Sturm's theorem counts the roots of a polynomial in an
// interval; bisection makes the intervals short. Areas and orders are looked at only where some volume is 0 at all
// times: else they matter at roots of volumes alone, which are tested anyway.
#include "tests/oracle/moving_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "tests/oracle/distance_oracle.hpp"
#include "tests/oracle/integer_triangle.hpp"

namespace peerd::oracle {
namespace {

using Integer = mpz_class;
using Polynomial = std::vector<Integer>;  // by ascending powers, the last not 0; empty: 0

void trim(Polynomial& p) {
  while (!p.empty() && p.back() == 0) p.pop_back();
}
Polynomial difference(Polynomial p, const Polynomial& q) {
  p.resize(std::max(p.size(), q.size()));
  for (std::size_t i = 0; i < q.size(); ++i) p[i] -= q[i];
  trim(p);
  return p;
}
Polynomial sum(Polynomial p, const Polynomial& q) {
  p.resize(std::max(p.size(), q.size()));
  for (std::size_t i = 0; i < q.size(); ++i) p[i] += q[i];
  trim(p);
  return p;
}
Polynomial product(const Polynomial& p, const Polynomial& q) {
  if (p.empty() || q.empty()) return {};
  Polynomial out(p.size() + q.size() - 1);
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (std::size_t j = 0; j < q.size(); ++j) out[i + j] += p[i] * q[j];
  }
  trim(out);
  return out;
}

// A time in [0, 1]: count / 2^bits.
struct Dyadic {
  Integer count;
  unsigned long bits = 0;
  [[nodiscard]] mpq_class rational() const {
    mpq_class out(count);
    mpq_div_2exp(out.get_mpq_t(), out.get_mpq_t(), bits);
    return out;
  }
};
Dyadic middle(const Dyadic& a, const Dyadic& b) {
  const unsigned long bits = std::max(a.bits, b.bits);
  return {(a.count << (bits - a.bits)) + (b.count << (bits - b.bits)), bits + 1};
}

int sign_at(const Polynomial& p, const Dyadic& t) {
  Integer value = 0;
  unsigned long scale = 0;  // the value is times 2^scale
  for (std::size_t i = p.size(); i-- > 0;) {
    value = value * t.count + (p[i] << scale);
    scale += t.bits;
  }
  return sgn(value);
}

// The negated remainder of p by q, times a positive number, so that no fraction appears.
Polynomial next_of_sturm(Polynomial p, const Polynomial& q) {
  const Integer lead = abs(q.back());
  while (p.size() >= q.size()) {
    const Integer factor = p.back() * sgn(q.back());
    const std::size_t shift = p.size() - q.size();
    for (Integer& c : p) c *= lead;
    for (std::size_t i = 0; i < q.size(); ++i) p[shift + i] -= factor * q[i];
    trim(p);
  }
  Integer common = 0;
  for (const Integer& c : p) common = gcd(common, c);
  for (Integer& c : p) c /= -common;
  return p;
}

class Sturm {
 public:
  explicit Sturm(const Polynomial& p) : chain_{p} {
    Polynomial derivative;
    for (std::size_t i = 1; i < p.size(); ++i) derivative.push_back(p[i] * static_cast<unsigned long>(i));
    while (!derivative.empty()) {
      chain_.push_back(derivative);
      derivative = next_of_sturm(chain_[chain_.size() - 2], chain_.back());
    }
  }
  // The number of roots in (lo, hi] is changes(lo) - changes(hi), for a polynomial whose roots are all simple.
  [[nodiscard]] int changes(const Dyadic& t) const {
    int before = 0, count = 0;
    for (const Polynomial& p : chain_) {
      const int sign = sign_at(p, t);
      if (sign == 0) continue;
      count += before != 0 && before != sign;
      before = sign;
    }
    return count;
  }
  [[nodiscard]] bool is_root(const Dyadic& t) const { return sign_at(chain_.front(), t) == 0; }
  // The greatest common divisor of the polynomial and its derivative: its roots are the multiple ones.
  [[nodiscard]] const Polynomial& divisor() const { return chain_.back(); }

 private:
  std::vector<Polynomial> chain_;
};

// p over its divisor of degree 1 or more, times a number: the divisor's leading coefficient is multiplied in first.
Polynomial quotient(Polynomial p, const Polynomial& divisor) {
  Polynomial out(p.size() - divisor.size() + 1);
  for (std::size_t i = out.size(); i-- > 0;) {
    for (Integer& c : p) c *= divisor.back();
    for (Integer& c : out) c *= divisor.back();
    out[i] = p[i + divisor.size() - 1] / divisor.back();
    for (std::size_t j = 0; j < divisor.size(); ++j) p[i + j] -= out[i] * divisor[j];
  }
  trim(out);
  return out;
}

struct Bracket {
  Dyadic lo, hi;  // one time where the two are equal
};

// Appends a bracket for each root in (0, 1].
void isolate(const Polynomial& p, std::vector<Bracket>& out) {
  if (p.size() <= 1) return;
  Sturm sturm(p);
  if (const Polynomial divisor = sturm.divisor(); divisor.size() > 1) sturm = Sturm(quotient(p, divisor));
  struct Part {
    Bracket in;
    int changes_lo, changes_hi;
  };
  const Dyadic zero{0, 0}, one{1, 0};
  std::vector<Part> open = {{{zero, one}, sturm.changes(zero), sturm.changes(one)}};
  while (!open.empty()) {
    const Part part = open.back();
    open.pop_back();
    const int roots = part.changes_lo - part.changes_hi;
    if (roots == 0) continue;
    const Dyadic half = middle(part.in.lo, part.in.hi);
    if (roots == 1 && sturm.is_root(part.in.hi)) {
      out.push_back({part.in.hi, part.in.hi});
    } else if (half.bits > kTimeBits + 1) {
      out.push_back(part.in);
    } else {
      const int changes = sturm.changes(half);
      open.push_back({{part.in.lo, half}, part.changes_lo, changes});
      open.push_back({{half, part.in.hi}, changes, part.changes_hi});
    }
  }
}

// The six corners, and their coordinates as polynomials in time, times 2^-lowest_.
class Corners {
 public:
  Corners(const MovingTriangle& a, const MovingTriangle& b) {
    for (const MovingTriangle* triangle : {&a, &b}) {
      for (const Triangle* end : {&triangle->at_0, &triangle->at_1}) {
        for (const Point& point : *end) {
          for (const double x : point) {
            if (x != 0.0) lowest_ = std::min(lowest_, std::ilogb(x) - 52);
          }
        }
      }
    }
    for (std::size_t i = 0; i < 6; ++i) {
      const MovingTriangle& triangle = i < 3 ? a : b;
      for (std::size_t k = 0; k < 3; ++k) {
        const Integer at_0 = scaled(triangle.at_0[i % 3][k]), at_1 = scaled(triangle.at_1[i % 3][k]);
        corners_[i][k] = {at_0, at_1 - at_0};
        trim(corners_[i][k]);
      }
    }
  }

  [[nodiscard]] bool touch(const Dyadic& t) const { return oracle::touch(triangle(0, t), triangle(3, t)); }
  [[nodiscard]] std::vector<Bracket> brackets() const;

 private:
  [[nodiscard]] Integer scaled(double x) const {
    if (x == 0.0) return 0;
    const int exponent = std::ilogb(x) - 52;
    const Integer significand(std::ldexp(x, -exponent));
    return significand << static_cast<unsigned long>(exponent - lowest_);
  }
  [[nodiscard]] IntegerTriangle triangle(std::size_t first, const Dyadic& t) const {
    IntegerTriangle out;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Polynomial& p = corners_[first + i][k];
        if (!p.empty()) out[i][k] = p[0] << t.bits;
        if (p.size() > 1) out[i][k] += p[1] * t.count;
      }
    }
    return out;
  }
  [[nodiscard]] Polynomial along(std::size_t i, std::size_t j, std::size_t k) const {
    return difference(corners_[j][k], corners_[i][k]);
  }
  // Twice the area of three corners in the plane of the coordinates k and k + 1.
  [[nodiscard]] Polynomial area(std::size_t i, std::size_t j, std::size_t l, std::size_t k) const {
    const std::size_t next = (k + 1) % 3;
    return difference(product(along(i, j, k), along(i, l, next)), product(along(i, j, next), along(i, l, k)));
  }
  // Six times the volume of corner i and three others.
  [[nodiscard]] Polynomial volume(std::size_t i, std::size_t j, std::size_t l, std::size_t m) const {
    Polynomial out;
    for (std::size_t k = 0; k < 3; ++k) out = sum(out, product(area(i, j, l, k), along(i, m, (k + 2) % 3)));
    return out;
  }

  int lowest_ = 0;
  std::array<std::array<Polynomial, 3>, 6> corners_;
};

std::vector<Bracket> Corners::brackets() const {
  std::vector<Bracket> out;
  bool flat = false;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = i + 1; j < 6; ++j) {
      for (std::size_t l = j + 1; l < 6; ++l) {
        for (std::size_t m = l + 1; m < 6; ++m) {
          const Polynomial p = volume(i, j, l, m);
          flat = flat || p.empty();
          isolate(p, out);
        }
      }
    }
  }
  if (!flat) return out;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = i + 1; j < 6; ++j) {
        isolate(along(i, j, k), out);
        for (std::size_t l = j + 1; l < 6; ++l) isolate(area(i, j, l, k), out);
      }
    }
  }
  return out;
}

RationalTriangle rational(const MovingTriangle& triangle, const mpq_class& time) {
  RationalTriangle out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const mpq_class at_0 = triangle.at_0[i][k], at_1 = triangle.at_1[i][k];
      out[i][k] = at_0 + (at_1 - at_0) * time;
    }
  }
  return out;
}

// A rational pair times the product of all denominators.
std::array<IntegerTriangle, 2> integers(const RationalTriangle& a, const RationalTriangle& b) {
  Integer common = 1;
  for (const RationalTriangle* t : {&a, &b}) {
    for (const auto& point : *t) {
      for (const mpq_class& x : point) common = lcm(common, x.get_den());
    }
  }
  std::array<IntegerTriangle, 2> out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      out[0][i][k] = mpq_class(a[i][k] * common).get_num();
      out[1][i][k] = mpq_class(b[i][k] * common).get_num();
    }
  }
  return out;
}

}  // namespace

bool touch_at(const MovingTriangle& a, const MovingTriangle& b, const mpq_class& time) {
  const auto [of_a, of_b] = integers(rational(a, time), rational(b, time));
  return touch(of_a, of_b);
}

mpq_class squared_distance_at(const MovingTriangle& a, const MovingTriangle& b, const mpq_class& time) {
  return touch_at(a, b, time) ? mpq_class(0) : squared_distance_apart(rational(a, time), rational(b, time));
}

std::optional<FirstTouch> first_touch(const MovingTriangle& a, const MovingTriangle& b) {
  const Corners corners(a, b);
  if (corners.touch({0, 0})) return FirstTouch{0, 0};
  std::vector<Bracket> brackets = corners.brackets();
  brackets.push_back({{1, 0}, {1, 0}});
  std::vector<std::pair<mpq_class, const Bracket*>> order;
  for (const Bracket& bracket : brackets) order.emplace_back(bracket.lo.rational(), &bracket);
  std::ranges::sort(order, {}, &std::pair<mpq_class, const Bracket*>::first);
  // Both ends of a bracket lie in the intervals beside it, or are the root itself; and what touches in an open interval
  // touches at its ends.
  std::optional<FirstTouch> first;
  for (const auto& [lo, bracket] : order) {
    if (first && lo >= first->at_latest) break;
    for (const Dyadic& time : {bracket->lo, bracket->hi}) {
      const mpq_class at = time.rational();
      if ((first && at >= first->at_latest) || !corners.touch(time)) continue;
      first = {lo, at};
    }
  }
  // Brackets of several roots may overlap: then there is none of them before the first that ends after the others
  // begin.
  if (!first) return first;
  for (auto it = order.rbegin(); it != order.rend(); ++it) {
    if (it->first < first->not_before && it->second->hi.rational() >= first->not_before) first->not_before = it->first;
  }
  return first;
}

}  // namespace peerd::oracle
