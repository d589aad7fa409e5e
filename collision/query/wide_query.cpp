#include "collision/query/wide_query.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "collision/exact/triangle_distance.hpp"
#include "collision/exact/triangle_pair.hpp"
#include "collision/query/wide_overlap.hpp"
#include "collision/query/wide_touch.hpp"

namespace peerd::collision {

using Ref = WideTree::Ref;
namespace {

template <class Then>
void for_bits_downwards(std::uint32_t bits, Then then) {
  while (bits != 0) {
    const auto i = static_cast<std::size_t>(std::bit_width(bits) - 1);
    bits ^= 1u << i;
    then(i);
  }
}

}  // namespace

// The pairs of children of two nodes that may touch: the first of them on top of the stack.
void WideQuery::open(const WideTree& a, const WideTree& b, Ref of_a, Ref of_b, const WideMotion& motion) {
  assert(of_a.kind() == Ref::kNode && of_b.kind() == Ref::kNode);
  LanePairs pairs;
  counters_.bv_tests += 64;
  test_nodes(a.node(of_a.index()), b.node(of_b.index()), motion, pairs);
  for (std::size_t i = pairs.count; i-- > 0;) {
    stack_.emplace_back(WideTree::child_slot(of_a, LanePairs::of_a(pairs.at[i])),
                        WideTree::child_slot(of_b, LanePairs::of_b(pairs.at[i])));
  }
}

// Descends from the pairs on the stack, depth first, children in their order, to pairs of leaves that may touch, until
// leaves() returns true.
template <class Leaves>
bool WideQuery::descend(WideTree& a, WideTree& b, const WideMotion& motion, Leaves leaves) {
  while (!stack_.empty()) {
    const auto [slot_a, slot_b] = stack_.back();
    stack_.pop_back();
    const Ref of_a = a.at(slot_a), of_b = b.at(slot_b);
    const bool node_a = of_a.kind() == Ref::kNode, node_b = of_b.kind() == Ref::kNode;
    if (node_a && node_b) {
      open(a, b, of_a, of_b, motion);
    } else if (node_a) {
      counters_.bv_tests += 8;
      for_bits_downwards(test_node_leaf(a.node(of_a.index()), b.box(slot_b), b.leaf(of_b.index()), motion),
                         [&](std::size_t i) { stack_.emplace_back(WideTree::child_slot(of_a, i), slot_b); });
    } else if (node_b) {
      counters_.bv_tests += 8;
      for_bits_downwards(test_leaf_node(a.box(slot_a), a.leaf(of_a.index()), b.node(of_b.index()), motion),
                         [&](std::size_t i) { stack_.emplace_back(slot_a, WideTree::child_slot(of_b, i)); });
    } else if (leaves(LeafPair{slot_a, slot_b}, a.leaf(of_a.index()), b.leaf(of_b.index()))) {
      return true;
    }
  }
  return false;
}

// Calls test() for pairs of triangles that may touch, B's in A's frame, until it returns true.
template <class Test>
bool WideQuery::test_triangles(const WideTree& a, const WideTree& b, const WideTree::Leaf& leaf_a,
                               const WideTree::Leaf& leaf_b, const WideMotion& motion, const RelativeMotion& a_from_b,
                               Test test) {
  Masks masks;
  test_leaves(leaf_a, leaf_b, motion, masks);
  for (std::size_t row = 0; row < leaf_b.count; ++row) {
    if (masks[row] == 0) continue;
    assert(masks[row] >> leaf_a.count == 0);  // no lane that isn't there
    const std::uint32_t face_b = b.face(leaf_b, row);
    const Triangle in_b = b.soup().triangle(face_b);
    const Triangle moved = {a_from_b(in_b[0]), a_from_b(in_b[1]), a_from_b(in_b[2])};
    for (std::uint32_t bits = masks[row]; bits != 0; bits &= bits - 1) {
      const std::uint32_t face_a = a.face(leaf_a, static_cast<std::size_t>(std::countr_zero(bits)));
      ++counters_.triangle_tests;
      if (test(FacePair{face_a, face_b}, a.soup().triangle(face_a), moved)) return true;
    }
  }
  return false;
}

// Calls found() for pairs of triangles that touch, until it returns true.
template <class Found>
bool WideQuery::test_touch(const WideTree& a, const WideTree& b, const WideTree::Leaf& leaf_a,
                           const WideTree::Leaf& leaf_b, const WideMotion& motion, const RelativeMotion& a_from_b,
                           Found found) {
  WideTouch touching;
  if (!motion.in_range || !touch_leaves(leaf_a, leaf_b, motion, touching)) {
    return test_triangles(a, b, leaf_a, leaf_b, motion, a_from_b,
                          [&](const FacePair& faces, const Triangle& of_a, const Triangle& of_b) {
                            return touch(of_a, of_b, counters_.orientation) && found(faces);
                          });
  }
  for (std::size_t i = 0; i < touching.pairs.count; ++i) {
    const std::uint8_t pair = touching.pairs.at[i];
    const FacePair faces{a.face(leaf_a, LanePairs::of_a(pair)), b.face(leaf_b, LanePairs::of_b(pair))};
    if ((touching.unsure >> i & 1u) != 0) {
      ++counters_.triangle_tests;
      const Triangle in_b = b.soup().triangle(faces.b);
      const Triangle moved = {a_from_b(in_b[0]), a_from_b(in_b[1]), a_from_b(in_b[2])};
      if (!touch(a.soup().triangle(faces.a), moved, counters_.orientation)) continue;
    } else {
      ++counters_.certain_pairs;
    }
    if (found(faces)) return true;
  }
  return false;
}

// Pairs that the kernels let through without touching cost time, but change no answer and no order: so the first pair
// found is the first that there is.
template <class Found>
bool WideQuery::search(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, Found found) {
  const WideMotion motion(a, b, a_from_b);
  stack_.assign(1, {WideTree::kRoot, WideTree::kRoot});
  return descend(a, b, motion, [&](LeafPair leaf_pair, const WideTree::Leaf& leaf_a, const WideTree::Leaf& leaf_b) {
    return test_touch(a, b, leaf_a, leaf_b, motion, a_from_b, [&](const FacePair& faces) {
      return found(PolygonPair{a.soup().faces[faces.a].polygon, b.soup().faces[faces.b].polygon}, leaf_pair);
    });
  });
}

bool WideQuery::find_pair(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, PolygonPair& pair,
                          LeafPair* leaf_pair) {
  return search(a, b, a_from_b, [&](const PolygonPair& found, LeafPair at) {
    pair = found;
    if (leaf_pair != nullptr) *leaf_pair = at;
    return true;
  });
}

bool WideQuery::touch_near_leaves(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, LeafPair& leaf_pair) {
  const WideMotion motion(a, b, a_from_b);
  const auto touching = [&](LeafPair at, const WideTree::Leaf& leaf_a, const WideTree::Leaf& leaf_b) {
    leaf_pair = at;
    return test_touch(a, b, leaf_a, leaf_b, motion, a_from_b, [](const FacePair&) { return true; });
  };
  assert(a.at(leaf_pair.a).kind() == Ref::kLeaf && b.at(leaf_pair.b).kind() == Ref::kLeaf);
  if (touching(leaf_pair, a.leaf(a.at(leaf_pair.a).index()), b.leaf(b.at(leaf_pair.b).index()))) return true;
  if (leaf_pair.a == WideTree::kRoot || leaf_pair.b == WideTree::kRoot) return false;
  stack_.clear();
  open(a, b, WideTree::parent(leaf_pair.a), WideTree::parent(leaf_pair.b), motion);
  return descend(a, b, motion, touching);
}

const std::vector<PolygonPair>& WideQuery::all_pairs(WideTree& a, WideTree& b, const RelativeMotion& a_from_b) {
  pairs_.clear();
  (void)search(a, b, a_from_b, [&](const PolygonPair& found, LeafPair) {
    pairs_.push_back(found);
    return false;
  });
  std::ranges::sort(pairs_, {}, [](const PolygonPair& pair) { return std::uint64_t{pair.a} << 32 | pair.b; });
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  return pairs_;
}

const std::vector<FacePair>& WideQuery::faces_within(WideTree& a, WideTree& b, const RelativeMotion& a_from_b,
                                                     double distance_m) {
  assert(distance_m >= 0.0);
  faces_.clear();
  const WideMotion motion(a, b, a_from_b, distance_m);
  stack_.assign(1, {WideTree::kRoot, WideTree::kRoot});
  (void)descend(a, b, motion, [&](LeafPair, const WideTree::Leaf& leaf_a, const WideTree::Leaf& leaf_b) {
    return test_triangles(a, b, leaf_a, leaf_b, motion, a_from_b,
                          [&](const FacePair& faces, const Triangle& of_a, const Triangle& of_b) {
                            if (triangle_distance(of_a, of_b).distance <= distance_m) faces_.push_back(faces);
                            return false;
                          });
  });
  std::ranges::sort(faces_);
  return faces_;
}

// Most that are as near touch, and a test of that takes a fraction of a distance's time.
bool WideQuery::any_within(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, double distance_m) {
  assert(distance_m >= 0.0);
  const auto any_touch = [](const PolygonPair&, LeafPair) { return true; };
  if (search(a, b, a_from_b, any_touch)) return true;
  const WideMotion motion(a, b, a_from_b, distance_m);
  stack_.assign(1, {WideTree::kRoot, WideTree::kRoot});
  return descend(a, b, motion, [&](LeafPair, const WideTree::Leaf& leaf_a, const WideTree::Leaf& leaf_b) {
    return test_triangles(a, b, leaf_a, leaf_b, motion, a_from_b,
                          [&](const FacePair&, const Triangle& of_a, const Triangle& of_b) {
                            return triangle_distance(of_a, of_b).distance <= distance_m;
                          });
  });
}

bool WideQuery::separated_by(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, double gap_m) {
  assert(!std::isnan(gap_m));
  const WideMotion motion(a, b, a_from_b, gap_m);
  stack_.assign(1, {WideTree::kRoot, WideTree::kRoot});
  Masks masks;
  return !descend(a, b, motion, [&](LeafPair, const WideTree::Leaf& leaf_a, const WideTree::Leaf& leaf_b) {
    test_leaves(leaf_a, leaf_b, motion, masks);
    return std::ranges::any_of(masks, [](std::uint8_t bits) { return bits != 0; });
  });
}

}  // namespace peerd::collision
