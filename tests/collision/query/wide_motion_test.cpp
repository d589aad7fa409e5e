#include "collision/query/wide_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/collision/query/wide_kernels.hpp"

namespace peerd::collision::wide_motion_test {

using namespace test;

// A corner of B's tree, taken to A's tree by binary32 arithmetic, is off by less than the slack; and back as well.
TEST(WideMotion, SlackIsMoreThanTheRoundingOfAPlace) {
  Numbers numbers(311);
  for (int i = 0; i < 60; ++i) {
    const double far = i % 3 == 0 ? 1e6 : i % 3 == 1 ? 10.0 : 0.5;
    const WidePair pair(random_soup(64, 0.3, 312), torus(8, 8, true),
                        RelativeMotion(random_pose(numbers, far), random_pose(numbers, 0.5)));
    const WideMotion motion(pair.tree_a, pair.tree_b, pair.a_from_b);
    for (const WideTree::Leaf& leaf : pair.tree_b.leaves()) {
      for (std::size_t t = 0; t < leaf.count; ++t) {
        const Triangle truth = pair.of_b(pair.tree_b.face(leaf, t));
        for (std::size_t c = 0; c < 3; ++c) {
          for (std::size_t k = 0; k < 3; ++k) {
            const auto& row = motion.a_from_b[k];
            const auto corner = [&](std::size_t axis) { return leaf.corners[c][axis][t] + leaf.center[axis]; };
            const float moved = row[0] * corner(0) + row[1] * corner(1) + row[2] * corner(2) + motion.b_in_a[k];
            const auto axis = static_cast<Eigen::Index>(k);
            const double exact = (truth[c][axis] - pair.tree_a.origin()[axis]) * pair.tree_a.scale();
            ASSERT_LE(std::abs(static_cast<double>(moved) - exact), static_cast<double>(motion.slack_a)) << i;
          }
        }
      }
    }
  }
}

TEST(WideMotion, MatricesAreEachOthersTransposes) {
  Numbers numbers(313);
  const WidePair pair(random_soup(20, 0.3, 314), random_soup(20, 0.3, 315),
                      RelativeMotion(random_pose(numbers, 1.0), random_pose(numbers, 1.0)));
  const WideMotion motion(pair.tree_a, pair.tree_b, pair.a_from_b);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_EQ(motion.a_from_b[i][j], motion.b_from_a[j][i]);
      EXPECT_EQ(motion.a_from_b_sizes[i][j], std::abs(motion.a_from_b[i][j]));
      EXPECT_EQ(motion.b_from_a_sizes[i][j], std::abs(motion.b_from_a[i][j]));
    }
  }
  EXPECT_EQ(motion.scale_a_from_b, 1.0F);
}

TEST(WideMotion, AMarginWidensTheSlack) {
  const WidePair pair(random_soup(20, 0.3, 316), random_soup(20, 0.3, 317), RelativeMotion(Pose{}, Pose{}));
  const WideMotion without(pair.tree_a, pair.tree_b, pair.a_from_b), with(pair.tree_a, pair.tree_b, pair.a_from_b, 0.5);
  EXPECT_GE(with.slack_a, without.slack_a + 0.5F);
  EXPECT_GE(with.slack_b, without.slack_b + 0.5F);
}

}  // namespace peerd::collision::wide_motion_test
