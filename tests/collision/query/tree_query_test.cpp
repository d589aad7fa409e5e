#include "collision/query/tree_query.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/collision/soups.hpp"

namespace peerd::collision::tree_query_test {

using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

// The case that listing 3.4 of the thesis forgets: a leaf against a node with children, either way round.
TEST(TreeQuery, ALeafMeetsANodeWithChildren) {
  const TriangleSoup one = random_soup(1, 0.9, 301), many = random_soup(400, 0.2, 302);
  Numbers numbers(303);
  std::size_t found = 0;
  for (int i = 0; i < 20; ++i) {
    const RelativeMotion motion(random_pose(numbers, 0.5), random_pose(numbers, 0.5));
    KdopTree<18> leaf(one, {}), node(many, {});
    QueryCounters counters;
    const auto expected = brute_force(one, many, motion), turned = brute_force(many, one, motion);
    EXPECT_THAT(all_pairs(leaf, node, motion, counters), ElementsAreArray(expected));
    EXPECT_THAT(all_pairs(node, leaf, motion, counters), ElementsAreArray(turned));
    found += expected.size() + turned.size();
  }
  EXPECT_GT(found, 100u);
}

TEST(TreeQuery, CountsItsWork) {
  const TriangleSoup a = torus(12, 16, true), b = random_soup(200, 0.1, 304);
  KdopTree<18> tree_a(a, {}), tree_b(b, {});
  QueryCounters counters;
  Pose far;
  far.position = {50, 0, 0};
  PolygonPair pair{7, 7};
  EXPECT_FALSE(find_pair(tree_a, tree_b, RelativeMotion(Pose{}, far), counters, pair));
  EXPECT_EQ(pair, (PolygonPair{7, 7}));
  EXPECT_EQ(counters.bv_tests, 1u);
  EXPECT_EQ(counters.bv_updates, 1u);
  EXPECT_EQ(counters.triangle_tests, 0u);
  const RelativeMotion here(Pose{}, Pose{});
  QueryCounters one, all;
  ASSERT_TRUE(find_pair(tree_a, tree_b, here, one, pair));
  const auto pairs = all_pairs(tree_a, tree_b, here, all);
  EXPECT_TRUE(std::ranges::is_sorted(pairs));
  EXPECT_EQ(std::ranges::adjacent_find(pairs), pairs.end());
  EXPECT_LT(one.bv_tests, all.bv_tests);
  EXPECT_GE(all.triangle_tests, pairs.size());
}

}  // namespace peerd::collision::tree_query_test
