// Every decision is the sign of an integer. The coordinates of a pair are integers times one power of two, and no hull
// gains or loses a common point when all coordinates are multiplied by the same positive number.
//
// Two triangles A and B share a point if and only if an edge (the hull of two of the three points) of one touches the
// other. "If" is plain. "Only if": let x be an extreme point of the intersection of A and B, which is convex, compact
// and not empty. Were x in the relative interior of both, and both of them of dimension two, then
//   - in one plane: a small disk around x would lie in both, or
//   - in two planes: a small piece around x of the planes' common line would lie in both,
// and x would not be extreme. So one of the two is a segment or a point, and then it is the union of its edges; or x
// lies on the relative boundary of one, which is the union of its edges. This covers one triangle within the other.
#include "tests/oracle/triangle_oracle.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "tests/oracle/integer_triangle.hpp"

namespace peerd::oracle {
namespace {

using Integer = mpz_class;
using Vec = std::array<Integer, 3>;

Vec minus(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

int dot_sign(const Vec& a, const Vec& b) {
  const Integer sum = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  return sgn(sum);
}

bool is_zero(const Vec& v) { return sgn(v[0]) == 0 && sgn(v[1]) == 0 && sgn(v[2]) == 0; }

bool one_sided(int s, int t, int u) { return std::min({s, t, u}) >= 0 || std::max({s, t, u}) <= 0; }

// In the plane

using Vec2 = std::array<Integer, 2>;

// Twice the signed area of pqr.
int turn(const Vec2& p, const Vec2& q, const Vec2& r) {
  const Integer area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
  return sgn(area);
}

template <std::size_t N>
bool boxes_overlap(const std::array<Integer, N>& p, const std::array<Integer, N>& q, const std::array<Integer, N>& r,
                   const std::array<Integer, N>& s) {
  for (std::size_t k = 0; k < N; ++k) {
    if (std::max(p[k], q[k]) < std::min(r[k], s[k]) || std::max(r[k], s[k]) < std::min(p[k], q[k])) return false;
  }
  return true;
}

// Each segment reaches the line of the other. If the lines cross, that is at one point, and both segments have it. If
// they are one line, the boxes decide. A segment of length zero turns nowhere: then the point lies on the other's line,
// or the other is a point too, and again the boxes decide.
bool segments_touch(const Vec2& p, const Vec2& q, const Vec2& r, const Vec2& s) {
  return boxes_overlap(p, q, r, s) && turn(p, q, r) * turn(p, q, s) <= 0 && turn(r, s, p) * turn(r, s, q) <= 0;
}

// abc has an area.
bool point_in_triangle(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
  return one_sided(turn(p, a, b), turn(p, b, c), turn(p, c, a));
}

// Drops the axis along which the plane of this normal does not lie: distinct points of the plane stay distinct.
struct Projection {
  std::size_t x, y;
  explicit Projection(const Vec& normal) {
    const std::size_t dropped = sgn(normal[0]) != 0 ? 0 : sgn(normal[1]) != 0 ? 1 : 2;
    assert(sgn(normal[dropped]) != 0);
    x = (dropped + 1) % 3;
    y = (dropped + 2) % 3;
  }
  Vec2 operator()(const Vec& p) const { return {p[x], p[y]}; }
};

// In space

bool segments_touch(const Vec& p, const Vec& q, const Vec& r, const Vec& s) {
  const Vec u = minus(q, p), v = minus(s, r), w = minus(r, p), normal = cross(u, v);
  if (is_zero(normal)) {  // parallel, or one of them is a point
    // Either all four points are on one line, or both segments are points: in both cases the boxes decide.
    return is_zero(cross(w, u)) && is_zero(cross(w, v)) && boxes_overlap(p, q, r, s);
  }
  if (dot_sign(normal, w) != 0) return false;  // skew
  const Projection flat(normal);
  return segments_touch(flat(p), flat(q), flat(r), flat(s));
}

struct ExactTriangle {
  std::array<Vec, 3> p;
  Vec normal = cross(minus(p[1], p[0]), minus(p[2], p[0]));
};

bool segment_touches(const Vec& p, const Vec& q, const ExactTriangle& triangle) {
  const auto& [a, b, c] = triangle.p;
  if (is_zero(triangle.normal)) {  // the union of its edges
    return segments_touch(p, q, a, b) || segments_touch(p, q, b, c) || segments_touch(p, q, c, a);
  }
  const Vec pa = minus(a, p), pq = minus(q, p);
  const int side_p = -dot_sign(triangle.normal, pa), side_q = dot_sign(triangle.normal, minus(q, a));
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) {
    const Projection flat(triangle.normal);
    const Vec2 a2 = flat(a), b2 = flat(b), c2 = flat(c), p2 = flat(p), q2 = flat(q);
    return point_in_triangle(p2, a2, b2, c2) || segments_touch(p2, q2, a2, b2) || segments_touch(p2, q2, b2, c2) ||
           segments_touch(p2, q2, c2, a2);
  }
  // The segment meets the plane in one point x. With A = a - x and B = b - x, and x - p parallel to q - p,
  //   (q - p).((a - p) x (b - p)) = (q - p).(A x B),
  // and A x B is the normal times the signed area of xab. So the three volumes have the signs, up to a common one, of
  // the barycentric coordinates of x.
  const Vec pb = minus(b, p), pc = minus(c, p);
  return one_sided(dot_sign(pq, cross(pa, pb)), dot_sign(pq, cross(pb, pc)), dot_sign(pq, cross(pc, pa)));
}

bool an_edge_touches(const ExactTriangle& a, const ExactTriangle& b) {
  return segment_touches(a.p[0], a.p[1], b) || segment_touches(a.p[1], a.p[2], b) || segment_touches(a.p[2], a.p[0], b);
}

// A coordinate is mantissa * 2^exponent with a mantissa that is odd, or zero.
struct Binary {
  std::int64_t mantissa;
  int exponent;
  explicit Binary(double value) {
    assert(std::isfinite(value));
    constexpr int kBits = std::numeric_limits<double>::digits;
    mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), kBits));
    const int zeros = mantissa == 0 ? 0 : std::countr_zero(static_cast<std::uint64_t>(mantissa));
    mantissa /= std::int64_t{1} << zeros;
    exponent += zeros - kBits;
  }
};

// All times 2^-lowest.
ExactTriangle scaled(const Triangle& triangle, int lowest) {
  std::array<Vec, 3> points;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Binary number(triangle[i][k]);
      if (number.mantissa == 0) continue;
      points[i][k] = static_cast<double>(number.mantissa);  // at most 53 bits
      points[i][k] <<= static_cast<unsigned long>(number.exponent - lowest);
    }
  }
  return {points};
}

}  // namespace

bool touch(const IntegerTriangle& a, const IntegerTriangle& b) {
  const ExactTriangle exact_a{a}, exact_b{b};
  return an_edge_touches(exact_a, exact_b) || an_edge_touches(exact_b, exact_a);
}

bool touch(const Triangle& a, const Triangle& b) {
  int lowest = std::numeric_limits<int>::max();
  for (const Triangle* triangle : {&a, &b}) {
    for (const Point& point : *triangle) {
      for (const double coordinate : point) {
        if (coordinate != 0) lowest = std::min(lowest, Binary(coordinate).exponent);
      }
    }
  }
  const ExactTriangle exact_a = scaled(a, lowest), exact_b = scaled(b, lowest);
  return an_edge_touches(exact_a, exact_b) || an_edge_touches(exact_b, exact_a);
}

}  // namespace peerd::oracle
