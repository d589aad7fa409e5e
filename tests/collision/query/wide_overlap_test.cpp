#include "collision/query/wide_overlap.hpp"

#include <gtest/gtest.h>

#include "collision/exact/triangle_pair.hpp"
#include "tests/collision/query/wide_kernels.hpp"

namespace peerd::collision::wide_overlap_test {

using namespace test;
using Ref = WideTree::Ref;

bool any_touch(const WidePair& pair, const std::vector<std::uint32_t>& of_a, const std::vector<std::uint32_t>& of_b) {
  OrientationCounters counters;
  for (const std::uint32_t i : of_a) {
    for (const std::uint32_t j : of_b) {
      if (touch(pair.of_a(i), pair.of_b(j), counters)) return true;
    }
  }
  return false;
}

// The oriented box of a leaf.
OrientedBox box_of(const WideTree& tree, std::uint32_t leaf) {
  for (std::uint32_t n = 0; n < tree.nodes().size(); ++n) {
    for (std::size_t i = 0; i < WideTree::kWidth; ++i) {
      const Ref ref = tree.node(n).children[i];
      if (ref.kind() == Ref::kLeaf && ref.index() == leaf) return tree.box(WideTree::child_slot({Ref::kNode, n}, i));
    }
  }
  return tree.box(WideTree::kRoot);
}

// Triangles that a kernel rules out don't touch by the exact test; and it rules out most of those that don't.
TEST(WideOverlap, RulesOutNothingThatTouches) {
  Numbers numbers(321);
  std::size_t touching = 0, kept = 0, pairs = 0;
  for (int i = 0; i < 12; ++i) {
    const WidePair pair(random_soup(120, 0.2, 322), torus(8, 10, true),
                        RelativeMotion(random_pose(numbers, 0.6), random_pose(numbers, 0.6)));
    const WideMotion motion(pair.tree_a, pair.tree_b, pair.a_from_b);
    OrientationCounters counters;
    for (const WideTree::Leaf& a : pair.tree_a.leaves()) {
      for (const WideTree::Leaf& b : pair.tree_b.leaves()) {
        Masks masks;
        test_leaves(a, b, motion, masks);
        for (std::size_t row = 0; row < b.count; ++row) {
          ASSERT_EQ(masks[row] >> a.count, 0) << "a triangle that isn't there";
          for (std::size_t lane = 0; lane < a.count; ++lane) {
            const bool may = (masks[row] >> lane & 1) != 0;
            const bool does =
                touch(pair.of_a(pair.tree_a.face(a, lane)), pair.of_b(pair.tree_b.face(b, row)), counters);
            ASSERT_TRUE(may || !does);
            touching += does;
            kept += may;
            ++pairs;
          }
        }
      }
    }
  }
  EXPECT_GT(touching, 100u);
  EXPECT_LT(kept - touching, pairs / 100);
}

TEST(WideOverlap, NodesAndLeavesRuleOutNothingThatTouchesBelow) {
  Numbers numbers(323);
  int ruled_out = 0;
  for (int i = 0; i < 6; ++i) {
    const WidePair pair(random_soup(200, 0.15, 324), torus(10, 12, true),
                        RelativeMotion(random_pose(numbers, 1.0), random_pose(numbers, 1.0)));
    const WideMotion motion(pair.tree_a, pair.tree_b, pair.a_from_b);
    const WideTree::Node &a = pair.tree_a.node(0), &b = pair.tree_b.node(0);
    LanePairs pairs;
    test_nodes(a, b, motion, pairs);
    Masks masks{};
    for (std::size_t k = 0; k < pairs.count; ++k) {
      masks[LanePairs::of_b(pairs.at[k])] |= static_cast<std::uint8_t>(1u << LanePairs::of_a(pairs.at[k]));
    }
    const WideTree::Leaf &leaf_a = pair.tree_a.leaf(0), &leaf_b = pair.tree_b.leaf(0);
    const auto in_leaf_a = faces_below(pair.tree_a, Ref(Ref::kLeaf, 0)),
               in_leaf_b = faces_below(pair.tree_b, Ref(Ref::kLeaf, 0));
    const std::uint8_t node_leaf = test_node_leaf(a, box_of(pair.tree_b, 0), leaf_b, motion),
                       leaf_node = test_leaf_node(box_of(pair.tree_a, 0), leaf_a, b, motion);
    for (std::size_t row = 0; row < WideTree::kWidth; ++row) {
      const bool in_b = b.children[row].kind() != Ref::kNone;
      const auto below_b = in_b ? faces_below(pair.tree_b, b.children[row]) : std::vector<std::uint32_t>();
      ASSERT_TRUE((leaf_node >> row & 1) != 0 || !any_touch(pair, in_leaf_a, below_b));
      const bool in_a = a.children[row].kind() != Ref::kNone;
      const auto beside = in_a ? faces_below(pair.tree_a, a.children[row]) : std::vector<std::uint32_t>();
      ASSERT_TRUE((node_leaf >> row & 1) != 0 || !any_touch(pair, beside, in_leaf_b));
      for (std::size_t lane = 0; lane < WideTree::kWidth; ++lane) {
        const bool may = (masks[row] >> lane & 1) != 0;
        if (a.children[lane].kind() == Ref::kNone || !in_b) {
          EXPECT_FALSE(may) << "a child that isn't there";
          continue;
        }
        if (may) continue;
        ++ruled_out;
        ASSERT_FALSE(any_touch(pair, faces_below(pair.tree_a, a.children[lane]), below_b));
      }
    }
  }
  EXPECT_GT(ruled_out, 20);
}

}  // namespace peerd::collision::wide_overlap_test
