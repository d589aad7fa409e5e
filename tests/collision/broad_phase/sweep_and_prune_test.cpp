#include "collision/broad_phase/sweep_and_prune.hpp"

#include <gtest/gtest.h>

namespace peerd::collision::sweep_and_prune_test {

FatBox cube(double x) { return fattened(ExactBox::of({Vec3(x, 0, 0), Vec3(x + 1, 1, 1)}), 0.0); }

TEST(SweepAndPrune, WorkFollowsTheWay) {
  std::vector<FatBox> boxes;
  for (int i = 0; i < 200; ++i) boxes.push_back(cube(2.0 * i));
  SweepAndPrune sweep(boxes);
  std::vector<BroadIndex> all;
  for (BroadIndex i = 0; i < boxes.size(); ++i) {
    sweep.insert(i);
    all.push_back(i);
  }
  std::vector<OverlapFinder::Found> found;
  sweep.update(all, found);
  EXPECT_TRUE(found.empty());
  const std::uint64_t before = sweep.box_tests();
  boxes[0] = cube(1.5);  // onto its neighbour
  sweep.update(std::vector<BroadIndex>{0}, found);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].changed, 0u);
  EXPECT_EQ(found[0].other, 1u);
  EXPECT_LE(sweep.box_tests() - before, 3u);
}

}  // namespace peerd::collision::sweep_and_prune_test
