#include "collision/engines/vertex_realignment.hpp"

#include <gtest/gtest.h>

#include "collision/engines/kdop_query.hpp"
#include "collision/tree/realignment.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::engines::vertex_realignment_test {

template <int K>
::testing::AssertionResult holds(const WideKdop<K>& outer, const WideKdop<K>& inner, double room_m) {
  for (std::size_t i = 0; i < outer.kSlabs; ++i) {
    if (outer.lo[i] > inner.lo[i] + room_m || outer.hi[i] < inner.hi[i] - room_m) {
      return ::testing::AssertionFailure() << "slab " << i << " of a " << K << "-DOP";
    }
  }
  return ::testing::AssertionSuccess();
}

template <int K>
WideKdop<K> around_moved(const KdopTree<K>& tree, std::uint32_t node, const RelativeMotion& motion) {
  auto dop = WideKdop<K>::empty();
  for (const std::uint32_t face : tree.triangles(tree.node(node))) {
    for (const Vec3& corner : tree.soup().triangle(face)) {
      for (std::size_t i = 0; i < dop.kSlabs; ++i) {
        const double at = along(dop.kDirections[i], motion(corner));
        dop.lo[i] = std::min(dop.lo[i], at);
        dop.hi[i] = std::max(dop.hi[i], at);
      }
    }
  }
  return dop;
}

template <int K>
void compare(const TriangleSoup& soup, double distance_m, std::uint64_t seed) {
  KdopTree<K> tree(soup, {SplitRule::kSplatter, 1});
  tree.build_all();
  NodeVertices<K> by_boundary(tree, RealignBy::kBoundary), by_hull(tree, RealignBy::kHull);
  Numbers numbers(seed);
  for (int n = 0; n < 20; ++n) {
    const RelativeMotion motion(random_pose(numbers, distance_m), random_pose(numbers, distance_m));
    const Realignment<K> by_slabs(motion, largest_coordinate(soup.box));
    const double room_m = 1e-8 * (1.0 + distance_m);
    for (std::uint32_t i = 0; i < tree.nodes().size(); ++i) {
      const WideKdop<K> tight = around_moved(tree, i, motion);
      const WideKdop<K> boundary = by_boundary.realigned(i, motion), hull = by_hull.realigned(i, motion);
      ASSERT_TRUE(holds(boundary, tight, 0.0));
      ASSERT_TRUE(holds(hull, tight, 0.0));
      ASSERT_TRUE(holds(by_slabs(tree.node(i).dop), boundary, room_m));
      ASSERT_TRUE(holds(boundary, hull, room_m));
      if (i == KdopTree<K>::kRoot) {  // as small as it can be
        ASSERT_TRUE(holds(tight, hull, room_m));
      } else {
        ASSERT_TRUE(holds(hull, boundary, 0.0));
      }
    }
  }
}

TEST(VertexRealignment, HoldsWhatIsInTheNodeAndTheHullIsTight) {
  for (const double distance_m : {1.0, 1e3}) {
    const TriangleSoup soup = random_soup(90, 0.8, 5);
    compare<6>(soup, distance_m, 6);
    compare<14>(soup, distance_m, 7);
    compare<18>(soup, distance_m, 8);
    compare<26>(soup, distance_m, 9);
  }
}

// Planes of flat nodes, and of boxes, meet in the same corners.
TEST(VertexRealignment, HoldsWhatIsFlatOrAPoint) {
  TriangleSoup soup;
  for (int i = 0; i < 9; ++i) soup.vertices.push_back(Vec3(i % 3, i / 3, 0.0));
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t at = i % 2 + i / 2 * 3;
    soup.faces.push_back({{at, at + 1, at + 4}, i});
  }
  soup.faces.push_back({{0, 0, 0}, 4});
  find_box(soup);
  compare<6>(soup, 1.0, 10);
  compare<18>(soup, 1.0, 11);
  compare<26>(soup, 1.0, 12);
}

struct Work {
  QueryCounters counters;
  std::size_t touching = 0;
};
Work work_of(RealignBy realign) {
  KdopQuery<18> query({SplitRule::kSplatter, 1}, false, realign);
  const TriangleSoup a = torus(12, 24, true), b = random_soup(60, 0.3, 13);
  Numbers numbers(14);
  Work work;
  for (int i = 0; i < 300; ++i) {
    const RelativeMotion motion(Pose{}, random_pose(numbers, 2.5));
    work.touching += query.all_pairs({1, &a}, {2, &b}, motion).size();
  }
  work.counters = query.counters();
  return work;
}

// The tighter the volumes, the fewer tests: what the thesis takes the way by the boundary, and the hull, for.
TEST(VertexRealignment, TighterVolumesAreTestedLess) {
  const Work slabs = work_of(RealignBy::kSlabs), boundary = work_of(RealignBy::kBoundary);
  const Work hull = work_of(RealignBy::kHull);
  EXPECT_GT(slabs.touching, 0u);
  EXPECT_EQ(slabs.touching, boundary.touching);
  EXPECT_EQ(slabs.touching, hull.touching);
  EXPECT_GT(slabs.counters.bv_tests, boundary.counters.bv_tests);
  EXPECT_GT(boundary.counters.bv_tests, hull.counters.bv_tests);
  EXPECT_GE(slabs.counters.triangle_tests, boundary.counters.triangle_tests);
}

}  // namespace peerd::collision::engines::vertex_realignment_test
