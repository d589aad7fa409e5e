// Vectors of eight numbers, points, boxes or triangles, one to a lane of the vector unit. Highway compiles the files
// that include this one once for each instruction set, and this file with them.
#if defined(PEERD_COLLISION_WIDE_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef PEERD_COLLISION_WIDE_LANES_HPP
#undef PEERD_COLLISION_WIDE_LANES_HPP
#else
#define PEERD_COLLISION_WIDE_LANES_HPP
#endif
#include <hwy/highway.h>

#include <limits>

#include "collision/query/wide_motion.hpp"

HWY_BEFORE_NAMESPACE();
namespace peerd::collision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kWidth = WideTree::kWidth;
using Lanes = hn::CappedTag<float, kWidth>;
using V = hn::Vec<Lanes>;
using Row = std::array<float, kWidth>;
using Rows = std::array<Row, 3>;  // x, y, z

HWY_INLINE V load(const Row& row, std::size_t i) { return hn::LoadU(Lanes(), row.data() + i); }
HWY_INLINE void store(V v, Row& row, std::size_t i) { hn::StoreU(v, Lanes(), row.data() + i); }
HWY_INLINE V set(float x) { return hn::Set(Lanes(), x); }

// The bits of the lanes from i on.
template <class M>
HWY_INLINE std::uint32_t bits(M mask, std::size_t i) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Lanes(), mask, bytes);
  return static_cast<std::uint32_t>(bytes[0]) << i;
}

struct V3 {
  V x, y, z;
};
HWY_INLINE void store3(const V3& v, Rows& rows, std::size_t i) {
  store(v.x, rows[0], i), store(v.y, rows[1], i), store(v.z, rows[2], i);
}
HWY_INLINE V3 load3(const Rows& rows, std::size_t i) { return {load(rows[0], i), load(rows[1], i), load(rows[2], i)}; }
HWY_INLINE V3 set3(const std::array<float, 3>& p) { return {set(p[0]), set(p[1]), set(p[2])}; }
HWY_INLINE V3 set3(const Rows& rows, std::size_t lane) {
  return {set(rows[0][lane]), set(rows[1][lane]), set(rows[2][lane])};
}
HWY_INLINE V3 minus(const V3& a, const V3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
// There is no MulAdd: every instruction set gives the same bits, so counters are the same, too.
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

using Matrix = WideMotion::Matrix;
HWY_INLINE V3 times(const Matrix& m, const V3& p) {
  const auto row = [&](std::size_t i) { return dot({set(m[i][0]), set(m[i][1]), set(m[i][2])}, p); };
  return {row(0), row(1), row(2)};
}
HWY_INLINE V3 plus(const V3& a, const std::array<float, 3>& b) {
  return {hn::Add(a.x, set(b[0])), hn::Add(a.y, set(b[1])), hn::Add(a.z, set(b[2]))};
}

struct Boxes {
  Rows center, half;
};

// Boxes as boxes of the other's frame, wider by the slack; the box of a box that isn't there isn't there.
HWY_INLINE void transform(const WideTree::Node& node, const Matrix& rotation, const Matrix& sizes,
                          const std::array<float, 3>& origin, float slack, Boxes& out) {
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 center = plus(times(rotation, load3(node.center, i)), origin);
    const V3 half = plus(times(sizes, load3(node.half, i)), {slack, slack, slack});
    store(center.x, out.center[0], i), store(center.y, out.center[1], i), store(center.z, out.center[2], i);
    store(half.x, out.half[0], i), store(half.y, out.half[1], i), store(half.z, out.half[2], i);
  }
}
HWY_INLINE void to_a(const WideTree::Node& b, const WideMotion& m, Boxes& out) {
  transform(b, m.a_from_b, m.a_from_b_sizes, m.b_in_a, m.slack_a, out);
}
HWY_INLINE void to_b(const WideTree::Node& a, const WideMotion& m, Boxes& out) {
  transform(a, m.b_from_a, m.b_from_a_sizes, m.a_in_b, m.slack_b, out);
}

HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

HWY_INLINE void transform(const WideTree::Leaf& leaf, const Matrix& rotation, const Matrix& sizes,
                          const std::array<float, 3>& origin, float slack, std::array<float, 3>& center,
                          std::array<float, 3>& half) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto &r = rotation[k], &s = sizes[k];
    center[k] = ((r[0] * leaf.center[0] + r[1] * leaf.center[1]) + r[2] * leaf.center[2]) + origin[k];
    half[k] = ((s[0] * leaf.half[0] + s[1] * leaf.half[1]) + s[2] * leaf.half[2]) + slack;
  }
}

// Eight triangles.
struct Corners {
  V3 p, q, r;
};

// A normal, as rounded, of each plane, and the sum of the sizes of what its components were rounded from.
struct Planes {
  V3 normal;
  V size;
};
HWY_INLINE Planes planes(const Corners& t) {
  const V3 u = minus(t.q, t.p), v = minus(t.r, t.p);
  const V a = hn::Mul(u.y, v.z), b = hn::Mul(u.z, v.y);
  const V c = hn::Mul(u.z, v.x), d = hn::Mul(u.x, v.z);
  const V e = hn::Mul(u.x, v.y), f = hn::Mul(u.y, v.x);
  const auto sizes = [](V s, V t2) { return hn::Add(hn::Abs(s), hn::Abs(t2)); };
  return {{hn::Sub(a, b), hn::Sub(c, d), hn::Sub(e, f)}, hn::Add(hn::Add(sizes(a, b), sizes(c, d)), sizes(e, f))};
}

// The margin that must be left between corners along a normal of that size, for an error of `off` [m]. With smaller
// normals, products underflow by more than such a margin: then no plane separates. (A size of 2^-80 takes a reach of
// 2^-43, and so a margin of 2^-140.)
HWY_INLINE V certain_margin(V size, V off) {
  return hn::IfThenElse(hn::Gt(size, set(0x1p-80f)), hn::Mul(size, off), set(std::numeric_limits<float>::infinity()));
}

HWY_INLINE Corners load_corners(const std::array<Rows, 3>& corners, std::size_t i) {
  return {load3(corners[0], i), load3(corners[1], i), load3(corners[2], i)};
}
// A leaf's triangles, seen from the tree's origin.
HWY_INLINE Corners load_corners(const WideTree::Leaf& leaf, std::size_t i) {
  const Corners own = load_corners(leaf.corners, i);
  return {plus(own.p, leaf.center), plus(own.q, leaf.center), plus(own.r, leaf.center)};
}

HWY_INLINE void store_corners(const Corners& t, std::array<Rows, 3>& out, std::size_t i) {
  store3(t.p, out[0], i), store3(t.q, out[1], i), store3(t.r, out[2], i);
}
HWY_INLINE Corners set_corners(const std::array<Rows, 3>& corners, std::size_t lane) {
  return {set3(corners[0], lane), set3(corners[1], lane), set3(corners[2], lane)};
}

struct TriangleBoxes {
  V3 lo, hi;
};
HWY_INLINE TriangleBoxes boxes(const Corners& t) {
  const auto least = [](V a, V b, V c) HWY_ATTR { return hn::Min(hn::Min(a, b), c); };
  const auto most = [](V a, V b, V c) HWY_ATTR { return hn::Max(hn::Max(a, b), c); };
  return {{least(t.p.x, t.q.x, t.r.x), least(t.p.y, t.q.y, t.r.y), least(t.p.z, t.q.z, t.r.z)},
          {most(t.p.x, t.q.x, t.r.x), most(t.p.y, t.q.y, t.r.y), most(t.p.z, t.q.z, t.r.z)}};
}

// B's triangles in A's frame.
HWY_INLINE Corners moved(const Corners& at, const WideMotion& m) {
  const auto there = [&](const V3& p) { return plus(times(m.a_from_b, p), m.b_in_a); };
  return {there(at.p), there(at.q), there(at.r)};
}

}  // namespace peerd::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
