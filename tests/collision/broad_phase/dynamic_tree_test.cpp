#include "collision/broad_phase/dynamic_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace peerd::collision::dynamic_tree_test {

std::vector<FatBox> row(BroadIndex count) {
  std::vector<FatBox> boxes;
  for (BroadIndex i = 0; i < count; ++i) {
    const double x = 2.0 * i;
    boxes.push_back(fattened(ExactBox::of({Vec3(x, 0, 0), Vec3(x + 1, 1, 1)}), 0.0));
  }
  return boxes;
}

// Inserting in order is the worst case of a tree without rotations: it would be as high as the row is long.
TEST(DynamicTree, StaysLowWhenBoxesComeInOrder) {
  const std::vector<FatBox> boxes = row(1024);
  DynamicTree tree(boxes);
  EXPECT_EQ(tree.height(), 0u);
  std::vector<OverlapFinder::Found> found;
  for (BroadIndex i = 0; i < boxes.size(); ++i) {
    tree.insert(i);
    tree.update(std::vector{i}, found);
  }
  EXPECT_TRUE(found.empty());
  EXPECT_GE(tree.height(), 10u);
  EXPECT_LE(tree.height(), 30u);
}

TEST(DynamicTree, IsEmptyAgainWhenAllAreGone) {
  const std::vector<FatBox> boxes = row(50);
  DynamicTree tree(boxes);
  std::vector<OverlapFinder::Found> found;
  for (int round = 0; round < 2; ++round) {
    std::vector<BroadIndex> all;
    for (BroadIndex i = 0; i < boxes.size(); ++i) {
      tree.insert(i);
      all.push_back(i);
    }
    tree.update(all, found);
    EXPECT_GT(tree.height(), 0u);
    for (const BroadIndex i : all) tree.erase(i);
    EXPECT_EQ(tree.height(), 0u);
  }
}

// The tests of boxes that a tree of many costs: what a rotation that makes the surface less is for.
TEST(DynamicTree, AsksFewBoxes) {
  std::mt19937_64 random(83);
  const auto place = [&] { return 100.0 * std::ldexp(static_cast<double>(random() >> 11), -53); };
  std::vector<FatBox> boxes;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 p(place(), place(), 0.1 * place());
    boxes.push_back(fattened(ExactBox::of({p, Vec3(p + Vec3(1, 1, 1))}), 0.0));
  }
  DynamicTree tree(boxes);
  std::vector<BroadIndex> all;
  for (BroadIndex i = 0; i < boxes.size(); ++i) {
    tree.insert(i);
    all.push_back(i);
  }
  std::vector<OverlapFinder::Found> found;
  tree.update(all, found);
  EXPECT_LT(tree.box_tests(), 132'000u) << "129,516 were enough";
}

}  // namespace peerd::collision::dynamic_tree_test
