#include <cassert>

#include "core/scene/scene_graph.hpp"

// A tracked node keeps the union of the boxes below it. A change of one box, from `before` to `after`, is absorbed
// going up: a union grows by `after`, which keeps it exact; where `before` made up a side of it that `after` does not
// reach, that side becomes loose, as only the other children can tell where it lies now. Going up ends where neither
// happens: what a box lies strictly inside of, or adds nothing to, looks the same from farther up. That needs a stored
// box to lie within those stored above it, loose or not.

namespace peerd {
namespace {

constexpr int kSides = 6;
// How far out a side of a box lies, along its own outward axis: -x -y -z +x +y +z.
double outward_extent(const WorldBox& box, int side) { return side < 3 ? -box.lo[side] : box.hi[side - 3]; }

}  // namespace

void SceneGraph::take_box_slot(std::uint32_t i) {
  if (nodes_[i].box == kNone) nodes_[i].box = local_boxes_.take();
}

void SceneGraph::mark_box_pending(std::uint32_t i) {
  Node& node = nodes_[i];
  node.box_pending = 1;
  if (node.in_pending_list) return;
  node.in_pending_list = 1;
  pending_boxes_.push_back(i);
}

void SceneGraph::set_local_box(NodeHandle node, const LocalBox& box) {
  const std::uint32_t i = slot(node);
  if (box.is_empty() && nodes_[i].box == kNone) return;
  take_box_slot(i);
  local_boxes_.items[nodes_[i].box] = box;
  if (nodes_[i].box_tracked) mark_box_pending(i);
}

WorldBox SceneGraph::box(NodeHandle node) {
  const std::uint32_t i = slot(node);
  assert(up_to_date());
  update_pending_boxes();
  make_box(i);
  return world_boxes_[nodes_[i].box];
}

void SceneGraph::update_pending_boxes() {
  for (const std::uint32_t i : pending_boxes_) {
    nodes_[i].in_pending_list = 0;
    if (!nodes_[i].box_pending) continue;
    const WorldBox before = nodes_[i].box_tracked ? world_boxes_[nodes_[i].box] : WorldBox{};
    make_box(i);
    propagate_box_change(nodes_[i].parent, before, world_boxes_[nodes_[i].box]);
  }
  pending_boxes_.clear();
}

WorldBox SceneGraph::own_box(std::uint32_t i) {
  const LocalBox& local = local_boxes_.items[nodes_[i].box];
  if (local.is_empty()) return {};
  ++counters_.boxes_updated;
  return transformed(placed_.items[nodes_[i].pose].world, local);
}

// The union below `top`, from its children's, going down only where those are not exact themselves. Does not tell
// above.
void SceneGraph::make_box(std::uint32_t top) {
  for (std::uint32_t i = top;;) {
    if (Node& node = nodes_[i]; !node.box_tracked || node.box_pending) {
      node.box_tracked = 1;
      node.box_pending = 0;
      node.box_loose = 0;
      take_box_slot(i);
      if (world_boxes_.size() < local_boxes_.items.size()) world_boxes_.resize(local_boxes_.items.size());
      world_boxes_[node.box] = own_box(i);
      if (node.first_child != kNone) {
        i = node.first_child;
        continue;
      }
    } else if (node.box_loose) {
      tighten_box(i);
    }
    for (;;) {  // i is made
      if (i == top) return;
      const Node& node = nodes_[i];
      world_boxes_[nodes_[node.parent].box].merge(world_boxes_[node.box]);
      ++counters_.boxes_merged;
      if (node.next != kNone) {
        i = node.next;
        break;
      }
      i = node.parent;
    }
  }
}

// Brings the loose sides of `top` in to what is below. Children are looked at only until each of those sides has one
// that lies on it, so a box of many things on one floor is settled by the first of them.
void SceneGraph::tighten_box(std::uint32_t top) {
  struct Frame {
    std::uint32_t node, child;  // the next child to look at
    std::uint32_t open;         // loose sides on which nothing has been found to lie
    WorldBox found;             // the union of what has been looked at
  };
  std::vector<Frame> stack;  // of its own: a scene may be as deep as it is large
  const auto enter = [&](std::uint32_t i) {
    stack.push_back({i, nodes_[i].first_child, nodes_[i].box_loose, own_box(i)});
  };
  // The sides among `of` on which `a` lies as far out as `b`, or farther.
  const auto reached = [](std::uint32_t of, const WorldBox& a, const WorldBox& b) {
    std::uint32_t out = 0;
    for (int side = 0; side < kSides; ++side) {
      if (outward_extent(a, side) >= outward_extent(b, side)) out |= 1u << side;
    }
    return out & of;
  };
  enter(top);
  while (!stack.empty()) {
    Frame& frame = stack.back();
    Node& node = nodes_[frame.node];
    WorldBox& world = world_boxes_[node.box];
    frame.open &= ~reached(frame.open, frame.found, world);
    if (frame.open != 0 && frame.child != kNone) {
      const Node& child = nodes_[frame.child];
      if (!child.box_tracked) {  // just added; it is absorbed when its own turn comes
        frame.child = child.next;
        continue;
      }
      const WorldBox& box = world_boxes_[child.box];
      const std::uint32_t in_doubt = frame.open & child.box_loose;
      if (in_doubt != reached(in_doubt, frame.found, box)) {  // its true extent matters
        enter(frame.child);
        continue;
      }
      frame.found.merge(box);
      frame.child = child.next;
      ++counters_.boxes_merged;
      continue;
    }
    for (int side = 0; side < kSides; ++side) {
      if ((frame.open >> side & 1) == 0) continue;
      if (side < 3) {
        world.lo[side] = frame.found.lo[side];
      } else {
        world.hi[side - 3] = frame.found.hi[side - 3];
      }
    }
    node.box_loose = 0;
    stack.pop_back();
  }
}

void SceneGraph::propagate_box_change(std::uint32_t above, const WorldBox& before, const WorldBox& after) {
  for (; above != kNone && nodes_[above].box_tracked; above = nodes_[above].parent) {
    WorldBox& box = world_boxes_[nodes_[above].box];
    ++counters_.boxes_merged;
    std::uint32_t left = 0;
    for (int side = 0; side < kSides; ++side) {
      const double at = outward_extent(box, side);
      if (outward_extent(before, side) >= at && at > outward_extent(after, side)) left |= 1u << side;
    }
    if (left == 0 && box.contains(after)) return;
    nodes_[above].box_loose |= left;
    box.merge(after);
  }
}

}  // namespace peerd
