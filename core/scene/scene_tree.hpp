#pragma once
#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "core/slot_pool.hpp"

namespace peerd {

// A NodeHandle names a node of one SceneGraph and of the copies made of it since. It names that node until the node is
// removed, and nothing from then on: a slot that is used again has another generation.
struct NodeHandle {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;  // odd for a node; 0: no node
  friend constexpr auto operator<=>(const NodeHandle&, const NodeHandle&) = default;
};

// A SceneNode is half a cache line: the data that walking, checking a handle and marking need.
struct alignas(32) SceneNode {
  std::uint32_t generation = 0;
  std::uint32_t parent = kNoSlot;
  std::uint32_t first_child = kNoSlot;
  std::uint32_t next = kNoSlot;      // sibling
  std::uint32_t previous = kNoSlot;  // sibling; the first one's is the last one, itself where it is alone
  std::uint32_t pose = 0;            // in PoseStore: its own, or else that of its parent
  std::uint32_t box = kNoSlot;       // in BoxHierarchy
  std::uint32_t depth : 20 = 0;      // below the root
  std::uint32_t has_transform : 1 = 0;
  std::uint32_t dirty : 1 = 0;          // update() has to make its pose, with all below
  std::uint32_t in_dirty_list : 1 = 0;  // mark of the slot, not of the node: survives remove()
  // A tracked node has a world box, which everything tracked above has absorbed; all below is tracked or pending.
  std::uint32_t box_tracked : 1 = 0;
  std::uint32_t box_pending : 1 = 0;  // its box has to be made anew from those below
  std::uint32_t in_pending_list : 1 = 0;
  std::uint32_t box_loose : 6 = 0;  // sides, -x -y -z +x +y +z, that may be farther out than anything below
};
class SceneNodeRange;

// A SceneTree holds the nodes of a SceneGraph and how they hang together: parents, children in order, generations of
// slots. The root is slot 0 and always there. The tree knows poses and boxes by their slots only.
class SceneTree {
 public:
  static constexpr std::uint32_t kRoot = 0;
  static constexpr std::uint32_t kMaxDepth = (1u << 20) - 1;  // largest SceneNode::depth

  SceneTree();

  [[nodiscard]] SceneNode& operator[](std::uint32_t i) { return nodes_[i]; }
  [[nodiscard]] const SceneNode& operator[](std::uint32_t i) const { return nodes_[i]; }

  [[nodiscard]] bool alive(NodeHandle node) const {
    return node.index < nodes_.size() && (node.generation & 1) != 0 && nodes_[node.index].generation == node.generation;
  }
  [[nodiscard]] std::size_t slot_count() const { return nodes_.size(); }
  [[nodiscard]] std::size_t size() const {
    return nodes_.size() - free_nodes_.size() - retired_slots_ - 1;
  }  // without the root
  // Returns the slot of a node that is alive.
  [[nodiscard]] std::uint32_t slot(NodeHandle node) const {
    assert(alive(node));
    return node.index;
  }
  [[nodiscard]] NodeHandle handle_of(std::uint32_t i) const {
    return i == kNoSlot ? NodeHandle{} : NodeHandle{i, nodes_[i].generation};
  }
  // Returns the slot of `before`, which is a child of `parent`; kNoSlot for no node.
  [[nodiscard]] std::uint32_t place(std::uint32_t parent, NodeHandle before) const;

  void reserve(std::size_t nodes) { nodes_.reserve(nodes); }
  // Adds a node below `parent`, in front of `before` or behind all, with the pose of its parent.
  std::uint32_t add(std::uint32_t parent, std::uint32_t before);
  // Frees the slot of a node that is unlinked, or whose parent is freed as well.
  void free(std::uint32_t i);
  void link(std::uint32_t i, std::uint32_t parent, std::uint32_t before);
  void unlink(std::uint32_t i);
  // Changes the depth of all nodes of the subtree.
  void shift_depths(std::uint32_t top, std::int64_t by);

  // Both return the node behind i, depth first, within the subtree of `top`; kNoSlot behind its end. after_subtree()
  // does not go below i.
  [[nodiscard]] std::uint32_t after_subtree(std::uint32_t i, std::uint32_t top) const {
    while (i != top) {
      if (nodes_[i].next != kNoSlot) return nodes_[i].next;
      i = nodes_[i].parent;
    }
    return kNoSlot;
  }
  [[nodiscard]] std::uint32_t after(std::uint32_t i, std::uint32_t top) const {
    const std::uint32_t child = nodes_[i].first_child;
    return child != kNoSlot ? child : after_subtree(i, top);
  }

  [[nodiscard]] std::size_t memory_bytes() const { return capacity_bytes(nodes_) + capacity_bytes(free_nodes_); }

 private:
  std::vector<SceneNode> nodes_;
  std::vector<std::uint32_t> free_nodes_;
  std::size_t retired_slots_ = 0;  // their generations are used up
};

// A SceneNodeRange is a forward range of handles; see SceneGraph::children() and subtree().
class SceneNodeRange {
 public:
  class Iterator {
   public:
    using value_type = NodeHandle;
    using difference_type = std::ptrdiff_t;
    Iterator() = default;
    [[nodiscard]] NodeHandle operator*() const { return tree_->handle_of(i_); }
    Iterator& operator++() {
      i_ = deep_ ? tree_->after(i_, top_) : (*tree_)[i_].next;
      return *this;
    }
    Iterator operator++(int) {
      Iterator old = *this;
      ++*this;
      return old;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) { return a.i_ == b.i_; }
    friend bool operator==(const Iterator& a, std::default_sentinel_t) { return a.at_end(); }

   private:
    friend class SceneNodeRange;
    [[nodiscard]] bool at_end() const { return i_ == kNoSlot; }
    const SceneTree* tree_ = nullptr;
    std::uint32_t i_ = kNoSlot, top_ = kNoSlot;
    bool deep_ = false;
  };

  // The range begins with `first` and goes on with the siblings behind it, or with `deep` with all nodes of the subtree
  // of `top`, depth first.
  SceneNodeRange(const SceneTree& tree, std::uint32_t first, std::uint32_t top, bool deep) {
    begin_.tree_ = &tree;
    begin_.i_ = first;
    begin_.top_ = top;
    begin_.deep_ = deep;
  }
  [[nodiscard]] Iterator begin() const { return begin_; }
  [[nodiscard]] std::default_sentinel_t end() const { return {}; }

 private:
  Iterator begin_;
};

}  // namespace peerd
