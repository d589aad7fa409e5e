// Highway includes this file again and again, to compile it once for each instruction set.
#include "collision/query/wide_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/query/wide_touch.cpp"
#include <hwy/foreach_target.h>  // NOLINT: before highway.h
#include <hwy/highway.h>
#include <cassert>

#include <algorithm>
#include <cmath>

#include "collision/query/wide_chosen.hpp"
#include "collision/query/wide_lanes.hpp"
#include "collision/query/wide_touch.hpp"

HWY_BEFORE_NAMESPACE();
namespace peerd::collision::HWY_NAMESPACE {

// Triangles, one to a lane, and their boxes.
struct Placed {
  std::array<Rows, 3> corners;
  Rows lo, hi;
};
HWY_INLINE void place(const Corners& t, std::size_t i, Placed& out) {
  store_corners(t, out.corners, i);
  const TriangleBoxes box = boxes(t);
  store3(box.lo, out.lo, i), store3(box.hi, out.hi, i);
}
// The longest sides of the boxes.
HWY_INLINE Row sizes(const Placed& placed) {
  Row out;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 sides = minus(load3(placed.hi, i), load3(placed.lo, i));
    store(hn::Max(hn::Max(sides.x, sides.y), sides.z), out, i);
  }
  return out;
}

// Returns those of B's triangles that are no farther than `off` from the box of all of A's.
HWY_INLINE std::uint32_t near_leaf(const Placed& b, std::uint32_t count_b, const WideTree::Leaf& a, float off) {
  std::uint32_t near = 0;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const auto along = [&](std::size_t k) HWY_ATTR {
      const V reach = set(a.half[k] + off);
      return hn::And(hn::Le(load(b.lo[k], i), reach), hn::Ge(load(b.hi[k], i), hn::Neg(reach)));
    };
    near |= bits(hn::And(hn::And(along(0), along(1)), along(2)), i);
  }
  return near & ((1u << count_b) - 1);
}

// The pairs whose boxes are no farther apart than `off`, of those rows of B's.
HWY_INLINE std::uint64_t near_pairs(const Placed& a, std::uint32_t count_a, const Placed& b, std::uint32_t rows,
                                    float off) {
  const std::uint32_t present = (1u << count_a) - 1;
  std::uint64_t near = 0;
  for (; rows != 0; rows &= rows - 1) {
    const auto row = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rows));
    std::uint32_t lanes = 0;
    for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
      const auto along = [&](std::size_t k) HWY_ATTR {
        return hn::And(hn::Le(load(a.lo[k], i), set(b.hi[k][row] + off)),
                       hn::Ge(load(a.hi[k], i), set(b.lo[k][row] - off)));
      };
      lanes |= bits(hn::And(hn::And(along(0), along(1)), along(2)), i);
    }
    near |= static_cast<std::uint64_t>(lanes & present) << (kWidth * row);
  }
  return near;
}

template <bool kOfA>
HWY_INLINE Corners chosen_corners(const std::array<Rows, 3>& corners, const RowLookup<kOfA>& chosen) {
  return {chosen(corners[0]), chosen(corners[1]), chosen(corners[2])};
}

// A bound of the error of ((u x v) . w) for vectors with coordinates below x, y and z, each of which may be off by
// 2 `off` beside its rounding: docs/decisions/collision-margins.md.
HWY_INLINE V margin(V x, V y, V z, float off) {
  const V areas = hn::Add(hn::Mul(x, y), hn::Mul(z, hn::Add(x, y)));
  const V volume = hn::Mul(hn::Mul(x, y), z);
  const V room = hn::Mul(set(0x1p-140f), hn::Add(hn::Max(hn::Max(x, y), z), set(1.0f)));
  return hn::Add(hn::Add(hn::Mul(areas, set(12.5f * off)), hn::Mul(volume, set(52.0f * 0x1p-24f))), room);
}

// The volumes of the corners of a triangle over the plane of another one.
struct Sides {
  V p, q, r;
};
HWY_INLINE Sides sides(const Corners& plane, const Corners& of) {
  const V3 normal = cross(minus(plane.q, plane.p), minus(plane.r, plane.p));
  return {dot(normal, minus(of.p, plane.p)), dot(normal, minus(of.q, plane.p)), dot(normal, minus(of.r, plane.p))};
}
HWY_INLINE auto on_one_side(const Sides& s, V bound) {
  const V least = hn::Min(hn::Min(s.p, s.q), s.r), most = hn::Max(hn::Max(s.p, s.q), s.r);
  return hn::Or(hn::Gt(least, bound), hn::Lt(most, hn::Neg(bound)));
}
HWY_INLINE auto known(const Sides& s, V bound) {
  return hn::Gt(hn::Min(hn::Min(hn::Abs(s.p), hn::Abs(s.q)), hn::Abs(s.r)), bound);
}

template <class M>
HWY_INLINE V3 select(M mask, const V3& yes, const V3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

// The corners from the one that is alone on its side, as in triangle_touch.hpp, of signs that are known.
template <class M>
struct FromLone {
  V3 lone, next, last;
  M above;
};
HWY_INLINE auto from_lone(const Corners& t, const Sides& s) {
  const V zero = hn::Zero(Lanes());
  const auto p = hn::Gt(s.p, zero), q = hn::Gt(s.q, zero), r = hn::Gt(s.r, zero);
  const auto is_p = hn::Not(hn::Xor(q, r)), is_r = hn::AndNot(is_p, hn::Not(hn::Xor(p, q)));
  using M = std::remove_const_t<decltype(p)>;
  const auto is_q = hn::Not(hn::Or(is_p, is_r));
  return FromLone<M>{select(is_p, t.p, select(is_r, t.r, t.q)), select(is_p, t.q, select(is_r, t.p, t.r)),
                     select(is_p, t.r, select(is_r, t.q, t.p)),
                     hn::Or(hn::Or(hn::And(is_p, p), hn::And(is_r, r)), hn::And(is_q, q))};
}
HWY_INLINE V volume(const V3& a, const V3& b, const V3& c, const V3& d) {
  return dot(cross(minus(b, a), minus(c, a)), minus(d, c));
}

struct Answers {
  std::uint32_t yes, unsure;
};
// Guigue's and Devillers's test, with three answers.
HWY_INLINE Answers touch_chosen(const Corners& a, const Corners& b, V size_a, V size_b, float off) {
  const V twice = set(2.0f * off);
  const V x = hn::Add(size_a, twice), y = hn::Add(size_b, twice), z = hn::Mul(hn::Add(x, y), set(1.0f + 0x1p-20f));
  const V bound_a = margin(x, x, z, off), bound_b = margin(y, y, z, off), bound = margin(x, y, z, off);
  const Sides of_b = sides(a, b), of_a = sides(b, a);
  auto no = hn::Or(on_one_side(of_b, bound_a), on_one_side(of_a, bound_b));
  if (hn::AllTrue(Lanes(), no)) return {0, 0};
  const auto sided = hn::And(known(of_b, bound_a), known(of_a, bound_b));
  const auto p = from_lone(a, of_a), q = from_lone(b, of_b);
  const V3 q_next = select(p.above, q.next, q.last), q_last = select(p.above, q.last, q.next);
  const V3 p_next = select(q.above, p.next, p.last), p_last = select(q.above, p.last, p.next);
  const V first = volume(p.lone, p_next, q.lone, q_next), second = volume(p.lone, p_last, q.lone, q_last);
  const V below = hn::Neg(bound);
  no = hn::Or(no, hn::And(sided, hn::Or(hn::Gt(first, bound), hn::Lt(second, below))));
  const auto meet = hn::And(hn::And(sided, hn::Lt(first, below)), hn::Gt(second, bound));
  const auto yes = hn::AndNot(no, meet);
  return {bits(yes, 0), bits(hn::Not(hn::Or(no, yes)), 0)};
}

// A bound of the error of a place relative to A's leaf: of A's corners' and B's together, and of comparing them.
HWY_INLINE float place_error(float reach_a, float reach_b, float apart, const WideMotion& m) {
  return 0x1p-24f * ((1.2f * reach_a + 13.5f * reach_b) + 3.6f * apart) + m.rounding_64;
}

bool TouchLeaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& m, WideTouch& touch) {
  std::array<float, 3> at;  // B's leaf from A's
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& r = m.a_from_b_64[k];
    const auto c = [](float x) { return static_cast<double>(x); };
    const double place = ((r[0] * c(b.center[0]) + r[1] * c(b.center[1])) + r[2] * c(b.center[2])) + m.b_in_a_64[k];
    at[k] = static_cast<float>(place - c(a.center[k]));
  }
  const auto largest = [](const std::array<float, 3>& p) {
    return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
  };
  const float reach_a = largest(a.half), reach_b = largest(b.half), apart = largest(at);
  constexpr float kLargest = 0x1p36f;  // products of three coordinates are far from an overflow
  if (!(reach_a + 2.0f * reach_b + apart <= kLargest)) return false;
  const float off = place_error(reach_a, reach_b, apart, m);
  touch.pairs.count = 0;
  touch.unsure = 0;
  Placed of_a, of_b;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Corners own = load_corners(b.corners, i);
    const auto there = [&](const V3& p) HWY_ATTR { return plus(times(m.a_from_b, p), at); };
    place({there(own.p), there(own.q), there(own.r)}, i, of_b);
  }
  const std::uint32_t rows = near_leaf(of_b, b.count, a, off);
  if (rows == 0) return true;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) place(load_corners(a.corners, i), i, of_a);
  std::uint64_t near = near_pairs(of_a, a.count, of_b, rows, off);
  if (near == 0) return true;
  const Row sizes_a = sizes(of_a), sizes_b = sizes(of_b);
  while (near != 0) {
    const ChosenLanes chosen = take_lanes(near);
    const RowLookup<true> in_a(chosen);
    const RowLookup<false> in_b(chosen);
    const Answers answers = touch_chosen(chosen_corners(of_a.corners, in_a), chosen_corners(of_b.corners, in_b),
                                         in_a(sizes_a), in_b(sizes_b), off);
    for (std::uint32_t rest = (answers.yes | answers.unsure) & chosen.present; rest != 0; rest &= rest - 1) {
      const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
      touch.unsure |= static_cast<std::uint64_t>(answers.unsure >> lane & 1u) << touch.pairs.count;
      touch.pairs.at[touch.pairs.count++] = pair_at(chosen, lane);
    }
  }
  return true;
}

}  // namespace peerd::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace peerd::collision {

HWY_EXPORT(TouchLeaves);

bool touch_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion, WideTouch& touch) {
  assert(motion.in_range && a.count >= 1 && a.count <= WideTree::kWidth && b.count >= 1 && b.count <= WideTree::kWidth);
  return HWY_DYNAMIC_DISPATCH(TouchLeaves)(a, b, motion, touch);
}

}  // namespace peerd::collision
#endif
