#include "core/scene/scene_tree.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace peerd::scene_tree_test {

using testing::ElementsAre;

std::vector<std::uint32_t> slots_of(SceneNodeRange range) {
  std::vector<std::uint32_t> out;
  for (const NodeHandle node : range) out.push_back(node.index);
  return out;
}
std::vector<std::uint32_t> children(const SceneTree& tree, std::uint32_t i) {
  return slots_of({tree, tree[i].first_child, i, false});
}

TEST(SceneTree, HasARootAndNothingElseAtFirst) {
  const SceneTree tree;
  EXPECT_EQ(tree.size(), 0u);
  EXPECT_TRUE(tree.alive(tree.handle_of(SceneTree::kRoot)));
  EXPECT_FALSE(tree.alive(NodeHandle{}));
  EXPECT_EQ(tree.handle_of(kNoSlot), NodeHandle{});
}

TEST(SceneTree, KeepsSiblingsInOrder) {
  SceneTree tree;
  const std::uint32_t a = tree.add(0, kNoSlot), b = tree.add(0, kNoSlot), first = tree.add(0, a),
                      middle = tree.add(0, b);
  EXPECT_THAT(children(tree, 0), ElementsAre(first, a, middle, b));
  tree.unlink(a);
  EXPECT_THAT(children(tree, 0), ElementsAre(first, middle, b));
  tree.link(a, 0, kNoSlot);
  EXPECT_THAT(children(tree, 0), ElementsAre(first, middle, b, a));
  tree.unlink(first);
  EXPECT_THAT(children(tree, 0), ElementsAre(middle, b, a));
}

TEST(SceneTree, WalksASubtreeDepthFirst) {
  SceneTree tree;
  const std::uint32_t a = tree.add(0, kNoSlot), a1 = tree.add(a, kNoSlot), a11 = tree.add(a1, kNoSlot),
                      a2 = tree.add(a, kNoSlot), b = tree.add(0, kNoSlot);
  EXPECT_THAT(slots_of({tree, a, a, true}), ElementsAre(a, a1, a11, a2));
  EXPECT_THAT(slots_of({tree, 0, 0, true}), ElementsAre(0u, a, a1, a11, a2, b));
  EXPECT_EQ(tree.after_subtree(a1, a), a2);
  EXPECT_EQ(tree.after_subtree(a2, a), kNoSlot);
  EXPECT_EQ(tree[a11].depth, 3u);
}

TEST(SceneTree, UsesSlotsAgainUnderAnotherGeneration) {
  SceneTree tree;
  const std::uint32_t slot = tree.add(0, kNoSlot);
  const NodeHandle old = tree.handle_of(slot);
  tree.unlink(slot);
  tree.free(slot);
  EXPECT_FALSE(tree.alive(old));
  EXPECT_EQ(tree.size(), 0u);
  EXPECT_EQ(tree.add(0, kNoSlot), slot);
  EXPECT_FALSE(tree.alive(old));
  EXPECT_TRUE(tree.alive(tree.handle_of(slot)));
}

TEST(SceneTree, RetiresASlotWhoseGenerationsAreUsedUp) {
  SceneTree tree;
  const std::uint32_t slot = tree.add(0, kNoSlot);
  tree[slot].generation = 0xffffffffu;  // the last odd one
  tree.unlink(slot);
  tree.free(slot);
  EXPECT_EQ(tree.size(), 0u);
  EXPECT_NE(tree.add(0, kNoSlot), slot);
  EXPECT_EQ(tree.size(), 1u);
}

TEST(SceneTree, ShiftsTheDepthsOfASubtree) {
  SceneTree tree;
  const std::uint32_t a = tree.add(0, kNoSlot), below = tree.add(a, kNoSlot);
  tree.shift_depths(a, 5);
  EXPECT_EQ(tree[a].depth, 6u);
  EXPECT_EQ(tree[below].depth, 7u);
  EXPECT_EQ(tree[0].depth, 0u);
}

}  // namespace peerd::scene_tree_test
