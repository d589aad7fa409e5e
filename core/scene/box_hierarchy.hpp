#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/box.hpp"
#include "core/scene/pose_store.hpp"
#include "core/scene/scene_tree.hpp"
#include "core/scene/slot_pool.hpp"

namespace peerd {

// The number of boxes that have been computed.
struct BoxCounters {
  std::uint64_t updated = 0;  // local boxes taken to the world
  std::uint64_t merged = 0;   // a box compared with, or merged into, that of a node above it
};

// The boxes of the nodes of a SceneGraph: each node's own in its local frame, and the union of all below it in the
// world. Nothing is computed for a node until its world box is asked for. The tree holds the marks of each node; it and
// the poses are those that the boxes belong to, in every call.
class BoxHierarchy {
 public:
  // Sets the box of the vertices of node i, in its local frame; empty takes it away.
  void set_local(SceneTree& tree, std::uint32_t i, const LocalBox& box);
  // The union of transformed(world_from_local, local box) over node i and all below it. The poses are up to date.
  [[nodiscard]] WorldBox world(SceneTree& tree, const PoseStore& poses, std::uint32_t i);

  // Notes that the world box of i has to be made anew, since its pose or what hangs below it has changed.
  void mark_pending(SceneTree& tree, std::uint32_t i);
  // Takes the box of i out of those above it, before the subtree of i is removed or hangs elsewhere. A subtree that
  // stays alive is to be marked as pending then.
  void leave_parent(SceneTree& tree, std::uint32_t i);
  // Gives the slot of a node back that is about to be freed.
  void remove(const SceneNode& node);

  // Asks the memory for the boxes of a node, where they are kept up to date.
  void prefetch_boxes(const SceneNode& node) const;
  [[nodiscard]] const BoxCounters& counters() const { return counters_; }
  [[nodiscard]] std::size_t memory_bytes() const {
    return local_boxes_.memory_bytes() + capacity_bytes(world_boxes_) + capacity_bytes(pending_);
  }

 private:
  void update_pending(SceneTree& tree, const PoseStore& poses);
  void make_box(SceneTree& tree, const PoseStore& poses, std::uint32_t top);
  void tighten_box(SceneTree& tree, const PoseStore& poses, std::uint32_t top);
  void propagate_change(SceneTree& tree, std::uint32_t above, const WorldBox& before, const WorldBox& after);
  [[nodiscard]] WorldBox own_box(const SceneTree& tree, const PoseStore& poses, std::uint32_t i);
  void take_slot(SceneNode& node);

  SlotPool<LocalBox> local_boxes_;
  std::vector<WorldBox> world_boxes_;  // as local_boxes_, empty until a world box is first asked for
  std::vector<std::uint32_t> pending_;
  BoxCounters counters_;
};

}  // namespace peerd
