#include "core/scene/scene_graph.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "core/prefetch.hpp"

namespace peerd {
namespace {

// The same bits, so that -0 is not taken for 0: it can show in a product.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

std::array<double, 3> stored(const Vec3& v) { return {v[0], v[1], v[2]}; }
std::array<double, 4> stored(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }
Vec3 loaded(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }
Quat loaded(const std::array<double, 4>& q) { return {q[3], q[0], q[1], q[2]}; }

template <class T>
std::size_t capacity_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

}  // namespace

SceneGraph::SceneGraph() {
  static_assert(sizeof(Node) == 32 && sizeof(Placed) == 160);
  nodes_.emplace_back().generation = 1;
  placed_.items.emplace_back();
}

std::uint32_t SceneGraph::slot(NodeHandle node) const {
  assert(alive(node));
  return node.index;
}

// ---- Structure

std::uint32_t SceneGraph::place(std::uint32_t parent, NodeHandle before) const {
  if (before == NodeHandle{}) return kNone;
  const std::uint32_t i = slot(before);
  assert(nodes_[i].parent == parent);
  return i;
}

void SceneGraph::link(std::uint32_t i, std::uint32_t parent, std::uint32_t before) {
  Node& node = nodes_[i];
  const std::uint32_t first = nodes_[parent].first_child;
  node.parent = parent;
  node.next = before;
  if (first == kNone) {
    node.previous = i;
    nodes_[parent].first_child = i;
    return;
  }
  const std::uint32_t behind = before == kNone ? first : before;  // whose `previous` becomes i
  node.previous = nodes_[behind].previous;
  if (before == first) {
    nodes_[parent].first_child = i;
  } else {
    nodes_[node.previous].next = i;
  }
  nodes_[behind].previous = i;
}

void SceneGraph::unlink(std::uint32_t i) {
  const Node& node = nodes_[i];
  const std::uint32_t first = nodes_[node.parent].first_child;
  if (i == first) {
    nodes_[node.parent].first_child = node.next;
  } else {
    nodes_[node.previous].next = node.next;
  }
  const std::uint32_t behind = node.next == kNone ? first : node.next;
  nodes_[behind].previous = node.previous;
}

std::uint32_t SceneGraph::after_subtree(std::uint32_t i, std::uint32_t top) const {
  while (i != top) {
    if (nodes_[i].next != kNone) return nodes_[i].next;
    i = nodes_[i].parent;
  }
  return kNone;
}

std::uint32_t SceneGraph::after(std::uint32_t i, std::uint32_t top) const {
  const std::uint32_t child = nodes_[i].first_child;
  return child != kNone ? child : after_subtree(i, top);
}

std::uint32_t SceneGraph::new_node(std::uint32_t parent, std::uint32_t before, const TransformFields* transform) {
  std::uint32_t i = 0;
  if (free_nodes_.empty()) {
    assert(nodes_.size() < kNone);
    i = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
  } else {
    i = free_nodes_.back();
    free_nodes_.pop_back();
  }
  Node& node = nodes_[i];
  ++node.generation;
  assert(nodes_[parent].depth < kMaxDepth);
  node.depth = nodes_[parent].depth + 1;
  node.pose = nodes_[parent].pose;
  if (transform != nullptr) {
    node.has_transform = 1;
    node.pose = placed_.take();
    Placed& placed = placed_.items[node.pose];
    placed.parent_pose = nodes_[parent].pose;
    write_fields(placed, *transform);
  }
  link(i, parent, before);
  return i;
}

void SceneGraph::free_node(std::uint32_t i) {
  Node& node = nodes_[i];
  if (node.has_transform) {
    drop_stretch(placed_.items[node.pose]);
    placed_.give_back(node.pose);
  }
  if (node.box != kNone) local_boxes_.give_back(node.box);
  Node empty;
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

NodeHandle SceneGraph::add_group(NodeHandle parent, NodeHandle before) {
  const NodeSpec spec;
  return add_subtree(parent, {&spec, 1}, before)[0];
}

NodeHandle SceneGraph::add_transform(NodeHandle parent, const TransformFields& fields, NodeHandle before) {
  const NodeSpec spec{-1, &fields};
  return add_subtree(parent, {&spec, 1}, before)[0];
}

std::vector<NodeHandle> SceneGraph::add_subtree(NodeHandle parent, std::span<const NodeSpec> nodes, NodeHandle before) {
  const std::uint32_t above = slot(parent);
  const std::uint32_t behind = place(above, before);
  if (nodes_.size() == 1) {  // later on the vectors' own doubling is what keeps many small adds linear
    nodes_.reserve(nodes.size() + 1);
    const auto transforms = std::ranges::count_if(nodes, [](const NodeSpec& s) { return s.transform != nullptr; });
    placed_.items.reserve(static_cast<std::size_t>(transforms) + 1);
  }
  std::vector<NodeHandle> out;
  out.reserve(nodes.size());
  for (const NodeSpec& spec : nodes) {
    const bool top = spec.parent < 0;
    assert(top || static_cast<std::size_t>(spec.parent) < out.size());
    const std::uint32_t i = top ? new_node(above, behind, spec.transform)
                                : new_node(out[static_cast<std::size_t>(spec.parent)].index, kNone, spec.transform);
    out.push_back(handle_of(i));
    if (!top) continue;
    mark_dirty(i);
    if (nodes_[above].box_tracked) mark_box_pending(i);
  }
  return out;
}

void SceneGraph::remove(NodeHandle node) {
  const std::uint32_t top = slot(node);
  assert(top != kRoot);
  if (nodes_[top].box_tracked) propagate_box_change(nodes_[top].parent, world_boxes_[nodes_[top].box], {});
  unlink(top);
  nodes_[top].next = kNone;
  // Freed from the last to the first, so that the same subtree added again lies depth first again.
  std::vector<std::uint32_t> removed;
  for (std::uint32_t i = top; i != kNone; i = after(i, top)) removed.push_back(i);
  for (auto i = removed.rbegin(); i != removed.rend(); ++i) free_node(*i);
}

bool SceneGraph::move(NodeHandle node, NodeHandle parent, NodeHandle before) {
  const std::uint32_t i = slot(node);
  const std::uint32_t above = slot(parent);
  assert(i != kRoot);
  std::uint32_t at_my_depth = above;
  while (nodes_[at_my_depth].depth > nodes_[i].depth) at_my_depth = nodes_[at_my_depth].parent;
  if (at_my_depth == i) return false;

  std::uint32_t behind = place(above, before);
  if (behind == i) behind = nodes_[i].next;
  if (nodes_[i].box_tracked) {  // leaves the boxes that it has been in; those that it comes to have to absorb it
    WorldBox& world = world_boxes_[nodes_[i].box];
    propagate_box_change(nodes_[i].parent, world, {});
    world = {};
  }
  if (nodes_[i].box_tracked || nodes_[above].box_tracked) mark_box_pending(i);
  unlink(i);
  link(i, above, behind);
  shift_depths(i, std::int64_t{nodes_[above].depth} + 1 - nodes_[i].depth);
  relink_poses(i);
  mark_dirty(i);
  return true;
}

void SceneGraph::shift_depths(std::uint32_t top, std::int64_t by) {
  if (by == 0) return;
  for (std::uint32_t i = top; i != kNone; i = after(i, top)) {
    const std::int64_t depth = nodes_[i].depth + by;
    assert(0 < depth && depth <= std::int64_t{kMaxDepth});
    nodes_[i].depth = static_cast<std::uint32_t>(depth) & kMaxDepth;
  }
}

// What hangs from the pose above `top`: itself, or the nodes below down to the first that have poses of their own.
void SceneGraph::relink_poses(std::uint32_t top) {
  const std::uint32_t pose = nodes_[nodes_[top].parent].pose;
  for (std::uint32_t i = top; i != kNone;) {
    if (nodes_[i].has_transform) {
      placed_.items[nodes_[i].pose].parent_pose = pose;
      i = after_subtree(i, top);
    } else {
      nodes_[i].pose = pose;
      i = after(i, top);
    }
  }
}

// ---- Poses

void SceneGraph::drop_stretch(Placed& placed) {
  if (placed.stretch != kNone) stretches_.give_back(std::exchange(placed.stretch, kNone));
}

void SceneGraph::write_fields(Placed& placed, const TransformFields& fields) {
  placed.translation = stored(fields.translation);
  placed.rotation = stored(fields.rotation);
  const TransformFields usual;
  const Stretch stretch{stored(fields.scale), stored(fields.center), stored(fields.scale_orientation)};
  if (same_bits(stretch, {stored(usual.scale), stored(usual.center), stored(usual.scale_orientation)})) {
    drop_stretch(placed);
    return;
  }
  if (placed.stretch == kNone) placed.stretch = stretches_.take();
  stretches_.items[placed.stretch] = stretch;
}

TransformFields SceneGraph::read_fields(const Placed& placed) const {
  TransformFields out;
  out.translation = loaded(placed.translation);
  out.rotation = loaded(placed.rotation);
  if (placed.stretch != kNone) {
    const Stretch& stretch = stretches_.items[placed.stretch];
    out.scale = loaded(stretch.scale);
    out.center = loaded(stretch.center);
    out.scale_orientation = loaded(stretch.scale_orientation);
  }
  return out;
}

SceneGraph::Placed& SceneGraph::set_placed(NodeHandle node) {
  const std::uint32_t i = slot(node);
  assert(nodes_[i].has_transform);
  ++counters_.transforms_set;
  mark_dirty(i);
  Placed& placed = placed_.items[nodes_[i].pose];
  prefetch(placed.world);  // update() is to write it
  return placed;
}

void SceneGraph::set_local(NodeHandle node, const TransformFields& fields) { write_fields(set_placed(node), fields); }

void SceneGraph::set_translation(NodeHandle node, const Vec3& translation_m) {
  set_placed(node).translation = stored(translation_m);
}

void SceneGraph::set_rotation(NodeHandle node, const Quat& rotation) { set_placed(node).rotation = stored(rotation); }

void SceneGraph::set_rigid(NodeHandle node, const Vec3& translation_m, const Quat& rotation) {
  Placed& placed = set_placed(node);
  placed.translation = stored(translation_m);
  placed.rotation = stored(rotation);
}

void SceneGraph::prefetch_box(const Node& node) const {
  if (!node.box_tracked) return;
  prefetch(local_boxes_.items[node.box]);
  prefetch(world_boxes_[node.box]);
}

// Asks early for what setting, update() and box() touch of a mover, its parent and its first child (its Shape, mostly),
// each time for what the memory asked for before has told. In steps of few enough movers that the nearest cache (32 KiB
// or more) still holds the first when the last has come.
void SceneGraph::set_rigid(std::span<const RigidMove> moves) {
  constexpr std::size_t kStep = 64;
  for (; !moves.empty(); moves = moves.subspan(std::min(kStep, moves.size()))) {
    const auto step = moves.first(std::min(kStep, moves.size()));
    for (const RigidMove& move : step) {
      assert(move.node.index < nodes_.size());
      __builtin_prefetch(&nodes_[move.node.index], 1);
    }
    for (const RigidMove& move : step) {
      const Node& node = at(move.node);
      prefetch(placed_.items[node.pose]);
      if (node.first_child != kNone) prefetch(nodes_[node.first_child]);
      if (node.box_tracked) prefetch(nodes_[node.parent]);
      prefetch_box(node);
    }
    for (const RigidMove& move : step) {
      set_rigid(move.node, move.translation_m, move.rotation);
      const Node& node = nodes_[move.node.index];
      prefetch(placed_.items[placed_.items[node.pose].parent_pose].world);
      if (node.first_child != kNone) prefetch_box(nodes_[node.first_child]);
      if (node.box_tracked) prefetch_box(nodes_[node.parent]);
    }
  }
}

TransformFields SceneGraph::local(NodeHandle node) const {
  assert(has_transform(node));
  return read_fields(placed_.items[at(node).pose]);
}

void SceneGraph::mark_dirty(std::uint32_t i) {
  Node& node = nodes_[i];
  node.dirty = 1;
  if (node.in_dirty_list) return;
  node.in_dirty_list = 1;
  dirty_.push_back(i);
}

std::span<const NodeHandle> SceneGraph::update() {
  changed_.clear();
  // From the top down, a subtree that holds another marked one takes it along, and nobody has to look for one above.
  const auto depth = [&](std::uint32_t i) { return nodes_[i].depth; };
  const auto shallower = [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(depth(a), a) < std::pair(depth(b), b);
  };
  if (!std::ranges::is_sorted(dirty_, {}, depth)) std::ranges::sort(dirty_, shallower);
  for (const std::uint32_t i : dirty_) {
    nodes_[i].in_dirty_list = 0;
    if (nodes_[i].dirty) update_below(i);
  }
  dirty_.clear();
  counters_.nodes_changed += changed_.size();
  return changed_;
}

void SceneGraph::update_below(std::uint32_t top) {
  for (std::uint32_t i = top; i != kNone; i = after(i, top)) {
    Node& node = nodes_[i];
    node.dirty = 0;
    if (node.has_transform) {
      Placed& placed = placed_.items[node.pose];
      placed.world = multiply(placed_.items[placed.parent_pose].world, parent_from_local(read_fields(placed)));
      ++counters_.poses_updated;
    }
    changed_.push_back({i, node.generation});
    if (node.box_tracked) {
      mark_box_pending(i);
      prefetch_box(node);
    }
  }
}

std::size_t SceneGraph::memory_bytes() const {
  const auto pool = [](const auto& p) { return capacity_bytes(p.items) + capacity_bytes(p.free); };
  return capacity_bytes(nodes_) + capacity_bytes(free_nodes_) + pool(placed_) + pool(stretches_) + pool(local_boxes_) +
         capacity_bytes(world_boxes_) + capacity_bytes(dirty_) + capacity_bytes(pending_boxes_) +
         capacity_bytes(changed_);
}

}  // namespace peerd
