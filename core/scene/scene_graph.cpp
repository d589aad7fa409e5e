#include "core/scene/scene_graph.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/prefetch.hpp"

namespace peerd {

std::uint32_t SceneGraph::new_node(std::uint32_t parent, std::uint32_t before, const TransformFields* transform) {
  const std::uint32_t i = tree_.add(parent, before);
  if (transform != nullptr) {
    SceneNode& node = tree_[i];
    node.has_transform = 1;
    node.pose = poses_.add(tree_[parent].pose, *transform);
  }
  return i;
}

void SceneGraph::free_node(std::uint32_t i) {
  const SceneNode& node = tree_[i];
  if (node.has_transform) poses_.remove(node.pose);
  boxes_.remove(node);
  tree_.free(i);
}

NodeHandle SceneGraph::add_group(NodeHandle parent, NodeHandle before) {
  const NodeSpec spec;
  return add_subtree(parent, {&spec, 1}, before)[0];
}

NodeHandle SceneGraph::add_transform(NodeHandle parent, const TransformFields& fields, NodeHandle before) {
  const NodeSpec spec{-1, &fields};
  return add_subtree(parent, {&spec, 1}, before)[0];
}

std::vector<NodeHandle> SceneGraph::add_subtree(NodeHandle parent, std::span<const NodeSpec> nodes, NodeHandle before) {
  const std::uint32_t above = tree_.slot(parent);
  const std::uint32_t behind = tree_.place(above, before);
  if (tree_.slot_count() == 1) {  // later on the vectors' own doubling is what keeps many small adds linear
    tree_.reserve(nodes.size() + 1);
    const auto transforms = std::ranges::count_if(nodes, [](const NodeSpec& s) { return s.transform != nullptr; });
    poses_.reserve(static_cast<std::size_t>(transforms) + 1);
  }
  std::vector<NodeHandle> out;
  out.reserve(nodes.size());
  for (const NodeSpec& spec : nodes) {
    const bool top = spec.parent < 0;
    assert(top || static_cast<std::size_t>(spec.parent) < out.size());
    const std::uint32_t i = top ? new_node(above, behind, spec.transform)
                                : new_node(out[static_cast<std::size_t>(spec.parent)].index, kNoSlot, spec.transform);
    out.push_back(tree_.handle_of(i));
    if (!top) continue;
    mark_dirty(i);
    if (tree_[above].box_tracked) boxes_.mark_pending(tree_, i);
  }
  return out;
}

void SceneGraph::remove(NodeHandle node) {
  const std::uint32_t top = tree_.slot(node);
  assert(top != SceneTree::kRoot);
  boxes_.leave_parent(tree_, top);
  tree_.unlink(top);
  tree_[top].next = kNoSlot;
  // Freed from the last to the first, so that the same subtree added again lies depth first again.
  std::vector<std::uint32_t> removed;
  for (std::uint32_t i = top; i != kNoSlot; i = tree_.after(i, top)) removed.push_back(i);
  for (auto i = removed.rbegin(); i != removed.rend(); ++i) free_node(*i);
}

bool SceneGraph::move(NodeHandle node, NodeHandle parent, NodeHandle before) {
  const std::uint32_t i = tree_.slot(node);
  const std::uint32_t above = tree_.slot(parent);
  assert(i != SceneTree::kRoot);
  std::uint32_t at_my_depth = above;
  while (tree_[at_my_depth].depth > tree_[i].depth) at_my_depth = tree_[at_my_depth].parent;
  if (at_my_depth == i) return false;

  std::uint32_t behind = tree_.place(above, before);
  if (behind == i) behind = tree_[i].next;
  // The subtree leaves the boxes that it has been in. Those that it comes to have to absorb it.
  boxes_.leave_parent(tree_, i);
  if (tree_[i].box_tracked || tree_[above].box_tracked) boxes_.mark_pending(tree_, i);
  tree_.unlink(i);
  tree_.link(i, above, behind);
  tree_.shift_depths(i, std::int64_t{tree_[above].depth} + 1 - tree_[i].depth);
  relink_poses(i);
  mark_dirty(i);
  return true;
}

// Sets the parent pose of everything that hangs from the pose above `top`: `top` itself, or the nodes below it down to
// the first that have poses of their own.
void SceneGraph::relink_poses(std::uint32_t top) {
  const std::uint32_t pose = tree_[tree_[top].parent].pose;
  for (std::uint32_t i = top; i != kNoSlot;) {
    if (tree_[i].has_transform) {
      poses_[tree_[i].pose].parent_pose = pose;
      i = tree_.after_subtree(i, top);
    } else {
      tree_[i].pose = pose;
      i = tree_.after(i, top);
    }
  }
}

PlacedTransform& SceneGraph::set_placed(NodeHandle node) {
  const std::uint32_t i = tree_.slot(node);
  assert(tree_[i].has_transform);
  ++transforms_set_;
  mark_dirty(i);
  PlacedTransform& placed = poses_[tree_[i].pose];
  prefetch(placed.world);  // update() is to write it
  return placed;
}

void SceneGraph::set_local(NodeHandle node, const TransformFields& fields) {
  set_placed(node);
  poses_.write(at(node).pose, fields);
}

void SceneGraph::set_translation(NodeHandle node, const Vec3& translation_m) {
  PoseStore::write_translation(set_placed(node), translation_m);
}

void SceneGraph::set_rotation(NodeHandle node, const Quat& rotation) {
  PoseStore::write_rotation(set_placed(node), rotation);
}

void SceneGraph::set_rigid(NodeHandle node, const Vec3& translation_m, const Quat& rotation) {
  PlacedTransform& placed = set_placed(node);
  PoseStore::write_translation(placed, translation_m);
  PoseStore::write_rotation(placed, rotation);
}

// Asks early for what setting, update() and box() touch of a mover, its parent and its first child (its Shape, mostly),
// each time for what the memory asked for before has told. In steps of few enough movers that the nearest cache (32 KiB
// or more) still holds the first when the last has come.
void SceneGraph::set_rigid(std::span<const RigidMove> moves) {
  constexpr std::size_t kStep = 64;
  for (; !moves.empty(); moves = moves.subspan(std::min(kStep, moves.size()))) {
    const auto step = moves.first(std::min(kStep, moves.size()));
    for (const RigidMove& move : step) {
      assert(move.node.index < tree_.slot_count());
      __builtin_prefetch(&tree_[move.node.index], 1);
    }
    for (const RigidMove& move : step) {
      const SceneNode& node = at(move.node);
      prefetch(poses_[node.pose]);
      if (node.first_child != kNoSlot) prefetch(tree_[node.first_child]);
      if (node.box_tracked) prefetch(tree_[node.parent]);
      boxes_.prefetch_boxes(node);
    }
    for (const RigidMove& move : step) {
      set_rigid(move.node, move.translation_m, move.rotation);
      const SceneNode& node = tree_[move.node.index];
      prefetch(poses_[poses_[node.pose].parent_pose].world);
      if (node.first_child != kNoSlot) boxes_.prefetch_boxes(tree_[node.first_child]);
      if (node.box_tracked) boxes_.prefetch_boxes(tree_[node.parent]);
    }
  }
}

TransformFields SceneGraph::local(NodeHandle node) const {
  assert(has_transform(node));
  return poses_.read(at(node).pose);
}

void SceneGraph::mark_dirty(std::uint32_t i) {
  SceneNode& node = tree_[i];
  node.dirty = 1;
  if (node.in_dirty_list) return;
  node.in_dirty_list = 1;
  dirty_.push_back(i);
}

std::span<const NodeHandle> SceneGraph::update() {
  changed_.clear();
  // The subtrees are updated from the top down. A subtree that holds another marked one takes it along, so that no
  // search above a marked node is needed.
  const auto depth = [&](std::uint32_t i) { return tree_[i].depth; };
  const auto shallower = [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(depth(a), a) < std::pair(depth(b), b);
  };
  if (!std::ranges::is_sorted(dirty_, {}, depth)) std::ranges::sort(dirty_, shallower);
  for (const std::uint32_t i : dirty_) {
    tree_[i].in_dirty_list = 0;
    if (tree_[i].dirty) update_below(i);
  }
  dirty_.clear();
  nodes_changed_ += changed_.size();
  return changed_;
}

void SceneGraph::update_below(std::uint32_t top) {
  for (std::uint32_t i = top; i != kNoSlot; i = tree_.after(i, top)) {
    SceneNode& node = tree_[i];
    node.dirty = 0;
    if (node.has_transform) {
      poses_.update_world(node.pose);
      ++poses_updated_;
    }
    changed_.push_back({i, node.generation});
    if (node.box_tracked) {
      boxes_.mark_pending(tree_, i);
      boxes_.prefetch_boxes(node);
    }
  }
}

void SceneGraph::set_local_box(NodeHandle node, const LocalBox& box) { boxes_.set_local(tree_, tree_.slot(node), box); }

WorldBox SceneGraph::box(NodeHandle node) {
  const std::uint32_t i = tree_.slot(node);
  assert(up_to_date());
  return boxes_.world(tree_, poses_, i);
}

std::size_t SceneGraph::memory_bytes() const {
  return tree_.memory_bytes() + poses_.memory_bytes() + boxes_.memory_bytes() + capacity_bytes(dirty_) +
         capacity_bytes(changed_);
}

}  // namespace peerd
