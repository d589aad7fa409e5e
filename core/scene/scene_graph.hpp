#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/box.hpp"
#include "core/math.hpp"
#include "core/scene/box_hierarchy.hpp"
#include "core/scene/pose_store.hpp"
#include "core/scene/scene_tree.hpp"
#include "core/transform.hpp"

namespace peerd {

// A NodeSpec is a node of a subtree that is to be added.
struct NodeSpec {
  std::int32_t parent = -1;                    // index in the same array, below its own; -1 under the given parent
  const TransformFields* transform = nullptr;  // read during the call only; null: none
};

// A RigidMove is the place that a node with a transform goes to, in the frame of its parent.
struct RigidMove {
  NodeHandle node;
  Vec3 translation_m = Vec3::Zero();
  Quat rotation = Quat::Identity();
};

// SceneGraphCounters count the work since the graph was made (copies keep counting from where they were copied).
struct SceneGraphCounters {
  std::uint64_t transforms_set = 0;  // calls of the setters
  std::uint64_t poses_updated = 0;   // products world_from_parent * parent_from_local
  std::uint64_t nodes_changed = 0;   // nodes that updates have reported
  std::uint64_t boxes_updated = 0;   // local boxes taken to the world
  std::uint64_t boxes_merged = 0;    // a box compared with, or merged into, that of a node above it
};

// A SceneGraph is the world as it runs: a tree of nodes, some with the fields of a Transform, some with a box of
// vertices. Frames, units and products are those of core/transform.hpp: metres, +Y up, p_world = world_from_local *
// p_local.
//
// Edits of structure show at once; poses, and `changed()`, show the state of the last update(). A handle of a removed
// node is a bug of the caller, which every function asserts; where a node may have gone in the meantime, ask alive()
// first. Numbers must be finite, and a tree is at most 2^20 - 1 deep. Single-threaded; no clock, no randomness: the
// same calls give the same bits, in the same order.
class SceneGraph {
 public:
  using NodeRange = SceneNodeRange;

  // ---- Structure. The root is always there: no transform, world frame, never removed or moved.
  [[nodiscard]] NodeHandle root() const { return tree_.handle_of(SceneTree::kRoot); }
  [[nodiscard]] bool alive(NodeHandle node) const { return tree_.alive(node); }
  [[nodiscard]] std::size_t size() const { return tree_.size(); }  // without the root
  [[nodiscard]] bool has_transform(NodeHandle node) const { return at(node).has_transform; }

  // `before` is a child of `parent` to stand in front of; none: behind all of them.
  NodeHandle add_group(NodeHandle parent, NodeHandle before = {});
  NodeHandle add_transform(NodeHandle parent, const TransformFields& fields, NodeHandle before = {});
  // Adds all of `nodes` in one pass, in their order among siblings; the handles are in the order of `nodes`. Nodes that
  // are listed depth first lie so in memory too (in a graph without free slots). A whole world is built in this way
  // too.
  std::vector<NodeHandle> add_subtree(NodeHandle parent, std::span<const NodeSpec> nodes, NodeHandle before = {});
  // Removes the node with everything below it. O(subtree).
  void remove(NodeHandle node);
  // Puts the subtree of `node` under `parent`; it keeps its local fields, so it moves in the world. Returns false, and
  // does nothing, where `parent` is `node` or below it. O(depth), and O(subtree) where the depth changes.
  [[nodiscard]] bool move(NodeHandle node, NodeHandle parent, NodeHandle before = {});

  // These return no node (alive() is false) at the top, or at the end.
  [[nodiscard]] NodeHandle parent(NodeHandle node) const { return tree_.handle_of(at(node).parent); }
  [[nodiscard]] NodeHandle first_child(NodeHandle node) const { return tree_.handle_of(at(node).first_child); }
  // Both ranges are in order. A range must not outlive an edit of what it runs over.
  [[nodiscard]] NodeRange children(NodeHandle node) const {
    const std::uint32_t i = tree_.slot(node);
    return {tree_, tree_[i].first_child, i, false};
  }
  [[nodiscard]] NodeRange subtree(NodeHandle node) const {  // depth first, `node` itself ahead
    const std::uint32_t i = tree_.slot(node);
    return {tree_, i, i, true};
  }

  // ---- Poses. Setters and local() are for nodes with a transform; rotations are unit.
  void set_local(NodeHandle node, const TransformFields& fields);
  void set_translation(NodeHandle node, const Vec3& translation_m);
  void set_rotation(NodeHandle node, const Quat& rotation);
  void set_rigid(NodeHandle node, const Vec3& translation_m, const Quat& rotation);
  // Sets many nodes, in their order. In a large scene this is much faster than one call each: no data of a moving node
  // is in a cache then, and this function prefetches it for many nodes at once.
  void set_rigid(std::span<const RigidMove> moves);
  [[nodiscard]] TransformFields local(NodeHandle node) const;

  // Brings the poses below everything that was set, added or moved up to date, each subtree once, and returns
  // changed(). O(changed and below), and n log n in the n edited nodes where they are not of one depth.
  std::span<const NodeHandle> update();
  // Returns the nodes whose world pose the last update() made: those set, added or moved, and all below, each once,
  // parents before children. Removed nodes are not listed. The span is valid until the next update(); a node that was
  // removed since then is a stale handle.
  [[nodiscard]] std::span<const NodeHandle> changed() const { return changed_; }
  [[nodiscard]] bool up_to_date() const { return dirty_.empty(); }

  // Returns ((identity * t_1) * t_2) * .. over the transforms of the path of the node, itself included, in the same
  // bits as Scene::world_from_local. It is the pose of the last update(); that of the parent or the identity for a node
  // added since.
  [[nodiscard]] const Affine& world_from_local(NodeHandle node) const { return poses_.world(at(node).pose); }

  // ---- Boxes. A local box costs its 24 bytes; nothing else happens until box() is asked, and then to that subtree.
  // set_local_box() takes the box of the vertices of the node itself, in the frame that world_from_local maps from;
  // empty takes it away.
  void set_local_box(NodeHandle node, const LocalBox& box);
  // Returns the union of transformed(world_from_local, local box) over the node and all below: exactly that union,
  // however it has been kept up. Needs up_to_date(). The first call costs O(subtree). From then on a moved node costs
  // its own subtree and the few nodes above whose box it changes. Where a node lay on a side of the box above and left
  // it, the next call for that box looks for another child that lies on that side: O(its children) where there is none.
  [[nodiscard]] WorldBox box(NodeHandle node);

  [[nodiscard]] SceneGraphCounters counters() const {
    return {transforms_set_, poses_updated_, nodes_changed_, boxes_.counters().updated, boxes_.counters().merged};
  }
  [[nodiscard]] std::size_t memory_bytes() const;  // size of all arrays, spare capacity included

 private:
  [[nodiscard]] const SceneNode& at(NodeHandle node) const { return tree_[tree_.slot(node)]; }
  std::uint32_t new_node(std::uint32_t parent, std::uint32_t before, const TransformFields* transform);
  void free_node(std::uint32_t i);
  void relink_poses(std::uint32_t top);
  PlacedTransform& set_placed(NodeHandle node);
  void mark_dirty(std::uint32_t i);
  void update_below(std::uint32_t top);

  SceneTree tree_;
  PoseStore poses_;
  BoxHierarchy boxes_;
  std::vector<std::uint32_t> dirty_;  // slots; what is marked `dirty`, and some that no longer are
  std::vector<NodeHandle> changed_;
  std::uint64_t transforms_set_ = 0, poses_updated_ = 0, nodes_changed_ = 0;  // as in SceneGraphCounters
};

}  // namespace peerd
