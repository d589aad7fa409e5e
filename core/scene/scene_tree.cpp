#include "core/scene/scene_tree.hpp"

#include <cassert>

namespace peerd {

SceneTree::SceneTree() {
  static_assert(sizeof(SceneNode) == 32);
  nodes_.emplace_back().generation = 1;
}

std::uint32_t SceneTree::place(std::uint32_t parent, NodeHandle before) const {
  if (before == NodeHandle{}) return kNoSlot;
  const std::uint32_t i = slot(before);
  assert(nodes_[i].parent == parent);
  return i;
}

void SceneTree::link(std::uint32_t i, std::uint32_t parent, std::uint32_t before) {
  SceneNode& node = nodes_[i];
  const std::uint32_t first = nodes_[parent].first_child;
  node.parent = parent;
  node.next = before;
  if (first == kNoSlot) {
    node.previous = i;
    nodes_[parent].first_child = i;
    return;
  }
  const std::uint32_t behind = before == kNoSlot ? first : before;  // whose `previous` becomes i
  node.previous = nodes_[behind].previous;
  if (before == first) {
    nodes_[parent].first_child = i;
  } else {
    nodes_[node.previous].next = i;
  }
  nodes_[behind].previous = i;
}

void SceneTree::unlink(std::uint32_t i) {
  const SceneNode& node = nodes_[i];
  const std::uint32_t first = nodes_[node.parent].first_child;
  if (i == first) {
    nodes_[node.parent].first_child = node.next;
  } else {
    nodes_[node.previous].next = node.next;
  }
  const std::uint32_t behind = node.next == kNoSlot ? first : node.next;
  nodes_[behind].previous = node.previous;
}

std::uint32_t SceneTree::add(std::uint32_t parent, std::uint32_t before) {
  std::uint32_t i = 0;
  if (free_nodes_.empty()) {
    assert(nodes_.size() < kNoSlot);
    i = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
  } else {
    i = free_nodes_.back();
    free_nodes_.pop_back();
  }
  SceneNode& node = nodes_[i];
  ++node.generation;
  assert(nodes_[parent].depth < kMaxDepth);
  node.depth = nodes_[parent].depth + 1;
  node.pose = nodes_[parent].pose;
  link(i, parent, before);
  return i;
}

void SceneTree::free(std::uint32_t i) {
  SceneNode& node = nodes_[i];
  SceneNode empty;
  empty.generation = node.generation + 1;
  empty.in_dirty_list = node.in_dirty_list;
  empty.in_pending_list = node.in_pending_list;
  node = empty;
  if (node.generation == 0) {  // 2^31 nodes have been here; one more and an old handle would name a new node
    ++retired_slots_;
  } else {
    free_nodes_.push_back(i);
  }
}

void SceneTree::shift_depths(std::uint32_t top, std::int64_t by) {
  if (by == 0) return;
  for (std::uint32_t i = top; i != kNoSlot; i = after(i, top)) {
    const std::int64_t depth = nodes_[i].depth + by;
    assert(0 < depth && depth <= std::int64_t{kMaxDepth});
    nodes_[i].depth = static_cast<std::uint32_t>(depth) & kMaxDepth;
  }
}

}  // namespace peerd
