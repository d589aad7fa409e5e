#include "collision/query/wide_view.hpp"

#include <gtest/gtest.h>

#include "tests/collision/query/wide_kernels.hpp"

namespace peerd::collision::wide_view_test {

using namespace test;

TEST(WideRay, RulesOutNoTriangleThatItHits) {
  Numbers numbers(351);
  const TriangleSoup soup = random_soup(300, 0.2, 352);
  WideTree tree(soup);
  tree.build_all();
  std::size_t hits = 0, kept = 0, tested = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 origin = numbers.point(i % 2 == 0 ? 0.5 : 5.0);
    const Ray ray{origin, numbers.point(1.0) - origin, i % 5 == 0 ? 0.7 : 1e9};
    const WideRay wide(tree, ray);
    OrientationCounters counters;
    for (const WideTree::Leaf& leaf : tree.leaves()) {
      const std::uint8_t mask = test_ray_leaf(leaf, wide);
      for (std::size_t t = 0; t < leaf.count; ++t) {
        const auto found = first_parameter(ray, soup.triangle(tree.face(leaf, t)), counters);
        const bool hit = found && *found <= ray.longest, may = (mask >> t & 1) != 0;
        ASSERT_TRUE(!hit || (may && wide.reaches_tree())) << i;
        hits += hit;
        kept += may;
        ++tested;
      }
    }
  }
  EXPECT_GT(hits, 20u);
  EXPECT_LT(kept, tested / 20);
}

}  // namespace peerd::collision::wide_view_test
