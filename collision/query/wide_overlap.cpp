// Highway includes this file again and again, to compile it once for each instruction set.
#include "collision/query/wide_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/query/wide_overlap.cpp"
#include <hwy/foreach_target.h>  // NOLINT: before highway.h
#include <hwy/highway.h>
#include <cassert>

#include <algorithm>

#include "collision/query/wide_lanes.hpp"
#include "collision/query/wide_overlap.hpp"

HWY_BEFORE_NAMESPACE();
namespace peerd::collision::HWY_NAMESPACE {

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

// Tests one box against the children of a node, each in the frame of the other.
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
  // NaN separates nothing: these comparisons are false then, and Not makes them true.
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
    const V margin = certain_margin(plane.size, per_size);
    for (std::size_t row = 0; row < b.count; ++row) {
      const V3 lo = set3(moved.lo, row), hi = set3(moved.hi, row);
      auto mask = hn::And(hn::And(hn::Le(box.lo.x, hi.x), hn::Le(lo.x, box.hi.x)),
                          hn::And(hn::Le(box.lo.y, hi.y), hn::Le(lo.y, box.hi.y)));
      mask = hn::And(mask, hn::And(hn::Le(box.lo.z, hi.z), hn::Le(lo.z, box.hi.z)));
      if (hn::AllFalse(Lanes(), mask)) continue;
      const Corners other{set3(moved.corners[0], row), set3(moved.corners[1], row), set3(moved.corners[2], row)};
      mask = hn::And(mask, not_on_one_side(plane.normal, margin, corners.p, other));
      const V margin_b = certain_margin(set(moved.size[row]), per_size);
      mask = hn::And(mask, not_on_one_side(set3(moved.normal, row), margin_b, other.p, corners));
      masks[row] = static_cast<std::uint8_t>(masks[row] | (bits(mask, i) & present));
    }
  }
}

}  // namespace peerd::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace peerd::collision {

HWY_EXPORT(TestNodes);
HWY_EXPORT(TestNodeLeaf);
HWY_EXPORT(TestLeafNode);
HWY_EXPORT(TestLeaves);

void test_nodes(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion, Masks& masks) {
  HWY_DYNAMIC_DISPATCH(TestNodes)(a, b, motion, masks);
}
std::uint8_t test_node_leaf(const WideTree::Node& a, const WideTree::Leaf& b, const WideMotion& motion) {
  return HWY_DYNAMIC_DISPATCH(TestNodeLeaf)(a, b, motion);
}
std::uint8_t test_leaf_node(const WideTree::Leaf& a, const WideTree::Node& b, const WideMotion& motion) {
  return HWY_DYNAMIC_DISPATCH(TestLeafNode)(a, b, motion);
}
void test_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion, Masks& masks) {
  assert(a.count >= 1 && a.count <= WideTree::kWidth && b.count >= 1 && b.count <= WideTree::kWidth);
  HWY_DYNAMIC_DISPATCH(TestLeaves)(a, b, motion, masks);
}

}  // namespace peerd::collision
#endif
