#include "collision/query/wide_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/exact/triangle_distance.hpp"
#include "tests/collision/query/wide_kernels.hpp"

namespace peerd::collision::wide_distance_test {

using namespace test;

// Bounds of triangles are bounds, `below` says which are below `most`, and `skipped` is the least of the others.
TEST(WideDistance, BoundsOfTrianglesAreNeverAboveTheirDistance) {
  Numbers numbers(331);
  std::size_t below = 0, above = 0;
  for (int i = 0; i < 10; ++i) {
    const WidePair pair(random_soup(64, 0.2, 332), torus(6, 8, true),
                        RelativeMotion(random_pose(numbers, 1.5), random_pose(numbers, 0.5)));
    const WideMotion motion(pair.tree_a, pair.tree_b, pair.a_from_b);
    const Vec3 guess = numbers.point(1.0);
    const std::array<float, 3> direction = {static_cast<float>(guess[0]), static_cast<float>(guess[1]),
                                            static_cast<float>(guess[2])};
    for (const WideTree::Leaf& a : pair.tree_a.leaves()) {
      for (const WideTree::Leaf& b : pair.tree_b.leaves()) {
        constexpr float kMost = 1.0F;
        Distances distances;
        DistanceRows estimates;
        distances_of_leaves(a, b, motion, direction, kMost, distances, estimates);
        for (std::size_t row = 0; row < b.count; ++row) {
          for (std::size_t lane = 0; lane < a.count; ++lane) {
            const double upper = triangle_distance(pair.of_a(a.faces[lane]), pair.of_b(b.faces[row])).upper;
            const bool is_below = (distances.below[row] >> lane & 1) != 0;
            ASSERT_LE(static_cast<double>(distances.lower[row][lane]), upper);
            if (is_below) {
              EXPECT_NEAR(estimates[row][lane], upper, 1e-3 + 1e-3 * upper);
            } else {
              ASSERT_LE(static_cast<double>(distances.skipped), upper);
            }
            ++(is_below ? below : above);
          }
        }
      }
    }
  }
  EXPECT_GT(below, 1000u);
  EXPECT_GT(above, 1000u);
}

TEST(WideDistance, BoundsOfNodesAreNeverAboveTheDistanceOfWhatIsBelow) {
  Numbers numbers(333);
  for (int i = 0; i < 5; ++i) {
    const WidePair pair(random_soup(70, 0.1, 334), torus(6, 6, true),
                        RelativeMotion(random_pose(numbers, 2.0), random_pose(numbers, 0.5)));
    const WideMotion motion(pair.tree_a, pair.tree_b, pair.a_from_b);
    const WideTree::Node &a = pair.tree_a.node(0), &b = pair.tree_b.node(0);
    const auto count = [](const WideTree::Node& node) {
      std::uint32_t n = 0;
      while (n < WideTree::kWidth && node.children[n].kind() != WideTree::Ref::kNone) ++n;
      return n;
    };
    const std::uint32_t count_a = count(a), count_b = count(b);
    Distances distances;
    distances_of_nodes(a, count_a, b, count_b, motion, 1e30F, distances);
    for (std::uint32_t row = 0; row < count_b; ++row) {
      for (std::uint32_t lane = 0; lane < count_a; ++lane) {
        for (const std::uint32_t of_a : faces_below(pair.tree_a, a.children[lane])) {
          for (const std::uint32_t of_b : faces_below(pair.tree_b, b.children[row])) {
            ASSERT_LE(static_cast<double>(distances.lower[row][lane]),
                      triangle_distance(pair.of_a(of_a), pair.of_b(of_b), 0.1).upper);
          }
        }
      }
    }
    EXPECT_EQ(distances.skipped, std::numeric_limits<float>::infinity());
  }
}

}  // namespace peerd::collision::wide_distance_test
