#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "collision/broad_phase/overlap_finder.hpp"

namespace peerd::collision {

// A binary tree of the members' fat boxes; a member whose box is new is taken out and put in again, where it makes the
// tree's surface grow least (Goldsmith and Salmon, IEEE CG&A 7(5), 1987), and on the way up a child and a grandchild
// change places where that makes it less (Kopta et al., I3D 2012). The tree follows from the calls alone.
class DynamicTree final : public OverlapFinder {
 public:
  // `boxes` is indexed by object and outlives the tree.
  explicit DynamicTree(const std::vector<FatBox>& boxes) : boxes_(boxes) { stack_.reserve(256); }

  void insert(BroadIndex object) override;
  void erase(BroadIndex object) override;
  void update(std::span<const BroadIndex> changed, std::vector<Found>& found) override;
  [[nodiscard]] std::uint32_t height() const { return root_ == kNone ? 0 : nodes_[root_].height; }

 private:
  using Ref = std::uint32_t;
  static constexpr Ref kNone = ~0u;
  struct Node {
    FatBox box;
    std::array<Ref, 2> children;  // of a leaf: kNone, and its object
    Ref parent;
    std::uint32_t height;  // a leaf: 0
    [[nodiscard]] bool is_leaf() const { return height == 0; }
  };

  [[nodiscard]] Ref allocate_node();
  void insert_leaf(Ref leaf);
  void remove_leaf(Ref leaf);
  void replace_child(Ref parent, Ref from, Ref to);
  void refit_upwards(Ref node);
  void refit(Ref node);
  void rotate(Ref node);
  [[nodiscard]] Ref sibling_for(const FatBox& box) const;
  void query(BroadIndex object, std::vector<Found>& found);

  const std::vector<FatBox>& boxes_;
  std::vector<Node> nodes_;
  std::vector<Ref> free_;
  std::vector<Ref> leaf_of_;  // by object: its leaf, or kNone where its box is none() or it is no member
  std::vector<Ref> stack_;
  Ref root_ = kNone;
};

}  // namespace peerd::collision
