// The nearest points of eight pairs of triangles.
// For the files that Highway compiles once for each instruction set, and so is this: in each, once for each of them.
#if defined(PEERD_COLLISION_WIDE_NEAREST_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef PEERD_COLLISION_WIDE_NEAREST_HPP
#undef PEERD_COLLISION_WIDE_NEAREST_HPP
#else
#define PEERD_COLLISION_WIDE_NEAREST_HPP
#endif
#include <hwy/highway.h>

#include <limits>

#include "collision/query/wide_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace peerd::collision::HWY_NAMESPACE {
// A square that is NaN or too large is unknown, and counts as 0.
HWY_INLINE V known(V x) {
  const V zero = hn::Zero(Lanes());
  const V positive = hn::IfThenElseZero(hn::Gt(x, zero), x);
  return hn::IfThenElseZero(hn::Lt(positive, set(std::numeric_limits<float>::infinity())), positive);
}

constexpr float kRoundedDown = 1.0f - 0x1p-20f;  // a few operations, each of which may be off by 2^-24

HWY_INLINE V clamped(V x) {  // NaN becomes 0
  const V zero = hn::Zero(Lanes());
  return hn::Min(hn::IfThenElseZero(hn::Gt(x, zero), x), set(1.0f));
}

// An edge, and a face's weights: of a point p, (p - corner) . y and (p - corner) . z are those of the far ends of the
// sides u and v at its foot.
struct Edge {
  V3 p, d;
  V square, inverse;
};
struct Face {
  V3 p, u, v, y, z;
};
HWY_INLINE Edge edge(const V3& p, const V3& end) {
  const V3 d = minus(end, p);
  const V square = dot(d, d);
  return {p, d, square, hn::Div(set(1.0f), square)};
}
HWY_INLINE V3 scaled(const V3& p, V s) { return {hn::Mul(p.x, s), hn::Mul(p.y, s), hn::Mul(p.z, s)}; }
HWY_INLINE V3 added(const V3& a, const V3& b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
HWY_INLINE Face face(const Corners& t) {
  const V3 u = minus(t.q, t.p), v = minus(t.r, t.p), n = cross(u, v);
  const V inverse = hn::Div(set(1.0f), dot(n, n));
  return {t.p, u, v, scaled(cross(v, n), inverse), scaled(cross(n, u), inverse)};
}

struct Shortest {
  V square;
  V3 gap;  // from A to B
};
template <class M>
HWY_INLINE void choose(M mask, V square, const V3& gap, Shortest& out) {
  out.square = hn::IfThenElse(mask, square, out.square);
  out.gap = {hn::IfThenElse(mask, gap.x, out.gap.x), hn::IfThenElse(mask, gap.y, out.gap.y),
             hn::IfThenElse(mask, gap.z, out.gap.z)};
}
// The same method as in triangle_distance.cpp.
HWY_INLINE void consider_edges(const Edge& of_a, const Edge& of_b, Shortest& out) {
  const V3 r = minus(of_a.p, of_b.p);
  const V f = dot(of_b.d, r), b = dot(of_a.d, of_b.d), g = dot(of_a.d, r);
  const V s = clamped(hn::Div(hn::Sub(hn::Mul(b, f), hn::Mul(g, of_b.square)),
                              hn::Sub(hn::Mul(of_a.square, of_b.square), hn::Mul(b, b))));
  const V t = clamped(hn::Mul(hn::Add(hn::Mul(b, s), f), of_b.inverse));
  const V again = clamped(hn::Mul(hn::Sub(hn::Mul(b, t), g), of_a.inverse));
  const V3 gap = minus(minus(scaled(of_b.d, t), scaled(of_a.d, again)), r);
  const V square = dot(gap, gap);
  choose(hn::Lt(square, out.square), square, gap, out);
}
template <bool kFaceIsOfA>
HWY_INLINE void consider_foot(const Face& of, const V3& p, Shortest& out) {
  const V3 w = minus(p, of.p);
  const V y = dot(w, of.y), z = dot(w, of.z), zero = hn::Zero(Lanes());
  const auto inside = hn::And(hn::And(hn::Ge(y, zero), hn::Ge(z, zero)), hn::Le(hn::Add(y, z), set(1.0f)));
  const V3 in_plane = added(scaled(of.u, y), scaled(of.v, z));
  const V3 gap = kFaceIsOfA ? minus(w, in_plane) : minus(in_plane, w);
  const V square = dot(gap, gap);
  choose(hn::And(inside, hn::Lt(square, out.square)), square, gap, out);
}

struct Shape {
  Corners corners;
  std::array<Edge, 3> edges;
  Face face;
};
HWY_INLINE Shape shape(const Corners& t) { return {t, {edge(t.p, t.q), edge(t.q, t.r), edge(t.r, t.p)}, face(t)}; }
HWY_INLINE Shortest shortest(const Shape& a, const Shape& b) {
  const V none = set(std::numeric_limits<float>::infinity()), zero = hn::Zero(Lanes());
  Shortest out{none, {zero, zero, zero}};
  for (const Edge& of_a : a.edges) {
    for (const Edge& of_b : b.edges) consider_edges(of_a, of_b, out);
  }
  for (const V3* const p : {&a.corners.p, &a.corners.q, &a.corners.r}) consider_foot<false>(b.face, *p, out);
  for (const V3* const p : {&b.corners.p, &b.corners.q, &b.corners.r}) consider_foot<true>(a.face, *p, out);
  return out;
}

// The gap along a direction, whatever that is. Both triangles' places may be off by the slack along each axis; the
// rounding of the dot products is less than that, since the slack has room for twice what it is for.
HWY_INLINE V gap_along(const Shortest& direction, const Corners& a, const Corners& b, float slack) {
  const auto along = [&](const V3& p) { return dot(direction.gap, minus(p, a.p)); };
  const V last_a = hn::Max(hn::Max(hn::Zero(Lanes()), along(a.q)), along(a.r));
  const V first_b = hn::Min(hn::Min(along(b.p), along(b.q)), along(b.r));
  const V gap = hn::Div(hn::Sub(first_b, last_a), hn::Sqrt(direction.square));
  const V certain = hn::Sub(hn::Mul(gap, set(kRoundedDown)), set(3.0f * slack));
  return hn::IfThenElseZero(hn::Gt(direction.square, set(0x1p-100f)), known(certain));
}

}  // namespace peerd::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
