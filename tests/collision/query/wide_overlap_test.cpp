#include "collision/query/wide_overlap.hpp"

#include <gtest/gtest.h>

#include "collision/exact/triangle_pair.hpp"
#include "tests/collision/query/wide_kernels.hpp"

namespace peerd::collision::wide_overlap_test {

using namespace test;
using Ref = WideTree::Ref;

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

}  // namespace peerd::collision::wide_overlap_test
