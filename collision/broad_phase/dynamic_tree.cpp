#include "collision/broad_phase/dynamic_tree.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::collision {
namespace {

// Half a box's surface. Infinite boxes count as very large ones, so that differences of areas remain numbers.
float half_area(const FatBox& box) {
  constexpr float kFar = 1e17F;
  std::array<float, 3> d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = std::clamp(box.hi[i], -kFar, kFar) - std::clamp(box.lo[i], -kFar, kFar);
  return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

}  // namespace

void DynamicTree::insert(BroadIndex object) {
  if (leaf_of_.size() <= object) leaf_of_.resize(object + 1, kNone);
  assert(leaf_of_[object] == kNone);
}

void DynamicTree::erase(BroadIndex object) {
  assert(object < leaf_of_.size());
  const Ref leaf = leaf_of_[object];
  leaf_of_[object] = kNone;
  if (leaf == kNone) return;
  remove_leaf(leaf);
  free_.push_back(leaf);
}

void DynamicTree::update(std::span<const BroadIndex> changed, std::vector<Found>& found) {
  for (const BroadIndex object : changed) {
    assert(object < leaf_of_.size() && object < boxes_.size());
    Ref& leaf = leaf_of_[object];
    if (boxes_[object].is_none()) {
      if (leaf != kNone) erase(object);
      continue;
    }
    if (leaf == kNone) {
      leaf = allocate_node();
      nodes_[leaf] = {boxes_[object], {kNone, object}, kNone, 0};
    } else {
      remove_leaf(leaf);
      nodes_[leaf].box = boxes_[object];
    }
    insert_leaf(leaf);
  }
  for (const BroadIndex object : changed) {
    if (leaf_of_[object] != kNone) query(object, found);
  }
}

void DynamicTree::query(BroadIndex object, std::vector<Found>& found) {
  assert(root_ != kNone && nodes_[root_].parent == kNone);
  const FatBox box = boxes_[object];
  stack_.assign(1, root_);
  while (!stack_.empty()) {
    const Node& node = nodes_[stack_.back()];
    stack_.pop_back();
    if (node.is_leaf()) {
      if (node.children[1] != object) found.push_back({object, node.children[1]});
      continue;
    }
    box_tests_ += 2;
    for (const Ref child : node.children) {
      if (overlap(nodes_[child].box, box)) stack_.push_back(child);
    }
  }
}

DynamicTree::Ref DynamicTree::allocate_node() {
  if (!free_.empty()) {
    const Ref node = free_.back();
    free_.pop_back();
    return node;
  }
  assert(nodes_.size() < kNone);
  nodes_.emplace_back();
  free_.reserve(nodes_.capacity());  // so that giving back never takes memory
  return static_cast<Ref>(nodes_.size() - 1);
}

DynamicTree::Ref DynamicTree::sibling_for(const FatBox& box) const {
  Ref at = root_;
  assert(at != kNone);
  while (!nodes_[at].is_leaf()) {
    const float merged_area = half_area(merged(nodes_[at].box, box));
    const float here = 2.0F * merged_area;                                     // a new parent of `at` and the box
    const float inherited = 2.0F * (merged_area - half_area(nodes_[at].box));  // what `at` grows by
    std::array<float, 2> below;
    for (std::size_t i = 0; i < 2; ++i) {
      const Node& child = nodes_[nodes_[at].children[i]];
      const float grown = half_area(merged(child.box, box));
      below[i] = (child.is_leaf() ? grown : grown - half_area(child.box)) + inherited;
    }
    if (here < below[0] && here < below[1]) break;
    at = nodes_[at].children[below[0] <= below[1] ? 0 : 1];
  }
  return at;
}

void DynamicTree::insert_leaf(Ref leaf) {
  assert(nodes_[leaf].is_leaf());
  if (root_ == kNone) {
    root_ = leaf;
    nodes_[leaf].parent = kNone;
    return;
  }
  const Ref sibling = sibling_for(nodes_[leaf].box);
  const Ref parent = allocate_node();
  const Ref above = nodes_[sibling].parent;
  nodes_[parent] = {{}, {sibling, leaf}, above, 1};
  replace_child(above, sibling, parent);
  nodes_[sibling].parent = parent;
  nodes_[leaf].parent = parent;
  refit_upwards(parent);
}

void DynamicTree::remove_leaf(Ref leaf) {
  assert(nodes_[leaf].is_leaf());
  const Ref parent = nodes_[leaf].parent;
  if (parent == kNone) {
    root_ = kNone;
    return;
  }
  assert(nodes_[parent].children[0] == leaf || nodes_[parent].children[1] == leaf);
  const Ref sibling = nodes_[parent].children[nodes_[parent].children[0] == leaf ? 1 : 0];
  const Ref above = nodes_[parent].parent;
  replace_child(above, parent, sibling);
  nodes_[sibling].parent = above;
  free_.push_back(parent);
  refit_upwards(above);
}

void DynamicTree::replace_child(Ref parent, Ref from, Ref to) {
  if (parent == kNone) {
    root_ = to;
    return;
  }
  auto& children = nodes_[parent].children;
  assert(children[0] == from || children[1] == from);
  children[children[0] == from ? 0 : 1] = to;
}

void DynamicTree::refit_upwards(Ref node) {
  for (; node != kNone; node = nodes_[node].parent) {
    const FatBox box = nodes_[node].box;
    const std::uint32_t height = nodes_[node].height;
    refit(node);
    if (nodes_[node].box == box && nodes_[node].height == height) return;
    rotate(node);
  }
}

void DynamicTree::refit(Ref at) {
  assert(!nodes_[at].is_leaf());
  Node& node = nodes_[at];
  const Node &a = nodes_[node.children[0]], &b = nodes_[node.children[1]];
  node.box = merged(a.box, b.box);
  node.height = 1 + std::max(a.height, b.height);
}

// Lets a child change places with a child of the other, if that makes the other's surface smaller; or leaves it and
// makes the tree lower, as among boxes that are all the same. Whatever the surface, where one side is much higher.
void DynamicTree::rotate(Ref at) {
  // Bounds the height by some multiple of the logarithm. Lower: worse trees, as with AVL's 1 (see README.md).
  constexpr std::uint32_t kMostLean = 8;
  const std::array<Ref, 2> children = nodes_[at].children;
  const std::uint32_t h0 = nodes_[children[0]].height, h1 = nodes_[children[1]].height;
  const bool leans = h0 > h1 + kMostLean || h1 > h0 + kMostLean;
  float best = 0.0F;
  std::uint32_t best_height = nodes_[at].height;
  std::size_t best_side = 2, best_k = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    const Node &stays_up = nodes_[children[1 - side]], &goes_down = nodes_[children[side]];
    if (stays_up.is_leaf() || (leans && stays_up.height < goes_down.height)) continue;
    const float area = half_area(stays_up.box);
    for (std::size_t k = 0; k < 2; ++k) {
      const Node &goes_up = nodes_[stays_up.children[k]], &stays_down = nodes_[stays_up.children[1 - k]];
      if (leans && goes_up.height < stays_down.height) continue;
      const float growth = half_area(merged(goes_down.box, stays_down.box)) - area;
      const std::uint32_t height = 1 + std::max(goes_up.height, 1 + std::max(goes_down.height, stays_down.height));
      if (growth < best || (growth == best && height < best_height) || (leans && best_side == 2)) {
        best = growth;
        best_height = height;
        best_side = side;
        best_k = k;
      }
    }
  }
  if (best_side == 2) return;
  const Ref down = children[best_side], middle = children[1 - best_side], up = nodes_[middle].children[best_k];
  nodes_[at].children[best_side] = up;
  nodes_[up].parent = at;
  nodes_[middle].children[best_k] = down;
  nodes_[down].parent = middle;
  refit(middle);
  refit(at);
  assert(nodes_[nodes_[at].children[0]].parent == at && nodes_[nodes_[at].children[1]].parent == at);
}

}  // namespace peerd::collision
