#include "core/scene/box_hierarchy.hpp"

#include <gtest/gtest.h>

#include <random>

namespace peerd::box_hierarchy_test {

// A World is a tree whose nodes all have poses, and the union of its boxes as a slow walk finds it.
struct World {
  std::uint32_t add(std::uint32_t parent) {
    const std::uint32_t i = tree.add(parent, kNoSlot);
    tree[i].has_transform = 1;
    tree[i].pose = poses.add(tree[parent].pose, {});
    poses.update_world(tree[i].pose);
    if (tree[parent].box_tracked) boxes.mark_pending(tree, i);
    return i;
  }
  void set_box(std::uint32_t i, float lo, float hi) {
    boxes.set_local(tree, i, {Eigen::Vector3f::Constant(lo), Eigen::Vector3f::Constant(hi)});
    if (local.size() <= i) local.resize(i + 1);
    local[i] = {Eigen::Vector3f::Constant(lo), Eigen::Vector3f::Constant(hi)};
  }
  void move(std::uint32_t i, const Vec3& to) {
    PoseStore::write_translation(poses[tree[i].pose], to);
    for (std::uint32_t k = i; k != kNoSlot; k = tree.after(k, i)) {
      poses.update_world(tree[k].pose);
      if (tree[k].box_tracked) boxes.mark_pending(tree, k);
    }
  }
  WorldBox slow(std::uint32_t top) const {
    WorldBox out;
    for (std::uint32_t k = top; k != kNoSlot; k = tree.after(k, top)) {
      if (k < local.size()) out.merge(transformed(poses.world(tree[k].pose), local[k]));
    }
    return out;
  }
  WorldBox fast(std::uint32_t i) { return boxes.world(tree, poses, i); }

  SceneTree tree;
  PoseStore poses;
  BoxHierarchy boxes;
  std::vector<LocalBox> local;
};

TEST(BoxHierarchy, IsTheUnionOfAllBelow) {
  World w;
  const std::uint32_t a = w.add(0), b = w.add(a), c = w.add(a);
  w.set_box(b, -1, 1);
  w.set_box(c, 0, 2);
  w.move(c, {10, 0, 0});
  EXPECT_EQ(w.fast(a), w.slow(a));
  EXPECT_TRUE(w.fast(a).contains(Vec3(12, 2, 2)));
  EXPECT_TRUE(w.fast(w.add(0)).is_empty());
}

TEST(BoxHierarchy, ComputesNothingUntilABoxIsAskedFor) {
  World w;
  const std::uint32_t a = w.add(0);
  w.set_box(a, 0, 1);
  w.move(a, {1, 1, 1});
  EXPECT_EQ(w.boxes.counters().updated, 0u);
  static_cast<void>(w.fast(a));
  EXPECT_EQ(w.boxes.counters().updated, 1u);
  static_cast<void>(w.fast(a));
  EXPECT_EQ(w.boxes.counters().updated, 1u);
}

TEST(BoxHierarchy, ForgetsASubtreeThatLeaves) {
  World w;
  const std::uint32_t a = w.add(0), b = w.add(a), c = w.add(a);
  w.set_box(b, -1, 1);
  w.set_box(c, 50, 60);
  static_cast<void>(w.fast(a));
  w.boxes.leave_parent(w.tree, c);
  w.tree.unlink(c);
  w.boxes.remove(w.tree[c]);
  w.tree.free(c);
  EXPECT_EQ(w.fast(a), w.slow(a));
  EXPECT_FALSE(w.fast(a).contains(Vec3::Constant(55)));
}

TEST(BoxHierarchy, StaysTheUnionThroughRandomMoves) {
  std::mt19937 random(5);
  World w;
  std::vector<std::uint32_t> nodes = {0};
  for (int i = 0; i < 60; ++i) nodes.push_back(w.add(nodes[random() % nodes.size()]));
  nodes.erase(nodes.begin());
  for (int round = 0; round < 2000; ++round) {
    const std::uint32_t i = nodes[random() % nodes.size()];
    const auto number = [&] { return static_cast<float>(static_cast<int>(random() % 9) - 4); };
    if (random() % 4 == 0) {
      const float lo = number();
      w.set_box(i, lo, lo + 1);
    } else {
      w.move(i, Vec3(number(), number(), number()));
    }
    const std::uint32_t asked = nodes[random() % nodes.size()];
    ASSERT_EQ(w.fast(asked), w.slow(asked)) << "round " << round;
  }
  EXPECT_EQ(w.fast(0), w.slow(0));
}

}  // namespace peerd::box_hierarchy_test
