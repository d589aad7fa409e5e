#include "tests/oracle/distance_oracle.hpp"

#include <algorithm>

namespace peerd::oracle {
namespace {

using Number = mpq_class;
using Vector = std::array<Number, 3>;

Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Number dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Number square(const Vector& a) { return dot(a, a); }

RationalTriangle exact(const Triangle& t) {
  RationalTriangle out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) out[i][k] = t[i][k];
  }
  return out;
}

// Each lowers `least` where the stationary point is inside.
void point_edge(const Vector& p, const Vector& q, const Vector& end, Number& least) {
  const Vector d = minus(end, q), w = minus(p, q);
  const Number along = dot(w, d), whole = square(d);
  if (along <= 0 || along >= whole) return;
  least = std::min<Number>(least, square(cross(w, d)) / whole);
}
void point_face(const Vector& p, const RationalTriangle& t, Number& least) {
  const Vector n = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  if (square(n) == 0) return;
  for (std::size_t i = 0; i < 3; ++i) {
    if (dot(cross(minus(t[(i + 1) % 3], t[i]), minus(p, t[i])), n) < 0) return;
  }
  const Number height = dot(minus(p, t[0]), n);
  least = std::min<Number>(least, height * height / square(n));
}
// The lines' common perpendicular, by Cramer's rule of d s - e t + n r = q - p.
void edge_edge(const Vector& p, const Vector& p_end, const Vector& q, const Vector& q_end, Number& least) {
  const Vector d = minus(p_end, p), e = minus(q_end, q), w = minus(q, p), n = cross(d, e);
  const Number whole = square(n);
  if (whole == 0) return;
  const Number s = dot(cross(w, e), n), t = dot(cross(w, d), n);
  if (s < 0 || s > whole || t < 0 || t > whole) return;
  const Number height = dot(w, n);
  least = std::min<Number>(least, height * height / whole);
}

}  // namespace

mpq_class squared_distance(const Triangle& a, const Triangle& b) {
  return touch(a, b) ? mpq_class(0) : squared_distance_apart(exact(a), exact(b));
}

mpq_class squared_distance_apart(const RationalTriangle& p, const RationalTriangle& q) {
  Number least = square(minus(p[0], q[0]));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      least = std::min<Number>(least, square(minus(p[i], q[j])));
      point_edge(p[i], q[j], q[(j + 1) % 3], least);
      point_edge(q[i], p[j], p[(j + 1) % 3], least);
      edge_edge(p[i], p[(i + 1) % 3], q[j], q[(j + 1) % 3], least);
    }
    point_face(p[i], q, least);
    point_face(q[i], p, least);
  }
  return least;
}

}  // namespace peerd::oracle
