#include "collision/exact/triangle_distance.hpp"

#include <algorithm>
#include <cmath>

#include "collision/exact/double_double.hpp"
#include "collision/exact/infinity.hpp"
#include "collision/exact/ordered_sums.hpp"
#include "collision/exact/triangle_pair.hpp"

namespace peerd::collision {
namespace {

template <class Number>
struct Point {
  Number x, y, z;
  Point(const Number& x_, const Number& y_, const Number& z_) : x(x_), y(y_), z(z_) {}
  explicit Point(const Vec3& p) : x(p[0]), y(p[1]), z(p[2]) {}

  friend Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Point operator*(const Point& a, const Number& s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Number dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend Point cross(const Point& a, const Point& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
};
template <class Number>
Vec3 rounded(const Point<Number>& p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}

template <class Number>
Number clamped(const Number& x) {  // what is no number becomes 0
  return x > Number(0.0) ? (x < Number(1.0) ? x : Number(1.0)) : Number(0.0);
}

struct Nearest {
  double square = kInfinity;
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero(), gap = Vec3::Zero();  // from a to b
};

// The nearest points of two triangles that don't touch: of two edges, or of a corner and the inside of a face. Whatever
// rounding does to their places, they stay on their edges and faces.
template <class Number>
class Search {
  using P = Point<Number>;
  using Corners = std::array<P, 3>;

 public:
  Search(const Triangle& a, const Triangle& b) : a_{P(a[0]), P(a[1]), P(a[2])}, b_{P(b[0]), P(b[1]), P(b[2])} {}

  Nearest run() {
    apart();
    return nearest_;
  }
  // The edges' places on the other's face besides, which triangles that cross have in common.
  Nearest run_touching() {
    apart();
    for (std::size_t i = 0; i < 3; ++i) {
      through(b_, a_[i], a_[(i + 1) % 3], [&](const P& x, const P& y) { consider(x, y); });
      through(a_, b_[i], b_[(i + 1) % 3], [&](const P& x, const P& y) { consider(y, x); });
    }
    return nearest_;
  }

 private:
  void apart() {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) edges(a_[i], a_[(i + 1) % 3], b_[j], b_[(j + 1) % 3]);
    }
    for (const P& corner : a_) foot(b_, corner, [&](const P& there) { consider(corner, there); });
    for (const P& corner : b_) foot(a_, corner, [&](const P& there) { consider(there, corner); });
  }
  void consider(const P& x, const P& y) {
    const P gap = y - x;
    const auto square = static_cast<double>(dot(gap, gap));
    if (square < nearest_.square) nearest_ = {square, rounded(x), rounded(y), rounded(gap)};
  }

  // C. Ericson, Real-Time Collision Detection (2005), 5.1.9: closest points of segments.
  void edges(const P& p, const P& p_end, const P& q, const P& q_end) {
    const P d = p_end - p, e = q_end - q, r = p - q;
    const Number a = dot(d, d), c = dot(e, e), f = dot(e, r), b = dot(d, e), g = dot(d, r);
    Number s = clamped<Number>((b * f - g * c) / (a * c - b * b));
    Number t = (b * s + f) / c;
    if (!(t >= Number(0.0))) {
      t = 0.0;
      s = clamped<Number>(-g / a);
    } else if (t > Number(1.0)) {
      t = 1.0;
      s = clamped<Number>((b - g) / a);
    }
    consider(p + d * s, q + e * t);
  }

  // A point over the inside of a triangle; where it is nearest to an edge or a corner, the edges' pairs have it.
  template <class Then>
  static void foot(const Corners& triangle, const P& p, Then then) {
    const P u = triangle[1] - triangle[0], v = triangle[2] - triangle[0], w = p - triangle[0];
    const P n = cross(u, v);
    const Number square = dot(n, n);
    const Number y = dot(cross(w, v), n) / square, z = dot(cross(u, w), n) / square;
    if (y >= Number(0.0) && z >= Number(0.0) && y + z <= Number(1.0)) then(triangle[0] + u * y + v * z);
  }

  template <class Then>
  static void through(const Corners& triangle, const P& p, const P& end, Then then) {
    const P n = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
    const Number above = dot(p - triangle[0], n), below = dot(triangle[0] - end, n);
    const P x = p + (end - p) * clamped<Number>(above / (above + below));
    foot(triangle, x, [&](const P& there) { then(x, there); });
  }

  Corners a_, b_;
  Nearest nearest_;
};

double largest_coordinate(const Triangle& a, const Triangle& b) {
  double largest = 0.0;
  for (const Triangle* const t : {&a, &b}) {
    for (const Vec3& p : *t) largest = std::max({largest, std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
  }
  return largest;
}

// The gap of two triangles along a direction, less than what rounding may have added: certain, whatever the direction.
// Distances are from `origin`, so that the bound is of the triangles' size and not of their place:
// u = 2^-53 times 4 for each dot product of a rounded difference, 1 for taking one from the other, is below 10 u times
// the farthest corner; the direction's length is known to 3 u.
double gap_along(Vec3 direction, const Triangle& a, const Triangle& b, const Vec3& origin) {
  double square = dot(direction, direction);
  if (!(square > 0x1p-400 && square < 0x1p400)) {  // to a length near 1, where nothing over- or underflows
    const double most = direction.cwiseAbs().maxCoeff();
    if (!(most > 0.0 && most < kInfinity)) return 0.0;
    const int exponent = -std::ilogb(most);
    for (int k = 0; k < 3; ++k) direction[k] = std::ldexp(direction[k], exponent);
    square = dot(direction, direction);
  }
  double last_a = -kInfinity, first_b = kInfinity, farthest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 of_a = a[i] - origin, of_b = b[i] - origin;
    last_a = std::max(last_a, dot(direction, of_a));
    first_b = std::min(first_b, dot(direction, of_b));
    farthest = std::max({farthest, magnitude(of_a), magnitude(of_b)});
  }
  const double gap = (first_b - last_a) / std::sqrt(square);
  const double certain = gap * (1.0 - 0x1p-49) - (0x1p-49 * farthest + 0x1p-800);
  return certain > 0.0 ? certain : 0.0;  // also where it is no number
}

// Bounds by a pair of points that are on their triangles but for an error of at most `off`, together.
void bound(TriangleDistance& out, const Nearest& nearest, const Triangle& a, const Triangle& b, double off) {
  if (!(nearest.square < kInfinity)) return;
  const double upper = std::sqrt(nearest.square) * (1.0 + 0x1p-50) + off + 0x1p-530;
  if (upper < out.upper) {
    out.upper = upper;
    out.distance = std::sqrt(nearest.square);
    out.on_a = nearest.on_a;
    out.on_b = nearest.on_b;
  }
  out.lower = std::max(out.lower, gap_along(nearest.gap, a, b, nearest.on_a));
}

}  // namespace

TriangleDistance triangle_distance(const Triangle& a, const Triangle& b, double relative_accuracy) {
  const double largest = largest_coordinate(a, b);
  TriangleDistance out{kInfinity, a[0], b[0], 0.0, kInfinity};
  // A point of an edge or a face is off it by at most 10 u of the largest coordinate along each axis, and by 2 u more
  // where the weights of the corners sum up to 1 + u: 42 u for two.
  bound(out, Search<double>(a, b).run(), a, b, 0x1p-47 * largest);
  OrientationCounters ignored;
  if (out.lower == 0.0 && touch(a, b, ignored)) {
    Nearest common = Search<double>(a, b).run_touching();
    if (!(std::sqrt(common.square) <= 0x1p-44 * largest)) {
      const Nearest again = Search<DoubleDouble>(a, b).run_touching();
      if (again.square < common.square) common = again;
    }
    return {0.0, common.on_a, common.on_b, 0.0, 0.0};
  }
  // Where the nearest points are ill-conditioned, the gap along them is not that of their distance.
  if (out.upper - out.lower > std::max(0x1p-44 * largest, relative_accuracy * out.upper)) {
    bound(out, Search<DoubleDouble>(a, b).run(), a, b, 0x1p-90 * largest);
  }
  out.lower = std::min(out.lower, out.upper);
  return out;
}

}  // namespace peerd::collision
