// This file is compiled once for each instruction set: Highway includes it again and again.
// Highway 1.0 doesn't make this set by itself, and stops where it is what the compiler may use anyway.
#if defined(__AVX512VNNI__) && !defined(HWY_WANT_AVX3_DL)
#define HWY_WANT_AVX3_DL
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/wide_kernels.cpp"
#include <hwy/foreach_target.h>  // NOLINT: before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision/wide_kernels.hpp"

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
HWY_INLINE V3 load3(const Rows& rows, std::size_t i) { return {load(rows[0], i), load(rows[1], i), load(rows[2], i)}; }
HWY_INLINE V3 set3(const Rows& rows, std::size_t lane) {
  return {set(rows[0][lane]), set(rows[1][lane]), set(rows[2][lane])};
}
HWY_INLINE V3 minus(const V3& a, const V3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
// No MulAdd: every instruction set gives the same bits, so that counters are the same too.
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

HWY_INLINE auto overlap(const V3& center_a, const V3& half_a, const V3& center_b, const V3& half_b) {
  const auto along = [](V ca, V ha, V cb, V hb) { return hn::Le(hn::Abs(hn::Sub(ca, cb)), hn::Add(ha, hb)); };
  return hn::And(
      hn::And(along(center_a.x, half_a.x, center_b.x, half_b.x), along(center_a.y, half_a.y, center_b.y, half_b.y)),
      along(center_a.z, half_a.z, center_b.z, half_b.z));
}

void TestNodes(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& m, Masks& masks) {
  Boxes b_in_a, a_in_b;
  to_a(b, m, b_in_a);
  to_b(a, m, a_in_b);
  masks.fill(0);
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 center_a = load3(a.center, i), half_a = load3(a.half, i);
    const V3 center_in_b = load3(a_in_b.center, i), half_in_b = load3(a_in_b.half, i);
    for (std::size_t row = 0; row < kWidth; ++row) {
      const auto in_a = overlap(center_a, half_a, set3(b_in_a.center, row), set3(b_in_a.half, row));
      const auto in_b = overlap(center_in_b, half_in_b, set3(b.center, row), set3(b.half, row));
      masks[row] = static_cast<std::uint8_t>(masks[row] | bits(hn::And(in_a, in_b), i));
    }
  }
}

HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

// Velocities of the middles of a node's boxes, in either frame, and how much faster other points in them are at most.
struct Velocities {
  Rows in_own, in_other;
  Row spread;
};
template <class ToOther>
HWY_INLINE void velocities(const WideTree::Node& node, const std::array<float, 3>& base,
                           const std::array<float, 3>& turn, float rate, ToOther to_other, Velocities& out) {
  const V3 axis{set(turn[0]), set(turn[1]), set(turn[2])};
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 v = plus(cross(axis, load3(node.center, i)), base), other = to_other(v), half = load3(node.half, i);
    store(v.x, out.in_own[0], i), store(v.y, out.in_own[1], i), store(v.z, out.in_own[2], i);
    store(other.x, out.in_other[0], i), store(other.y, out.in_other[1], i), store(other.z, out.in_other[2], i);
    store(hn::Mul(set(rate), hn::Sqrt(dot(half, half))), out.spread, i);
  }
}

// Along an axis: boxes with a gap that is not closed by then, whichever is on the positive side.
HWY_INLINE auto apart_along(V from_a_to_b, V reach, V velocity_a, V velocity_b, V spare, V within) {
  const V gap = hn::Sub(hn::Abs(from_a_to_b), reach);
  const V closing =
      hn::Add(hn::Xor(hn::Sub(velocity_a, velocity_b), hn::And(from_a_to_b, hn::SignBit(Lanes()))), spare);
  return hn::Gt(gap, hn::Max(hn::Mul(closing, within), hn::Zero(Lanes())));
}

void NodesMayMeet(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& m, const WideSpeeds& s,
                  float within_s, Masks& masks) {
  Boxes b_in_a, a_in_b;
  to_a(b, m, b_in_a);
  to_b(a, m, a_in_b);
  Velocities of_a, of_b;
  velocities(
      a, s.base_a, s.turn_a, s.rate_a, [&](const V3& v) { return times(m.b_from_a, v); }, of_a);
  velocities(
      b, s.base_b, s.turn_b, s.rate_b, [&](const V3& v) { return times(m.a_from_b, v); }, of_b);
  const V within = set(within_s);
  masks.fill(0);
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const auto there = hn::Ge(load(a.half[0], i), hn::Zero(Lanes()));
    for (std::size_t row = 0; row < kWidth; ++row) {
      if (b.half[0][row] < 0.0f) continue;
      const V spare = hn::Add(load(of_a.spread, i), set(of_b.spread[row] + s.spare_m_s));
      auto apart = hn::Not(there);
      for (std::size_t k = 0; k < 3; ++k) {
        apart = hn::Or(apart, apart_along(hn::Sub(set(b_in_a.center[k][row]), load(a.center[k], i)),
                                          hn::Add(load(a.half[k], i), set(b_in_a.half[k][row])),
                                          load(of_a.in_own[k], i), set(of_b.in_other[k][row]), spare, within));
      }
      if (hn::AllTrue(Lanes(), apart)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        apart = hn::Or(apart, apart_along(hn::Sub(set(b.center[k][row]), load(a_in_b.center[k], i)),
                                          hn::Add(load(a_in_b.half[k], i), set(b.half[k][row])),
                                          load(of_a.in_other[k], i), set(of_b.in_own[k][row]), spare, within));
      }
      masks[row] = static_cast<std::uint8_t>(masks[row] | bits(hn::Not(apart), i));
    }
  }
}

// One box against the children of a node, each in the frame of the other.
HWY_INLINE std::uint8_t one_against(const std::array<float, 3>& center, const std::array<float, 3>& half,
                                    const std::array<float, 3>& center_there, const std::array<float, 3>& half_there,
                                    const WideTree::Node& node, const Boxes& node_here) {
  std::uint32_t out = 0;
  const auto all = [](const std::array<float, 3>& p) { return V3{set(p[0]), set(p[1]), set(p[2])}; };
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const auto there = overlap(load3(node.center, i), load3(node.half, i), all(center_there), all(half_there));
    const auto here = overlap(load3(node_here.center, i), load3(node_here.half, i), all(center), all(half));
    out |= bits(hn::And(there, here), i);
  }
  return static_cast<std::uint8_t>(out);
}

// A leaf's box as a box of the other's frame.
HWY_INLINE void transform(const WideTree::Leaf& leaf, const Matrix& rotation, const Matrix& sizes,
                          const std::array<float, 3>& origin, float slack, std::array<float, 3>& center,
                          std::array<float, 3>& half) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto &r = rotation[k], &s = sizes[k];
    center[k] = ((r[0] * leaf.center[0] + r[1] * leaf.center[1]) + r[2] * leaf.center[2]) + origin[k];
    half[k] = ((s[0] * leaf.half[0] + s[1] * leaf.half[1]) + s[2] * leaf.half[2]) + slack;
  }
}

std::uint8_t TestNodeLeaf(const WideTree::Node& a, const WideTree::Leaf& b, const WideMotion& m) {
  Boxes a_in_b;
  to_b(a, m, a_in_b);
  std::array<float, 3> center, half;
  transform(b, m.a_from_b, m.a_from_b_sizes, m.b_in_a, m.slack_a, center, half);
  return one_against(b.center, b.half, center, half, a, a_in_b);
}

std::uint8_t TestLeafNode(const WideTree::Leaf& a, const WideTree::Node& b, const WideMotion& m) {
  Boxes b_in_a;
  to_a(b, m, b_in_a);
  std::array<float, 3> center, half;
  transform(a, m.b_from_a, m.b_from_a_sizes, m.a_in_b, m.slack_b, center, half);
  return one_against(a.center, a.half, center, half, b, b_in_a);
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

HWY_INLINE Corners load_corners(const std::array<Rows, 3>& corners, std::size_t i) {
  return {load3(corners[0], i), load3(corners[1], i), load3(corners[2], i)};
}

struct TriangleBoxes {
  V3 lo, hi;
};
HWY_INLINE TriangleBoxes boxes(const Corners& t) {
  const auto least = [](V a, V b, V c) { return hn::Min(hn::Min(a, b), c); };
  const auto most = [](V a, V b, V c) { return hn::Max(hn::Max(a, b), c); };
  return {{least(t.p.x, t.q.x, t.r.x), least(t.p.y, t.q.y, t.r.y), least(t.p.z, t.q.z, t.r.z)},
          {most(t.p.x, t.q.x, t.r.x), most(t.p.y, t.q.y, t.r.y), most(t.p.z, t.q.z, t.r.z)}};
}

// B's triangles in A's frame, one to a lane.
struct Moved {
  std::array<Rows, 3> corners;
  Rows lo, hi, normal;
  Row size;
};

HWY_INLINE void move(const WideTree::Leaf& b, const WideMotion& m, Moved& out) {
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const auto moved = [&](std::size_t c) {
      const V3 p = plus(times(m.a_from_b, load3(b.corners[c], i)), m.b_in_a);
      store(p.x, out.corners[c][0], i), store(p.y, out.corners[c][1], i), store(p.z, out.corners[c][2], i);
      return p;
    };
    const V3 p = moved(0), q = moved(1), r = moved(2);
    const Corners corners{p, q, r};
    const TriangleBoxes box = boxes(corners);
    const V slack = set(m.slack_a);
    store(hn::Sub(box.lo.x, slack), out.lo[0], i), store(hn::Sub(box.lo.y, slack), out.lo[1], i);
    store(hn::Sub(box.lo.z, slack), out.lo[2], i), store(hn::Add(box.hi.x, slack), out.hi[0], i);
    store(hn::Add(box.hi.y, slack), out.hi[1], i), store(hn::Add(box.hi.z, slack), out.hi[2], i);
    const Planes plane = planes(corners);
    store(plane.normal.x, out.normal[0], i), store(plane.normal.y, out.normal[1], i);
    store(plane.normal.z, out.normal[2], i), store(plane.size, out.size, i);
  }
}

// Triangles with a corner of the other one not certainly on the same side of a plane as the others.
HWY_INLINE auto not_on_one_side(const V3& normal, V margin, const V3& origin, const Corners& of) {
  const V d = dot(normal, minus(of.p, origin)), e = dot(normal, minus(of.q, origin)),
          f = dot(normal, minus(of.r, origin));
  const V least = hn::Min(hn::Min(d, e), f), most = hn::Max(hn::Max(d, e), f);
  // What is no number is not certain: these comparisons are false then, and Not makes them true.
  return hn::Not(hn::Or(hn::Gt(least, margin), hn::Lt(most, hn::Neg(margin))));
}

void TestLeaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& m, Masks& masks) {
  Moved moved;
  move(b, m, moved);
  // Triangles whose boxes overlap have no coordinates farther apart than this.
  float reach = 0.0f;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& sizes = m.a_from_b_sizes[k];
    reach = std::max({reach, a.half[k], (sizes[0] * b.half[0] + sizes[1] * b.half[1]) + sizes[2] * b.half[2]});
  }
  reach = 4.5f * (reach + m.slack_a);
  masks.fill(0);
  const std::uint32_t present = (1u << a.count) - 1;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Corners corners = load_corners(a.corners, i);
    const TriangleBoxes box = boxes(corners);
    const Planes plane = planes(corners);
    // A plane separates where its normal does, whatever the normal. The corners of its own triangle are off it by what
    // the normal's rounding makes of their distances, 11 units in the last place of size * reach together with the
    // rounding of the dot products; both triangles' corners may be off by the slack.
    const V per_size = set(0x1p-20f * reach + 2.0f * m.slack_a);
    const V margin = hn::Mul(plane.size, per_size);
    for (std::size_t row = 0; row < b.count; ++row) {
      const V3 lo = set3(moved.lo, row), hi = set3(moved.hi, row);
      auto mask = hn::And(hn::And(hn::Le(box.lo.x, hi.x), hn::Le(lo.x, box.hi.x)),
                          hn::And(hn::Le(box.lo.y, hi.y), hn::Le(lo.y, box.hi.y)));
      mask = hn::And(mask, hn::And(hn::Le(box.lo.z, hi.z), hn::Le(lo.z, box.hi.z)));
      if (hn::AllFalse(Lanes(), mask)) continue;
      const Corners other{set3(moved.corners[0], row), set3(moved.corners[1], row), set3(moved.corners[2], row)};
      mask = hn::And(mask, not_on_one_side(plane.normal, margin, corners.p, other));
      const V margin_b = hn::Mul(set(moved.size[row]), per_size);
      mask = hn::And(mask, not_on_one_side(set3(moved.normal, row), margin_b, other.p, corners));
      masks[row] = static_cast<std::uint8_t>(masks[row] | (bits(mask, i) & present));
    }
  }
}

// What the corners of eight triangles come to when they go on as they do now, one to a lane.
HWY_INLINE Corners gone_on(const Corners& at, const std::array<float, 3>& base, const std::array<float, 3>& turn,
                           float within_s) {
  const V3 axis{set(turn[0]), set(turn[1]), set(turn[2])};
  const V within = set(within_s);
  const auto later = [&](const V3& p) {
    const V3 v = plus(cross(axis, p), base);
    return V3{hn::Add(p.x, hn::Mul(v.x, within)), hn::Add(p.y, hn::Mul(v.y, within)),
              hn::Add(p.z, hn::Mul(v.z, within))};
  };
  return {later(at.p), later(at.q), later(at.r)};
}

HWY_INLINE Corners moved(const Corners& at, const WideMotion& m) {
  const auto there = [&](const V3& p) { return plus(times(m.a_from_b, p), m.b_in_a); };
  return {there(at.p), there(at.q), there(at.r)};
}

HWY_INLINE void store_corners(const Corners& t, std::array<Rows, 3>& out, std::size_t i) {
  const auto put = [&](const V3& p, Rows& rows) {
    store(p.x, rows[0], i), store(p.y, rows[1], i), store(p.z, rows[2], i);
  };
  put(t.p, out[0]), put(t.q, out[1]), put(t.r, out[2]);
}
HWY_INLINE Corners set_corners(const std::array<Rows, 3>& corners, std::size_t lane) {
  return {set3(corners[0], lane), set3(corners[1], lane), set3(corners[2], lane)};
}

// What triangles take up along a direction, now and later.
struct Reach {
  V low, high, low_later, high_later;
};
// Of their three corners' places.
HWY_INLINE Reach reach_of(const V3& now, const V3& later) {
  return {hn::Min(hn::Min(now.x, now.y), now.z), hn::Max(hn::Max(now.x, now.y), now.z),
          hn::Min(hn::Min(later.x, later.y), later.z), hn::Max(hn::Max(later.x, later.y), later.z)};
}
HWY_INLINE Reach reach_along(const V3& n, const Corners& now, const Corners& later) {
  return reach_of({dot(n, now.p), dot(n, now.q), dot(n, now.r)}, {dot(n, later.p), dot(n, later.q), dot(n, later.r)});
}

HWY_INLINE V coordinate(const V3& p, std::size_t k) { return k == 0 ? p.x : k == 1 ? p.y : p.z; }
// Along an axis.
HWY_INLINE Reach reach_of(const Corners& now, const Corners& later, std::size_t k) {
  return reach_of({coordinate(now.p, k), coordinate(now.q, k), coordinate(now.r, k)},
                  {coordinate(later.p, k), coordinate(later.q, k), coordinate(later.r, k)});
}
HWY_INLINE V farthest_of(const Reach& reach) {
  return hn::Max(hn::Max(hn::Abs(reach.low), hn::Abs(reach.high)),
                 hn::Max(hn::Abs(reach.low_later), hn::Abs(reach.high_later)));
}

// More than `margin` between them, now and later, on the same side. Corners move along straight lines between the two,
// so the gap is a concave function of time, and is there in between as well.
HWY_INLINE auto apart_along(const Reach& a, const Reach& b, V margin) {
  const auto ahead = [&](const Reach& low, const Reach& high) {
    return hn::And(hn::Gt(hn::Sub(high.low, low.high), margin),
                   hn::Gt(hn::Sub(high.low_later, low.high_later), margin));
  };
  return hn::Or(ahead(a, b), ahead(b, a));
}

// Of triangles one to a lane: by x, y and z.
struct Reaches {
  Rows low, high, low_later, high_later;
};

void LeavesMayMeet(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& m, const WideSpeeds& s,
                   float within_s, Masks& masks) {
  std::array<Rows, 3> corners, later;
  Reaches reaches;
  Rows normal;
  Row size, far;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Corners own = load_corners(b.corners, i);
    const Corners here = moved(own, m), there = moved(gone_on(own, s.base_b, s.turn_b, within_s), m);
    const Planes plane = planes(here);
    store_corners(here, corners, i);
    store_corners(there, later, i);
    store(plane.normal.x, normal[0], i), store(plane.normal.y, normal[1], i), store(plane.normal.z, normal[2], i);
    store(plane.size, size, i);
    V farthest = hn::Zero(Lanes());
    for (std::size_t k = 0; k < 3; ++k) {
      const Reach reach = reach_of(here, there, k);
      store(reach.low, reaches.low[k], i), store(reach.high, reaches.high[k], i);
      store(reach.low_later, reaches.low_later[k], i), store(reach.high_later, reaches.high_later[k], i);
      farthest = hn::Max(farthest, farthest_of(reach));
    }
    store(farthest, far, i);
  }
  masks.fill(0);
  const std::uint32_t present = (1u << a.count) - 1;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Corners here = load_corners(a.corners, i), there = gone_on(here, s.base_a, s.turn_a, within_s);
    const Reach of_a[3] = {reach_of(here, there, 0), reach_of(here, there, 1), reach_of(here, there, 2)};
    const V far_a = hn::Max(hn::Max(farthest_of(of_a[0]), farthest_of(of_a[1])), farthest_of(of_a[2]));
    const Planes plane = planes(here);
    const Reach across = reach_along(plane.normal, here, there);
    for (std::size_t row = 0; row < b.count; ++row) {
      // What corners are off by: rounding, on the way there and in dot products; and what their velocities change by.
      const V off = hn::Add(set(2.0f * m.slack_a + s.spare_m_s * within_s),
                            hn::Mul(hn::Add(far_a, set(far[row])), set(0x1p-19f)));
      auto apart = hn::Lt(off, hn::Zero(Lanes()));  // none yet
      for (std::size_t k = 0; k < 3; ++k) {
        const Reach of_b{set(reaches.low[k][row]), set(reaches.high[k][row]), set(reaches.low_later[k][row]),
                         set(reaches.high_later[k][row])};
        apart = hn::Or(apart, apart_along(of_a[k], of_b, off));
      }
      if (hn::AllTrue(Lanes(), apart)) continue;
      const Corners other = set_corners(corners, row), other_later = set_corners(later, row);
      apart =
          hn::Or(apart, apart_along(across, reach_along(plane.normal, other, other_later), hn::Mul(plane.size, off)));
      const V3 n = set3(normal, row);
      apart = hn::Or(apart, apart_along(reach_along(n, here, there), reach_along(n, other, other_later),
                                        hn::Mul(set(size[row]), off)));
      masks[row] = static_cast<std::uint8_t>(masks[row] | (bits(hn::Not(apart), i) & present));
    }
  }
}

// What is no number, or too large for one, is unknown: 0.
HWY_INLINE V known(V x) {
  const V zero = hn::Zero(Lanes());
  const V positive = hn::IfThenElseZero(hn::Gt(x, zero), x);
  return hn::IfThenElseZero(hn::Lt(positive, set(std::numeric_limits<float>::infinity())), positive);
}

constexpr float kRoundedDown = 1.0f - 0x1p-20f;  // a few operations, each of which may be off by 2^-24

// At most the length of three gaps. Where their squares over- or underflow, it is the largest of them.
HWY_INLINE V length_of_gaps(V x, V y, V z) {
  const V square = dot({x, y, z}, {x, y, z});
  const V length = hn::IfThenElseZero(hn::Gt(square, set(0x1p-100f)), hn::Mul(hn::Sqrt(square), set(kRoundedDown)));
  return hn::Max(known(length), hn::Max(hn::Max(x, y), z));
}
HWY_INLINE V gap_of_boxes(const V3& center_a, const V3& half_a, const V3& center_b, const V3& half_b) {
  const auto along = [](V ca, V ha, V cb, V hb) { return known(hn::Sub(hn::Abs(hn::Sub(ca, cb)), hn::Add(ha, hb))); };
  return length_of_gaps(along(center_a.x, half_a.x, center_b.x, half_b.x),
                        along(center_a.y, half_a.y, center_b.y, half_b.y),
                        along(center_a.z, half_a.z, center_b.z, half_b.z));
}

HWY_INLINE std::uint32_t first_bits(std::size_t count) { return (1u << count) - 1; }

// Files the lanes from i on of a row of lower bounds.
HWY_INLINE void file(V lower, V most, std::uint32_t count_a, std::size_t row, std::size_t i, Distances& out) {
  store(lower, out.lower[row], i);
  const std::uint32_t lanes = first_bits(hn::Lanes(Lanes())) << i;
  const std::uint32_t below = bits(hn::Lt(lower, most), i) & lanes & first_bits(count_a);
  out.below[row] = static_cast<std::uint8_t>((out.below[row] & ~lanes) | below);
}
// The least that is filed and not below `most`.
HWY_INLINE float least_skipped(std::uint32_t count_a, std::uint32_t count_b, float most, const Distances& distances) {
  constexpr Row kNumbers = {0, 1, 2, 3, 4, 5, 6, 7};
  const V none = set(std::numeric_limits<float>::infinity());
  V least = none;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const auto there = hn::Lt(load(kNumbers, i), set(static_cast<float>(count_a)));
    for (std::size_t row = 0; row < count_b; ++row) {
      const V lower = load(distances.lower[row], i);
      least = hn::Min(least, hn::IfThenElse(hn::And(there, hn::Ge(lower, set(most))), lower, none));
    }
  }
  return hn::GetLane(hn::MinOfLanes(Lanes(), least));
}

// Along the line of the centers n, which is n_b in B's frame: n^2 less how far the boxes reach along it, over its
// length. n_b is off the turned n by two places' rounding, so B's reach by 4 slacks times its size over |n|: for boxes
// that are no larger than they are apart, that and the places' own are below 8.
HWY_INLINE V gap_along_centers(const V3& center_a, const V3& half_a, const V3& center_a_in_b, const V3& center_b_in_a,
                               const V3& half_b, const V3& center_b, V a_from_b, float slack) {
  const auto reach = [](const V3& half, const V3& n) { return dot(half, {hn::Abs(n.x), hn::Abs(n.y), hn::Abs(n.z)}); };
  const V3 n = minus(center_b_in_a, center_a), n_b = minus(center_b, center_a_in_b);
  const V square = dot(n, n);
  const V gap = hn::Sub(hn::Sub(square, reach(half_a, n)), hn::Mul(hn::Mul(reach(half_b, n_b), a_from_b), a_from_b));
  const V certain = hn::Sub(hn::Mul(hn::Div(gap, hn::Sqrt(square)), set(kRoundedDown)), set(8.0f * slack));
  const V size_b = hn::Mul(hn::Add(hn::Add(half_b.x, half_b.y), half_b.z), a_from_b);
  const auto good = hn::And(hn::Gt(square, set(0x1p-100f)), hn::Le(hn::Mul(size_b, size_b), square));
  return hn::IfThenElseZero(good, known(certain));
}

void DistancesOfNodes(const WideTree::Node& a, std::uint32_t count_a, const WideTree::Node& b, std::uint32_t count_b,
                      const WideMotion& m, float most, Distances& out) {
  Boxes b_in_a, a_in_b;
  to_a(b, m, b_in_a);
  to_b(a, m, a_in_b);
  out.below.fill(0);
  const V a_from_b = set(m.scale_a_from_b), largest = set(std::numeric_limits<float>::max());
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 center_a = load3(a.center, i), half_a = load3(a.half, i);
    const V3 center_in_b = load3(a_in_b.center, i), half_in_b = load3(a_in_b.half, i);
    for (std::size_t row = 0; row < count_b; ++row) {
      const V in_a = gap_of_boxes(center_a, half_a, set3(b_in_a.center, row), set3(b_in_a.half, row));
      const V in_b = gap_of_boxes(center_in_b, half_in_b, set3(b.center, row), set3(b.half, row));
      // Not where the other scale makes a subnormal number of it, which may be rounded up.
      const V scaled_b = hn::Min(hn::Mul(in_b, a_from_b), largest);
      const V in_b_known = hn::IfThenElseZero(hn::Gt(scaled_b, set(0x1p-100f)), scaled_b);
      const V line = gap_along_centers(center_a, half_a, center_in_b, set3(b_in_a.center, row), set3(b.half, row),
                                       set3(b.center, row), a_from_b, m.slack_a);
      file(hn::Max(line, hn::Max(in_a, in_b_known)), set(most), count_a, row, i, out);
    }
  }
  out.skipped = least_skipped(count_a, count_b, most, out);
}

HWY_INLINE V clamped(V x) {  // what is no number becomes 0
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
// As triangle_distance.cpp's.
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

// A direction from A to B, in A's frame. Its length is known well enough not to round up what is divided by it.
struct Direction {
  std::array<float, 3> n;
  float inverse;  // 0 where it has none
};
HWY_INLINE Direction direction(const std::array<float, 3>& n) {
  const float square = (n[0] * n[0] + n[1] * n[1]) + n[2] * n[2];
  const bool good = square > 0x1p-100f && square < 0x1p100f;
  return {n, good ? kRoundedDown / std::sqrt(square) : 0.0f};
}

// How far the triangles reach along it, from `origin`: A's to the last, B's from the first.
HWY_INLINE V along(const Direction& d, const V3& p, const V3& origin) {
  return dot({set(d.n[0]), set(d.n[1]), set(d.n[2])}, minus(p, origin));
}
HWY_INLINE V last_along(const Direction& d, const Corners& t, const V3& origin) {
  return hn::Max(hn::Max(along(d, t.p, origin), along(d, t.q, origin)), along(d, t.r, origin));
}
HWY_INLINE V first_along(const Direction& d, const Corners& t, const V3& origin) {
  return hn::Min(hn::Min(along(d, t.p, origin), along(d, t.q, origin)), along(d, t.r, origin));
}

void DistancesOfLeaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& m,
                       const std::array<float, 3>& guess, float most, Distances& out,
                       std::array<Row, kWidth>& estimates) {
  std::array<float, 3> center, half;
  transform(b, m.a_from_b, m.a_from_b_sizes, m.b_in_a, m.slack_a, center, half);
  const std::array<Direction, 2> directions = {
      direction(guess), direction({center[0] - a.center[0], center[1] - a.center[1], center[2] - a.center[2]})};
  const V3 origin{set(a.center[0]), set(a.center[1]), set(a.center[2])};
  std::array<Rows, 3> moved;
  std::array<Row, 2> firsts;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const auto corner = [&](std::size_t c) {
      const V3 p = plus(times(m.a_from_b, load3(b.corners[c], i)), m.b_in_a);
      store(p.x, moved[c][0], i), store(p.y, moved[c][1], i), store(p.z, moved[c][2], i);
      return p;
    };
    const V3 p = corner(0), q = corner(1), r = corner(2);
    for (std::size_t n = 0; n < 2; ++n) store(first_along(directions[n], {p, q, r}, origin), firsts[n], i);
  }
  out.below.fill(0);
  const V slack = set(3.0f * m.slack_a);
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Corners corners = load_corners(a.corners, i);
    const std::array<V, 2> lasts = {last_along(directions[0], corners, origin),
                                    last_along(directions[1], corners, origin)};
    std::uint32_t open = 0;
    for (std::size_t row = 0; row < b.count; ++row) {
      const auto gap = [&](std::size_t n) {
        return known(hn::Sub(hn::Mul(hn::Sub(set(firsts[n][row]), lasts[n]), set(directions[n].inverse)), slack));
      };
      file(hn::Max(gap(0), gap(1)), set(most), a.count, row, i, out);
      open |= out.below[row];
    }
    if (open >> i == 0) continue;
    const Shape shape_a = shape(corners);
    for (std::size_t row = 0; row < b.count; ++row) {
      if (out.below[row] >> i == 0) continue;
      const Shape shape_b = shape({set3(moved[0], row), set3(moved[1], row), set3(moved[2], row)});
      const Shortest found = shortest(shape_a, shape_b);
      const V before = load(out.lower[row], i), gap = gap_along(found, corners, shape_b.corners, m.slack_a);
      // Only where it was asked for, however many lanes there are: the rest is the same on every machine then.
      const V lower = hn::Max(before, hn::IfThenElseZero(hn::Lt(before, set(most)), gap));
      file(lower, set(most), a.count, row, i, out);
      store(hn::Sqrt(found.square), estimates[row], i);
    }
  }
  out.skipped = least_skipped(a.count, b.count, most, out);
}

}  // namespace peerd::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace peerd::collision {

HWY_EXPORT(TestNodes);
HWY_EXPORT(NodesMayMeet);
HWY_EXPORT(LeavesMayMeet);
HWY_EXPORT(TestNodeLeaf);
HWY_EXPORT(TestLeafNode);
HWY_EXPORT(TestLeaves);
HWY_EXPORT(DistancesOfNodes);
HWY_EXPORT(DistancesOfLeaves);

WideMotion::WideMotion(const WideTree& a, const WideTree& b, const RelativeMotion& motion, double room_m) {
  const Vec3 origin = motion(b.origin()) - a.origin();
  const Vec3 home = multiply(Mat3(motion.rotation.transpose()), Vec3(-origin));
  const double to_a = a.scale() / b.scale(), to_b = b.scale() / a.scale();
  scale_a_from_b = static_cast<float>(to_a);
  double farthest = 0.0;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int j = 0; j < 3; ++j) {
      const auto l = static_cast<std::size_t>(j);
      a_from_b[k][l] = static_cast<float>(motion.rotation(i, j) * to_a);
      b_from_a[k][l] = static_cast<float>(motion.rotation(j, i) * to_b);
      a_from_b_sizes[k][l] = std::abs(a_from_b[k][l]);
      b_from_a_sizes[k][l] = std::abs(b_from_a[k][l]);
    }
    b_in_a[k] = static_cast<float>(origin[i] * a.scale());
    a_in_b[k] = static_cast<float>(home[i] * b.scale());
    farthest = std::max({farthest, std::abs(origin[i]), std::abs(home[i])});
  }
  // Each of some 20 roundings is of a number below the sum in brackets (its terms' factors are at most sqrt(3)), by at
  // most 2^-24 of it. Binary64, in which vertices are moved for the exact test, is lost in that; but vertices far from
  // their soup's origin lose more there.
  const auto far = [](const WideTree& tree) { return tree.origin().cwiseAbs().maxCoeff() + tree.extent_m(); };
  const double binary64 = 0x1p-46 * (far(a) + far(b) + motion.translation.cwiseAbs().maxCoeff());
  const double slack_m = 0x1p-19 * (2.0 * a.extent_m() + 2.0 * b.extent_m() + farthest + room_m) + binary64 + room_m;
  slack_a = static_cast<float>(slack_m * a.scale() + 0x1p-120);
  slack_b = static_cast<float>(slack_m * b.scale() + 0x1p-120);
}

void test_nodes(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion, Masks& masks) {
  HWY_DYNAMIC_DISPATCH(TestNodes)(a, b, motion, masks);
}
void nodes_may_meet(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion,
                    const WideSpeeds& speeds, float within_s, Masks& masks) {
  HWY_DYNAMIC_DISPATCH(NodesMayMeet)(a, b, motion, speeds, within_s, masks);
}
void leaves_may_meet(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion,
                     const WideSpeeds& speeds, float within_s, Masks& masks) {
  HWY_DYNAMIC_DISPATCH(LeavesMayMeet)(a, b, motion, speeds, within_s, masks);
}
void distances_of_nodes(const WideTree::Node& a, std::uint32_t count_a, const WideTree::Node& b, std::uint32_t count_b,
                        const WideMotion& motion, float most, Distances& distances) {
  HWY_DYNAMIC_DISPATCH(DistancesOfNodes)(a, count_a, b, count_b, motion, most, distances);
}
void distances_of_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion,
                         const std::array<float, 3>& guess, float most, Distances& distances, DistanceRows& estimates) {
  HWY_DYNAMIC_DISPATCH(DistancesOfLeaves)(a, b, motion, guess, most, distances, estimates);
}

std::uint8_t test_node_leaf(const WideTree::Node& a, const WideTree::Leaf& b, const WideMotion& motion) {
  return HWY_DYNAMIC_DISPATCH(TestNodeLeaf)(a, b, motion);
}
std::uint8_t test_leaf_node(const WideTree::Leaf& a, const WideTree::Node& b, const WideMotion& motion) {
  return HWY_DYNAMIC_DISPATCH(TestLeafNode)(a, b, motion);
}
void test_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion, Masks& masks) {
  HWY_DYNAMIC_DISPATCH(TestLeaves)(a, b, motion, masks);
}

}  // namespace peerd::collision
#endif
