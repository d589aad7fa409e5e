// Highway includes this file again and again, to compile it once for each instruction set.
#include "collision/query/wide_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/query/wide_overlap.cpp"
#include <hwy/foreach_target.h>  // NOLINT: before highway.h
#include <hwy/highway.h>
#include <cassert>

#include <algorithm>

#include "collision/query/wide_chosen.hpp"
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

// Boxes are apart where they are along one of the axes by more than the slack, which has room for all that is off.
HWY_INLINE auto overlap(const OrientedBoxes& a, const OrientedBoxes& b, V slack) {
  const SeparatingAxes f(a, b);
  const auto along = [&](V distance, V reach) HWY_ATTR { return hn::Le(hn::Abs(distance), hn::Add(reach, slack)); };
  auto near = hn::And(
      hn::And(hn::And(along(f.t[0], f.reach_along_a<0>()), along(f.t[1], f.reach_along_a<1>())),
              along(f.t[2], f.reach_along_a<2>())),
      hn::And(hn::And(along(f.along_b<0>(f.t), f.reach_along_b<0>()), along(f.along_b<1>(f.t), f.reach_along_b<1>())),
              along(f.along_b<2>(f.t), f.reach_along_b<2>())));
  if (hn::AllFalse(Lanes(), near)) return near;
  const auto across = [&]<std::size_t i>() HWY_ATTR {
    return hn::And(hn::And(along(f.along_product<i, 0>(f.t), f.reach_along_product<i, 0>()),
                           along(f.along_product<i, 1>(f.t), f.reach_along_product<i, 1>())),
                   along(f.along_product<i, 2>(f.t), f.reach_along_product<i, 2>()));
  };
  return hn::And(near, hn::And(hn::And(across.template operator()<0>(), across.template operator()<1>()),
                               across.template operator()<2>()));
}

// The pairs of boxes that overlap along A's axes.
HWY_INLINE std::uint64_t near_pairs(const WideTree::Node& a, const MovedBoxes& b) {
  std::uint64_t near = 0;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 center = load3(a.center, i), half = load3(a.half, i);
    const V3 lo = minus(center, half),
             hi{hn::Add(center.x, half.x), hn::Add(center.y, half.y), hn::Add(center.z, half.z)};
    const auto test_row = [&](std::size_t row) HWY_ATTR {
      const V3 from = set3(b.lo, row), to = set3(b.hi, row);
      const auto both = hn::And(
          hn::And(hn::And(hn::Le(lo.x, to.x), hn::Ge(hi.x, from.x)), hn::And(hn::Le(lo.y, to.y), hn::Ge(hi.y, from.y))),
          hn::And(hn::Le(lo.z, to.z), hn::Ge(hi.z, from.z)));
      near |= static_cast<std::uint64_t>(bits(both, i)) << (kWidth * row);
    };
    for (std::size_t row = 0; row < kWidth; row += 2) test_row(row), test_row(row + 1);
  }
  return near;
}

void TestNodes(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& m, LanePairs& pairs) {
  MovedBoxes moved;
  move_boxes(b, m, moved);
  pairs.count = 0;
  const V slack = set(m.slack_oriented);
  for (std::uint64_t near = near_pairs(a, moved); near != 0;) {
    const ChosenLanes chosen = take_lanes(near);
    const RowLookup<true> of_a(chosen);
    const RowLookup<false> of_b(chosen);
    const auto touching = overlap(chosen_boxes(a.oriented_center, a.oriented_half, a.axes, of_a),
                                  chosen_boxes(moved.center, b.oriented_half, moved.axes, of_b), slack);
    append(bits(touching, 0), chosen, pairs);
  }
}

// One box against the children of a node; bit i of the result is child i.
HWY_INLINE std::uint8_t test_box_node(const OrientedBox& box, const WideTree::Node& node, const Matrix& node_from_box,
                                      const std::array<float, 3>& box_in_node, float slack) {
  const OrientedBoxes b = {plus(times(node_from_box, set3(box.center)), box_in_node),
                           set3(box.half),
                           {times(node_from_box, set3(box.axes[0])), times(node_from_box, set3(box.axes[1])),
                            times(node_from_box, set3(box.axes[2]))}};
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const OrientedBoxes a = {load3(node.oriented_center, i),
                             load3(node.oriented_half, i),
                             {load3(node.axes[0], i), load3(node.axes[1], i), load3(node.axes[2], i)}};
    out |= bits(overlap(a, b, set(slack)), i);
  }
  return static_cast<std::uint8_t>(out);
}
std::uint8_t TestNodeBox(const WideTree::Node& a, const OrientedBox& b, const WideMotion& m) {
  return test_box_node(b, a, m.a_from_b, m.b_in_a, m.slack_oriented);
}
std::uint8_t TestBoxNode(const OrientedBox& a, const WideTree::Node& b, const WideMotion& m) {
  return test_box_node(a, b, m.b_from_a, m.a_in_b, m.slack_oriented);
}

// Soups so large that binary32 could overflow: boxes with the axes of either frame, each in its own numbers.
void TestLargeNodes(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& m, LanePairs& pairs) {
  Boxes b_in_a, a_in_b;
  to_a(b, m, b_in_a);
  to_b(a, m, a_in_b);
  pairs.count = 0;
  for (std::size_t row = 0; row < kWidth; ++row) {
    std::uint32_t lanes = 0;
    for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
      const auto in_a = overlap(load3(a.center, i), load3(a.half, i), set3(b_in_a.center, row), set3(b_in_a.half, row));
      const auto in_b = overlap(load3(a_in_b.center, i), load3(a_in_b.half, i), set3(b.center, row), set3(b.half, row));
      lanes |= bits(hn::And(in_a, in_b), i);
    }
    for (; lanes != 0; lanes &= lanes - 1) {
      pairs.at[pairs.count++] = static_cast<std::uint8_t>(kWidth * row + hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
    }
  }
}

// Tests one box against the children of a node, each in the frame of the other.
HWY_INLINE std::uint8_t one_against(const std::array<float, 3>& center, const std::array<float, 3>& half,
                                    const std::array<float, 3>& center_there, const std::array<float, 3>& half_there,
                                    const WideTree::Node& node, const Boxes& node_here) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const auto there = overlap(load3(node.center, i), load3(node.half, i), set3(center_there), set3(half_there));
    const auto here = overlap(load3(node_here.center, i), load3(node_here.half, i), set3(center), set3(half));
    out |= bits(hn::And(there, here), i);
  }
  return static_cast<std::uint8_t>(out);
}

std::uint8_t TestLargeNodeLeaf(const WideTree::Node& a, const WideTree::Leaf& b, const WideMotion& m) {
  Boxes a_in_b;
  to_b(a, m, a_in_b);
  std::array<float, 3> center, half;
  transform(b, m.a_from_b, m.a_from_b_sizes, m.b_in_a, m.slack_a, center, half);
  return one_against(b.center, b.half, center, half, a, a_in_b);
}

std::uint8_t TestLargeLeafNode(const WideTree::Leaf& a, const WideTree::Node& b, const WideMotion& m) {
  Boxes b_in_a;
  to_a(b, m, b_in_a);
  std::array<float, 3> center, half;
  transform(a, m.b_from_a, m.b_from_a_sizes, m.a_in_b, m.slack_b, center, half);
  return one_against(a.center, a.half, center, half, b, b_in_a);
}

// B's triangles in A's frame, one to a lane.
struct Moved {
  std::array<Rows, 3> corners;
  Rows lo, hi, normal;
  Row size;
};

HWY_INLINE void move(const WideTree::Leaf& b, const WideMotion& m, Moved& out) {
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Corners corners = moved(load_corners(b, i), m);
    store_corners(corners, out.corners, i);
    const TriangleBoxes box = boxes(corners);
    const V slack = set(m.slack_a);
    store3({hn::Sub(box.lo.x, slack), hn::Sub(box.lo.y, slack), hn::Sub(box.lo.z, slack)}, out.lo, i);
    store3({hn::Add(box.hi.x, slack), hn::Add(box.hi.y, slack), hn::Add(box.hi.z, slack)}, out.hi, i);
    const Planes plane = planes(corners);
    store3(plane.normal, out.normal, i), store(plane.size, out.size, i);
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
    const Corners corners = load_corners(a, i);
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
      const Corners other = set_corners(moved.corners, row);
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
HWY_EXPORT(TestNodeBox);
HWY_EXPORT(TestBoxNode);
HWY_EXPORT(TestLargeNodes);
HWY_EXPORT(TestLargeNodeLeaf);
HWY_EXPORT(TestLargeLeafNode);
HWY_EXPORT(TestLeaves);

void test_nodes(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion, LanePairs& pairs) {
  if (motion.in_range) {
    HWY_DYNAMIC_DISPATCH(TestNodes)(a, b, motion, pairs);
  } else {
    HWY_DYNAMIC_DISPATCH(TestLargeNodes)(a, b, motion, pairs);
  }
}
std::uint8_t test_node_leaf(const WideTree::Node& a, const OrientedBox& box_b, const WideTree::Leaf& b,
                            const WideMotion& motion) {
  return motion.in_range ? HWY_DYNAMIC_DISPATCH(TestNodeBox)(a, box_b, motion)
                         : HWY_DYNAMIC_DISPATCH(TestLargeNodeLeaf)(a, b, motion);
}
std::uint8_t test_leaf_node(const OrientedBox& box_a, const WideTree::Leaf& a, const WideTree::Node& b,
                            const WideMotion& motion) {
  return motion.in_range ? HWY_DYNAMIC_DISPATCH(TestBoxNode)(box_a, b, motion)
                         : HWY_DYNAMIC_DISPATCH(TestLargeLeafNode)(a, b, motion);
}
void test_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion, Masks& masks) {
  assert(a.count >= 1 && a.count <= WideTree::kWidth && b.count >= 1 && b.count <= WideTree::kWidth);
  HWY_DYNAMIC_DISPATCH(TestLeaves)(a, b, motion, masks);
}

}  // namespace peerd::collision
#endif
