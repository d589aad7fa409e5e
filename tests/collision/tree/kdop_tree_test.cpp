#include "collision/tree/kdop_tree.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "tests/collision/soups.hpp"

namespace peerd::collision::kdop_tree_test {

using ::testing::ElementsAreArray;
using ::testing::IsEmpty;
using ::testing::Not;

template <class Ks>
class KdopTreeTest : public ::testing::Test {};

template <int K>
struct Faces {
  static constexpr int kFaces = K;
};
using AllKs = ::testing::Types<Faces<6>, Faces<14>, Faces<18>, Faces<26>>;
TYPED_TEST_SUITE(KdopTreeTest, AllKs);

template <int K>
bool contains(const Kdop<K>& dop, const Vec3& p) {
  for (std::size_t i = 0; i < dop.kSlabs; ++i) {
    const double at = along(dop.kDirections[i], p);
    if (at < dop.lo[i] || at > dop.hi[i]) return false;
  }
  return true;
}

std::vector<TriangleSoup> soups() { return {random_soup(300, 0.1, 1), torus(12, 16, true), random_soup(1, 0.5, 2)}; }

TYPED_TEST(KdopTreeTest, EveryRuleGivesATreeThatHoldsEachTriangleOnce) {
  constexpr int K = TypeParam::kFaces;
  for (const TriangleSoup& soup : soups()) {
    for (const SplitRuleName& rule : kSplitRuleNames) {
      for (const std::uint32_t threshold : {1u, 4u, 10u}) {
        KdopTree<K> tree(soup, {rule.rule, threshold});
        tree.build_all();
        std::multiset<std::uint32_t> held;
        for (const auto& node : tree.nodes()) {
          ASSERT_LT(node.begin, node.end) << rule.name;
          for (const std::uint32_t t : tree.triangles(node)) {
            for (const Vec3& corner : soup.triangle(t)) ASSERT_TRUE(contains<K>(node.dop, corner)) << rule.name;
          }
          if (node.left != tree.kLeaf) {
            EXPECT_EQ(tree.node(node.left).begin, node.begin);
            EXPECT_EQ(tree.node(node.left).end, tree.node(node.left + 1).begin);
            EXPECT_EQ(tree.node(node.left + 1).end, node.end);
            continue;
          }
          EXPECT_LE(node.end - node.begin, threshold) << rule.name;
          for (const std::uint32_t t : tree.triangles(node)) held.insert(t);
        }
        std::multiset<std::uint32_t> all;
        for (std::uint32_t t = 0; t < soup.faces.size(); ++t) all.insert(t);
        EXPECT_EQ(held, all) << rule.name;
      }
    }
  }
}

TYPED_TEST(KdopTreeTest, AllPairsAreThoseOfBruteForceWhateverTheRuleAndThreshold) {
  constexpr int K = TypeParam::kFaces;
  Numbers numbers(3);
  const TriangleSoup a = random_soup(200, 0.15, 4), b = torus(10, 14, true);
  for (int pose = 0; pose < 4; ++pose) {
    const RelativeMotion a_from_b(random_pose(numbers, 1.0), random_pose(numbers, 1.0));
    const std::vector<PolygonPair> expected = brute_force(a, b, a_from_b);
    for (const SplitRuleName& rule : kSplitRuleNames) {
      for (const std::uint32_t threshold : {1u, 7u}) {
        KdopTree<K> tree_a(a, {rule.rule, threshold}), tree_b(b, {rule.rule, 8 - threshold});
        QueryCounters counters;
        EXPECT_THAT(all_pairs(tree_a, tree_b, a_from_b, counters), ElementsAreArray(expected)) << rule.name;
        PolygonPair found{};
        EXPECT_EQ(find_pair(tree_a, tree_b, a_from_b, counters, found), !expected.empty());
        EXPECT_TRUE(expected.empty() || std::ranges::binary_search(expected, found));
      }
    }
  }
}

TYPED_TEST(KdopTreeTest, TouchesThatOnlyExactArithmeticSeesAreNotCulled) {
  constexpr int K = TypeParam::kFaces;
  // A triangle stands on its lowest corner on a face of the torus' box, 1 ulp above it, and 1 ulp within.
  const TriangleSoup below = torus(8, 8, false);
  TriangleSoup above;
  above.vertices = {{0, 0, 0}, {0.25, 0, 1}, {0, 0.25, 1}};
  above.faces = {{{0, 1, 2}, 0}};
  find_box(above);
  std::uint32_t top = 0;
  for (std::uint32_t v = 0; v < below.vertices.size(); ++v) {
    if (below.vertices[v][2] > below.vertices[top][2]) top = v;
  }
  for (const double offset : {-1.0, 0.0, 1.0}) {
    Pose stand;
    stand.position = below.vertices[top];
    stand.position[2] = offset == 0.0 ? stand.position[2] : std::nextafter(stand.position[2], offset * 2.0);
    const RelativeMotion motion(Pose{}, stand);
    const std::vector<PolygonPair> expected = brute_force(below, above, motion);
    EXPECT_EQ(expected.empty(), offset > 0.0);
    KdopTree<K> tree(below, {SplitRule::kSplatter, 1}), on_top(above, {SplitRule::kSplatter, 1});
    QueryCounters counters;
    EXPECT_THAT(all_pairs(tree, on_top, motion, counters), ElementsAreArray(expected));
  }
}

TYPED_TEST(KdopTreeTest, AQueryBuildsOnlyWhatItVisits) {
  constexpr int K = TypeParam::kFaces;
  const TriangleSoup soup = torus(32, 64, false);
  KdopTree<K> a(soup, {}), b(soup, {});
  QueryCounters counters;
  PolygonPair pair{};
  Pose far;
  far.position = {10.0, 0.0, 0.0};
  EXPECT_FALSE(find_pair(a, b, RelativeMotion(Pose{}, far), counters, pair));
  EXPECT_EQ(a.nodes().size(), 1u);
  EXPECT_EQ(counters.bv_tests, 1u);
  EXPECT_EQ(counters.triangle_tests, 0u);
  Pose near;
  near.position = {1.9, 0.0, 0.0};
  EXPECT_TRUE(find_pair(a, b, RelativeMotion(Pose{}, near), counters, pair));
  const std::size_t visited = a.nodes().size();
  a.build_all();
  EXPECT_LT(10 * visited, a.nodes().size());
}

TYPED_TEST(KdopTreeTest, RefitFollowsVerticesThatMove) {
  constexpr int K = TypeParam::kFaces;
  TriangleSoup soup = torus(12, 16, true);
  const TriangleSoup other = random_soup(100, 0.2, 9);
  KdopTree<K> moving(soup, {}), still(other, {});
  QueryCounters counters;
  (void)all_pairs(moving, still, RelativeMotion(Pose{}, Pose{}), counters);  // built in part
  TriangleSoup moved = soup;
  for (Vec3& v : moved.vertices) v = {1.5 * v[0], v[1] + 0.3 * v[0] * v[0], v[2] + 0.5};
  find_box(moved);
  moving.refit(moved);
  const RelativeMotion motion(Pose{}, Pose{});
  const std::vector<PolygonPair> expected = brute_force(moved, other, motion);
  ASSERT_THAT(expected, Not(IsEmpty()));
  EXPECT_THAT(all_pairs(moving, still, motion, counters), ElementsAreArray(expected));
}

// What a tree needs at least, and vectors that grow have at most twice that.
TYPED_TEST(KdopTreeTest, CountsItsMemory) {
  constexpr int K = TypeParam::kFaces;
  const TriangleSoup soup = random_soup(300, 0.1, 1);
  KdopTree<K> tree(soup, {});
  tree.build_all();
  constexpr std::size_t kFourths = (K / 2 + 3) / 4;  // of a vertex's projections, in fours of binary32
  const std::size_t least =
      tree.nodes().size_bytes() + tree.order().size_bytes() + 16 * kFourths * soup.vertices.size();
  EXPECT_GE(tree.memory_bytes(), least);
  EXPECT_LE(tree.memory_bytes(), 2 * least + 16 * soup.faces.size());
}

}  // namespace peerd::collision::kdop_tree_test
