#include "collision/broad_phase/sweep_and_prune.hpp"

#include <gtest/gtest.h>

#include "tests/collision/broad_phase/overlap_finder_check.hpp"

namespace peerd::collision::sweep_and_prune_test {

// Few changes walk along the axes; many at once sort everything anew.
TEST(SweepAndPrune, FindsAllNewOverlapsAndNothingElse) {
  test::expect_finds_new_overlaps<SweepAndPrune>(91, 8);
  test::expect_finds_new_overlaps<SweepAndPrune>(92, 40);
}

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

// Ends at one place: lower ones come first, so that boxes that touch overlap, whichever comes from where.
TEST(SweepAndPrune, TouchingIsOverlapping) {
  for (const bool from_above : {false, true}) {
    std::vector<FatBox> boxes = {cube(0.0), cube(from_above ? 5.0 : -5.0)};
    SweepAndPrune sweep(boxes);
    std::vector<OverlapFinder::Found> found;
    sweep.insert(0);
    sweep.insert(1);
    sweep.update(std::vector<BroadIndex>{0, 1}, found);
    EXPECT_TRUE(found.empty());
    boxes[1] = cube(from_above ? 1.0 : -1.0);
    sweep.update(std::vector<BroadIndex>{1}, found);
    EXPECT_EQ(found.size(), 1u) << from_above;
  }
}

}  // namespace peerd::collision::sweep_and_prune_test
