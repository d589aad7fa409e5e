#include "collision/query/tree_query.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/collision/soups.hpp"

namespace peerd::collision::tree_query_test {

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
