#include "collision/tree/wide_tree.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "tests/collision/soups.hpp"

namespace peerd::collision::wide_tree_test {

using ::testing::ElementsAreArray;
using Ref = WideTree::Ref;

TEST(WideTree, HoldsEachTriangleOnceInLeavesOfEightAtMost) {
  for (const std::uint32_t triangles : {1u, 7u, 8u, 9u, 63u, 64u, 65u, 511u, 513u, 1000u, 4097u}) {
    const TriangleSoup soup = random_soup(triangles, 0.1, triangles);
    WideTree tree(soup);
    tree.build_all();
    std::multiset<std::uint32_t> held;
    std::size_t leaves = 0;
    std::vector<WideTree::Ref> stack = {tree.at(WideTree::kRoot)};
    while (!stack.empty()) {
      const WideTree::Ref ref = stack.back();
      stack.pop_back();
      if (ref.kind() == WideTree::Ref::kLeaf) {
        const WideTree::Leaf& leaf = tree.leaf(ref.index());
        ++leaves;
        EXPECT_GE(leaf.count, 1u);
        EXPECT_LE(leaf.count, WideTree::kWidth);
        for (const std::uint32_t face : tree.faces(leaf)) held.insert(face);
        continue;
      }
      ASSERT_EQ(ref.kind(), WideTree::Ref::kNode);
      for (std::size_t i = 0; i < WideTree::kWidth; ++i) {
        const WideTree::Ref child = tree.at(WideTree::child_slot(ref, i));
        if (child.kind() != WideTree::Ref::kNone) stack.push_back(child);
      }
    }
    EXPECT_EQ(held.size(), triangles);
    EXPECT_EQ(std::set<std::uint32_t>(held.begin(), held.end()).size(), triangles);
    EXPECT_EQ(leaves, tree.leaves().size());
    EXPECT_LE(leaves, triangles / 3 + 1);
  }
}

// Every box holds the corners below it, but for the rounding that the header states.
void expect_boxes_hold(WideTree& tree) {
  const double room = 0x1p-22 * tree.extent_m() * tree.scale();
  const auto inside = [&](const Vec3& p, double center, double half, int k) {
    return std::abs(p[k] - center) <= half + room;
  };
  for (const WideTree::Node& node : tree.nodes()) {
    for (std::size_t i = 0; i < WideTree::kWidth; ++i) {
      std::vector<Ref> stack;
      if (node.children[i].kind() != Ref::kNone) stack.push_back(node.children[i]);
      while (!stack.empty()) {
        const Ref ref = stack.back();
        stack.pop_back();
        if (ref.kind() == Ref::kNode) {
          for (const Ref child : tree.node(ref.index()).children) {
            if (child.kind() != Ref::kNone) stack.push_back(child);
          }
          continue;
        }
        const WideTree::Leaf& leaf = tree.leaf(ref.index());
        for (const std::uint32_t face : tree.faces(leaf)) {
          for (const Vec3& corner : tree.soup().triangle(face)) {
            const Vec3 p = (corner - tree.origin()) * tree.scale();
            for (int k = 0; k < 3; ++k) {
              const auto axis = static_cast<std::size_t>(k);
              EXPECT_TRUE(inside(p, node.center[axis][i], node.half[axis][i], k));
              EXPECT_TRUE(inside(p, leaf.center[axis], leaf.half[axis], k));
              Vec3 normal, center;
              for (std::size_t c = 0; c < 3; ++c) {
                normal[static_cast<int>(c)] = node.axes[axis][c][i];
                center[static_cast<int>(c)] = node.oriented_center[c][i];
              }
              EXPECT_LE(std::abs(normal.dot(p - center)), node.oriented_half[axis][i] + room);
            }
          }
        }
      }
    }
  }
}

TEST(WideTree, BoxesHoldWhatIsBelowThem) {
  for (const TriangleSoup& soup : {random_soup(200, 0.2, 51), torus(16, 20, true), half_space()}) {
    WideTree tree(soup);
    tree.build_all();
    ASSERT_NO_FATAL_FAILURE(expect_boxes_hold(tree));
  }
}

// Faces below a slot, by a descent that does not use the list's ranges.
std::vector<std::uint32_t> descended(WideTree& tree, WideTree::ChildSlot slot) {
  const Ref ref = tree.at(slot);
  std::vector<std::uint32_t> faces;
  if (ref.kind() == Ref::kLeaf) {
    for (std::size_t i = 0; i < tree.leaf(ref.index()).count; ++i)
      faces.push_back(tree.face(tree.leaf(ref.index()), i));
    return faces;
  }
  for (std::size_t i = 0; i < WideTree::kWidth && tree.node(ref.index()).children[i].kind() != Ref::kNone; ++i) {
    const std::vector<std::uint32_t> below = descended(tree, WideTree::child_slot(ref, i));
    faces.insert(faces.end(), below.begin(), below.end());
  }
  return faces;
}

TEST(WideTree, FacesBelowASlotStandInARowWhateverIsBuilt) {
  for (const std::uint32_t triangles : {5u, 9u, 100u, 3000u}) {
    const TriangleSoup soup = random_soup(triangles, 0.1, triangles);
    WideTree whole(soup);
    whole.build_all();
    EXPECT_THAT(whole.faces(), ElementsAreArray(descended(whole, WideTree::kRoot)));
    for (std::size_t i = 0; i < WideTree::kWidth; ++i) {
      WideTree lazy(soup);
      const Ref root = lazy.at(WideTree::kRoot);
      if (root.kind() == Ref::kNode) {
        if (lazy.peek(WideTree::child_slot(root, i)).kind() == Ref::kNone) continue;
        const WideTree::ChildSlot slot = WideTree::child_slot(root, i);
        const std::size_t before = lazy.nodes_built();
        const auto below = lazy.faces_below(slot);
        EXPECT_THAT(below, ElementsAreArray(descended(whole, WideTree::child_slot(whole.at(WideTree::kRoot), i))));
        EXPECT_LT(before, lazy.nodes_built());
        const std::size_t built = lazy.nodes_built();
        EXPECT_EQ(lazy.faces_below(slot).data(), below.data());
        EXPECT_EQ(lazy.nodes_built(), built);
        if (below.size() < triangles / 2) {
          EXPECT_LT(built, whole.nodes_built());
        }
      }
      EXPECT_THAT(lazy.faces_below(WideTree::kRoot), ElementsAreArray(whole.faces()));
      EXPECT_EQ(lazy.nodes_built(), whole.nodes_built());
    }
  }
}

TEST(WideTree, BuildsANodeWhenItIsVisitedAndKeepsIt) {
  const TriangleSoup soup = random_soup(1000, 0.1, 52);
  WideTree tree(soup);
  EXPECT_EQ(tree.nodes_built(), 0u);
  const Ref root = tree.at(WideTree::kRoot);
  ASSERT_EQ(root.kind(), Ref::kNode);
  EXPECT_EQ(tree.nodes_built(), 1u);
  const WideTree::Node* const before = &tree.node(root.index());
  const Ref child = tree.at(WideTree::child_slot(root, 0));
  EXPECT_EQ(tree.nodes_built(), 2u);
  EXPECT_EQ(tree.at(WideTree::child_slot(root, 0)).index(), child.index());
  EXPECT_EQ(tree.nodes_built(), 2u);
  tree.build_all();
  EXPECT_EQ(&tree.node(root.index()), before);
  EXPECT_EQ(WideTree::parent(WideTree::child_slot(root, 3)).index(), root.index());
}

// The soup is so large that binary32 would overflow: the scale is below 1, a power of two.
TEST(WideTree, HugeSoupsAreScaledByAPowerOfTwo) {
  const TriangleSoup soup = half_space();
  const WideTree tree(soup);
  EXPECT_LT(tree.scale(), 1.0);
  int exponent = 0;
  EXPECT_EQ(std::frexp(tree.scale(), &exponent), 0.5);
  const TriangleSoup small = torus(8, 8, true);
  EXPECT_EQ(WideTree(small).scale(), 1.0);
}

TEST(WideTree, TheBoxOfAllIsNoLargerFarFromTheOrigin) {
  const TriangleSoup soup = random_soup(100, 0.1, 7);
  for (const Vec3& away : {Vec3(0, 0, 0), Vec3(100, -50, 7)}) {
    TriangleSoup there = soup;
    for (Vec3& v : there.vertices) v += away;
    find_box(there);
    const WideTree tree(there);
    const OrientedBox whole = tree.box(WideTree::kRoot);
    for (int k = 0; k < 3; ++k) {
      const double half = 0.5 * (there.box.hi[k] - there.box.lo[k]);
      EXPECT_NEAR(static_cast<double>(whole.half[static_cast<std::size_t>(k)]) / tree.scale(), half, 1e-3 * half);
    }
  }
}

}  // namespace peerd::collision::wide_tree_test
