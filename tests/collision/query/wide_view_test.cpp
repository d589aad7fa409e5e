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

TEST(WideRay, EntersNodesNoLaterThanItHitsWhatIsBelow) {
  Numbers numbers(353);
  const TriangleSoup soup = random_soup(200, 0.2, 354);
  WideTree tree(soup);
  tree.build_all();
  const WideTree::Node& root = tree.node(0);
  for (int i = 0; i < 60; ++i) {
    const Vec3 origin = numbers.point(3.0);
    const Ray ray{origin, numbers.point(0.8) - origin};
    WideRay wide(tree, ray);
    Entries entries;
    const std::uint8_t mask = test_ray_node(root, wide, entries);
    OrientationCounters counters;
    for (std::size_t child = 0; child < WideTree::kWidth; ++child) {
      if (root.children[child].kind() == WideTree::Ref::kNone) continue;
      for (const std::uint32_t face : faces_below(tree, root.children[child])) {
        const auto t = first_parameter(ray, soup.triangle(face), counters);
        if (!t) continue;
        ASSERT_NE(mask >> child & 1, 0);
        WideRay shorter = wide;  // a ray that ends where the box is entered still reaches the box
        shorter.shorten(*t);
        Entries again;
        ASSERT_NE(test_ray_node(root, shorter, again) >> child & 1, 0);
        ASSERT_LE(entries[child], shorter.last);
      }
    }
  }
}

TEST(WidePlanes, LeaveOutNothingThatReachesIntoAllHalfSpaces) {
  Numbers numbers(355);
  const TriangleSoup soup = random_soup(200, 0.2, 356);
  WideTree tree(soup);
  tree.build_all();
  std::size_t out = 0, wholly = 0;
  for (int i = 0; i < 40; ++i) {
    WidePlanes planes;
    planes.count = 2;
    std::array<Vec3, 2> normals;
    std::array<double, 2> offsets{};
    for (std::size_t n = 0; n < 2; ++n) {
      normals[n] = numbers.point(1.0).normalized();
      offsets[n] = numbers.between(-0.5, 0.5);
      auto& plane = planes.planes[n];
      for (std::size_t k = 0; k < 3; ++k)
        plane.normal[k] = static_cast<float>(normals[n][static_cast<Eigen::Index>(k)]);
      plane.offset = static_cast<float>(offsets[n] + normals[n].dot(tree.origin()));
      plane.slack = 1e-5F;
    }
    for (const WideTree::Leaf& leaf : tree.leaves()) {
      std::array<PlaneMask, WideTree::kWidth> crossed{};
      const std::uint8_t mask = test_planes_leaf(leaf, planes, 3, crossed);
      for (std::size_t t = 0; t < leaf.count; ++t) {
        for (std::size_t n = 0; n < 2; ++n) {
          int inside = 0;
          for (const Vec3& p : soup.triangle(tree.face(leaf, t))) inside += normals[n].dot(p) + offsets[n] > 0.0;
          const bool may = (mask >> t & 1) != 0;
          if (may && (crossed[t] >> n & 1) == 0) {
            ++wholly;
            EXPECT_EQ(inside, 3) << "not crossed, so wholly inside";
          }
          int outside = 0;
          for (const Vec3& p : soup.triangle(tree.face(leaf, t))) outside += normals[n].dot(p) + offsets[n] < -1e-4;
          if (outside == 3) {
            EXPECT_FALSE(may);
          }
        }
        bool corner_in_both = false;
        for (const Vec3& p : soup.triangle(tree.face(leaf, t))) {
          corner_in_both |= normals[0].dot(p) + offsets[0] >= 0.0 && normals[1].dot(p) + offsets[1] >= 0.0;
        }
        if (corner_in_both) {
          ASSERT_NE(mask >> t & 1, 0);
        }
        out += (mask >> t & 1) == 0;
      }
    }
  }
  EXPECT_GT(out, 1000u);
  EXPECT_GT(wholly, 1000u);
}

}  // namespace peerd::collision::wide_view_test
