#include "core/scene/box_hierarchy.hpp"

#include <cassert>

#include "core/prefetch.hpp"

// A tracked node keeps the union of the boxes below it. A change of one box, from `before` to `after`, is absorbed
// going up: a union grows by `after`, which keeps it exact; where `before` made up a side of it that `after` does not
// reach, that side becomes loose, as only the other children can tell where it lies now. Going up ends where neither
// happens: what a box lies strictly inside of, or adds nothing to, looks the same from farther up. That needs a stored
// box to lie within those stored above it, loose or not.

namespace peerd {

namespace {

constexpr int kSides = 6;
// Returns how far out a side of a box lies, along its own outward axis: -x -y -z +x +y +z.
double outward_extent(const WorldBox& box, int side) { return side < 3 ? -box.lo[side] : box.hi[side - 3]; }

}  // namespace

void BoxHierarchy::take_slot(SceneNode& node) {
  if (node.box == kNoSlot) node.box = local_boxes_.take();
}

void BoxHierarchy::mark_pending(SceneTree& tree, std::uint32_t i) {
  SceneNode& node = tree[i];
  node.box_pending = 1;
  if (node.in_pending_list) return;
  node.in_pending_list = 1;
  pending_.push_back(i);
}

void BoxHierarchy::set_local(SceneTree& tree, std::uint32_t i, const LocalBox& box) {
  if (box.is_empty() && tree[i].box == kNoSlot) return;
  take_slot(tree[i]);
  local_boxes_.items[tree[i].box] = box;
  if (tree[i].box_tracked) mark_pending(tree, i);
}

WorldBox BoxHierarchy::world(SceneTree& tree, const PoseStore& poses, std::uint32_t i) {
  update_pending(tree, poses);
  make_box(tree, poses, i);
  return world_boxes_[tree[i].box];
}

void BoxHierarchy::leave_parent(SceneTree& tree, std::uint32_t i) {
  if (!tree[i].box_tracked) return;
  WorldBox& world = world_boxes_[tree[i].box];
  propagate_change(tree, tree[i].parent, world, {});
  world = {};
}

void BoxHierarchy::remove(const SceneNode& node) {
  if (node.box != kNoSlot) local_boxes_.give_back(node.box);
}

void BoxHierarchy::prefetch_boxes(const SceneNode& node) const {
  if (!node.box_tracked) return;
  prefetch(local_boxes_.items[node.box]);
  prefetch(world_boxes_[node.box]);
}

void BoxHierarchy::update_pending(SceneTree& tree, const PoseStore& poses) {
  for (const std::uint32_t i : pending_) {
    tree[i].in_pending_list = 0;
    if (!tree[i].box_pending) continue;
    const WorldBox before = tree[i].box_tracked ? world_boxes_[tree[i].box] : WorldBox{};
    make_box(tree, poses, i);
    propagate_change(tree, tree[i].parent, before, world_boxes_[tree[i].box]);
  }
  pending_.clear();
}

WorldBox BoxHierarchy::own_box(const SceneTree& tree, const PoseStore& poses, std::uint32_t i) {
  const LocalBox& local = local_boxes_.items[tree[i].box];
  if (local.is_empty()) return {};
  ++counters_.updated;
  return transformed(poses.world(tree[i].pose), local);
}

// The union below `top`, from its children's, going down only where those are not exact themselves. Does not tell
// above.
void BoxHierarchy::make_box(SceneTree& tree, const PoseStore& poses, std::uint32_t top) {
  for (std::uint32_t i = top;;) {
    if (SceneNode& node = tree[i]; !node.box_tracked || node.box_pending) {
      node.box_tracked = 1;
      node.box_pending = 0;
      node.box_loose = 0;
      take_slot(tree[i]);
      if (world_boxes_.size() < local_boxes_.items.size()) world_boxes_.resize(local_boxes_.items.size());
      world_boxes_[node.box] = own_box(tree, poses, i);
      if (node.first_child != kNoSlot) {
        i = node.first_child;
        continue;
      }
    } else if (node.box_loose) {
      tighten_box(tree, poses, i);
    }
    for (;;) {  // i is made
      if (i == top) return;
      const SceneNode& node = tree[i];
      world_boxes_[tree[node.parent].box].merge(world_boxes_[node.box]);
      ++counters_.merged;
      if (node.next != kNoSlot) {
        i = node.next;
        break;
      }
      i = node.parent;
    }
  }
}

// Brings the loose sides of `top` in to what is below. Children are looked at only until each of those sides has one
// that lies on it, so a box of many things on one floor is settled by the first of them.
void BoxHierarchy::tighten_box(SceneTree& tree, const PoseStore& poses, std::uint32_t top) {
  struct Frame {
    std::uint32_t node, child;  // the next child to look at
    std::uint32_t open;         // loose sides on which nothing has been found to lie
    WorldBox found;             // the union of what has been looked at
  };
  std::vector<Frame> stack;  // of its own: a scene may be as deep as it is large
  const auto enter = [&](std::uint32_t i) {
    stack.push_back({i, tree[i].first_child, tree[i].box_loose, own_box(tree, poses, i)});
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
    SceneNode& node = tree[frame.node];
    WorldBox& world = world_boxes_[node.box];
    frame.open &= ~reached(frame.open, frame.found, world);
    if (frame.open != 0 && frame.child != kNoSlot) {
      const SceneNode& child = tree[frame.child];
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
      ++counters_.merged;
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

void BoxHierarchy::propagate_change(SceneTree& tree, std::uint32_t above, const WorldBox& before,
                                    const WorldBox& after) {
  for (; above != kNoSlot && tree[above].box_tracked; above = tree[above].parent) {
    WorldBox& box = world_boxes_[tree[above].box];
    ++counters_.merged;
    std::uint32_t left = 0;
    for (int side = 0; side < kSides; ++side) {
      const double at = outward_extent(box, side);
      if (outward_extent(before, side) >= at && at > outward_extent(after, side)) left |= 1u << side;
    }
    if (left == 0 && box.contains(after)) return;
    tree[above].box_loose |= left;
    box.merge(after);
  }
}

}  // namespace peerd
