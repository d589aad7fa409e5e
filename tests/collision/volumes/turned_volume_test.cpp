#include "collision/volumes/turned_volume.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "collision/volumes/level_volumes.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::turned_volume_test {

std::vector<Vec3> cube() {
  std::vector<Vec3> out;
  for (int i = 0; i < 8; ++i) out.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  return out;
}

TEST(TurnedVolume, OfACube) {
  EXPECT_NEAR(volume(kdop_around<18>(cube())), 1.0, 1e-12);
  EXPECT_NEAR(volume(kdop_around<6>(cube())), 1.0, 1e-12);
  // Turned by 45 degrees around an axis the box has sqrt(2)^2, and the 18-DOP is the cube again.
  const Mat3 turn = thesis_rotation(125, 1000);
  EXPECT_NEAR(volume(kdop_around<6>(cube(), turn)), 2.0, 1e-12);
  EXPECT_NEAR(volume(kdop_around<18>(cube(), turn)), 1.0, 1e-12);
}

TEST(TurnedVolume, RotationsAreFullTurnsOneAfterTheOther) {
  for (std::uint32_t turn = 0; turn < kTurnAxes.size(); ++turn) {
    EXPECT_NEAR((thesis_rotation(turn * 8, 8) - Mat3::Identity()).norm(), 0.0, 1e-12);
    const Vec3 axis = Vec3(kTurnAxes[turn][0], kTurnAxes[turn][1], kTurnAxes[turn][2]).normalized();
    const Mat3 half = thesis_rotation(turn * 8 + 4, 8);
    EXPECT_NEAR((half * axis - axis).norm(), 0.0, 1e-12);
    EXPECT_NEAR(half.trace(), -1.0, 1e-12) << "half a turn";
  }
}

// The root is all of it, and deeper levels of a torus, which its children fit better, have less.
TEST(LevelVolumes, BeginAtTheRootAndShrink) {
  const TriangleSoup soup = torus(24, 48, false);
  KdopTree<18> tree(soup, {SplitRule::kSplatter, 1});
  tree.build_all();
  const auto levels = level_volumes(tree);
  ASSERT_EQ(levels.size(), tree.height() + 1u);
  EXPECT_NEAR(levels.front(), volume(widened(tree.node(0).dop)), 1e-12);
  EXPECT_LT(levels[6], 0.7 * levels.front());
  EXPECT_LT(levels.back(), levels[6]);
}

}  // namespace peerd::collision::turned_volume_test
