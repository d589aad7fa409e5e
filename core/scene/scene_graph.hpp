#pragma once
#include <array>
#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>
#include <vector>

#include "core/box.hpp"
#include "core/math.hpp"
#include "core/transform.hpp"

namespace peerd {

// A node of one SceneGraph and of the copies made of it since. It names that node until the node is removed, and
// nothing from then on: a slot that is used again has another generation.
struct NodeHandle {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;  // odd for a node; 0: no node
  friend constexpr auto operator<=>(const NodeHandle&, const NodeHandle&) = default;
};

// A node of a subtree that is to be added.
struct NodeSpec {
  std::int32_t parent = -1;                    // index in the same array, below its own; -1 under the given parent
  const TransformFields* transform = nullptr;  // read during the call only; null: none
};

// Where a node with a transform goes, in its parent's frame.
struct RigidMove {
  NodeHandle node;
  Vec3 translation_m = Vec3::Zero();
  Quat rotation = Quat::Identity();
};

// Work done since the graph was made (copies keep counting from where they were copied).
struct SceneGraphCounters {
  std::uint64_t transforms_set = 0;  // calls of the setters
  std::uint64_t poses_updated = 0;   // products world_from_parent * parent_from_local
  std::uint64_t nodes_changed = 0;   // what updates have reported
  std::uint64_t boxes_updated = 0;   // local boxes taken to the world
  std::uint64_t boxes_merged = 0;    // a box compared with, or merged into, that of a node above it
};

// The world as it runs: a tree of nodes, some with the fields of a Transform, some with a box of vertices. Frames,
// units and products are those of core/transform.hpp: metres, +Y up, p_world = world_from_local * p_local.
//
// Edits of structure show at once; poses, and `changed()`, as of the last update(). A handle of a removed node is a bug
// of the caller, which every function asserts; where a node may have gone in the meantime, ask alive() first. Numbers
// must be finite, and a tree is at most 2^20 - 1 deep. Single-threaded; no clock, no randomness: the same calls give
// the same bits, in the same order.
class SceneGraph {
 public:
  class NodeRange;

  SceneGraph();

  // ---- Structure. The root is always there: no transform, world frame, never removed or moved.
  [[nodiscard]] NodeHandle root() const { return handle_of(kRoot); }
  [[nodiscard]] bool alive(NodeHandle node) const {
    return node.index < nodes_.size() && (node.generation & 1) != 0 && nodes_[node.index].generation == node.generation;
  }
  [[nodiscard]] std::size_t size() const { return nodes_.size() - free_nodes_.size() - retired_slots_ - 1; }  // no root
  [[nodiscard]] bool has_transform(NodeHandle node) const { return at(node).has_transform; }

  // `before` is a child of `parent` to stand in front of; none: behind all of them.
  NodeHandle add_group(NodeHandle parent, NodeHandle before = {});
  NodeHandle add_transform(NodeHandle parent, const TransformFields& fields, NodeHandle before = {});
  // All of `nodes` in one pass, in their order among siblings; the handles are in the order of `nodes`. Listed depth
  // first they lie so in memory too (in a graph without free slots). This is also how a whole world is built.
  std::vector<NodeHandle> add_subtree(NodeHandle parent, std::span<const NodeSpec> nodes, NodeHandle before = {});
  // With all that is below. O(subtree).
  void remove(NodeHandle node);
  // Puts the subtree of `node` under `parent`; it keeps its local fields, so it moves in the world. False, and nothing
  // done, where `parent` is `node` or below it. O(depth), and O(subtree) where the depth changes.
  [[nodiscard]] bool move(NodeHandle node, NodeHandle parent, NodeHandle before = {});

  // No node (alive() is false) at the top, at the end.
  [[nodiscard]] NodeHandle parent(NodeHandle node) const { return handle_of(at(node).parent); }
  [[nodiscard]] NodeHandle first_child(NodeHandle node) const { return handle_of(at(node).first_child); }
  // In order. A range must not outlive an edit of what it runs over.
  [[nodiscard]] NodeRange children(NodeHandle node) const;
  [[nodiscard]] NodeRange subtree(NodeHandle node) const;  // depth first, `node` itself ahead

  // ---- Poses. Setters and local() are for nodes with a transform; rotations are unit.
  void set_local(NodeHandle node, const TransformFields& fields);
  void set_translation(NodeHandle node, const Vec3& translation_m);
  void set_rotation(NodeHandle node, const Quat& rotation);
  void set_rigid(NodeHandle node, const Vec3& translation_m, const Quat& rotation);
  // The same for many, in their order. In a large scene much faster than one call each: nothing of a mover is in a
  // cache then, and here memory is asked for many of them at once.
  void set_rigid(std::span<const RigidMove> moves);
  [[nodiscard]] TransformFields local(NodeHandle node) const;

  // Brings the poses below everything that was set, added or moved up to date, each subtree once, and returns
  // changed(). O(changed and below), and n log n in the n edited nodes where they are not of one depth.
  std::span<const NodeHandle> update();
  // The nodes whose world pose the last update() made: set, added or moved, and all below. Each once, parents before
  // children; removed ones are not told. Valid until the next update(); a node that was removed since then is a stale
  // handle.
  [[nodiscard]] std::span<const NodeHandle> changed() const { return changed_; }
  [[nodiscard]] bool up_to_date() const { return dirty_.empty(); }

  // ((identity * t_1) * t_2) * .. over the transforms of the node's path, itself included: Scene::world_from_local's
  // bits. As of the last update(); the parent's or the identity for a node added since.
  [[nodiscard]] const Affine& world_from_local(NodeHandle node) const { return placed_.items[at(node).pose].world; }

  // ---- Boxes. A local box costs its 24 bytes; nothing else happens until box() is asked, and then to that subtree.
  // Of the node's own vertices, in the frame that world_from_local maps from; empty takes it away.
  void set_local_box(NodeHandle node, const LocalBox& box);
  // The union of transformed(world_from_local, local box) over the node and all below: exactly that union, however it
  // has been kept up. Needs up_to_date(). First call: O(subtree). From then on a moved node costs its own subtree and
  // the few nodes above whose box it changes. Where a node lay on a side of the box above and left it, the next to ask
  // for that box looks for another child that lies on that side: O(its children) where there is none.
  [[nodiscard]] WorldBox box(NodeHandle node);

  [[nodiscard]] const SceneGraphCounters& counters() const { return counters_; }
  [[nodiscard]] std::size_t memory_bytes() const;  // of all arrays, their spare capacity included

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t kRoot = 0;
  static constexpr std::uint32_t kMaxDepth = (1u << 20) - 1;

  // Half a cache line: what walking, checking a handle and marking need.
  struct alignas(32) Node {
    std::uint32_t generation = 0;
    std::uint32_t parent = kNone;
    std::uint32_t first_child = kNone;
    std::uint32_t next = kNone;      // sibling
    std::uint32_t previous = kNone;  // sibling; the first one's is the last one, itself where it is alone
    std::uint32_t pose = 0;          // in placed_: its own, or else its parent's
    std::uint32_t box = kNone;       // in local_boxes_ and world_boxes_
    std::uint32_t depth : 20 = 0;    // below the root
    std::uint32_t has_transform : 1 = 0;
    std::uint32_t dirty : 1 = 0;          // its pose is to be made by update(), with all below
    std::uint32_t in_dirty_list : 1 = 0;  // of the slot, not of the node: survives remove()
    // A tracked node has a world box, which everything tracked above has absorbed; all below is tracked or pending.
    std::uint32_t box_tracked : 1 = 0;
    std::uint32_t box_pending : 1 = 0;  // it is to be made anew from what is below
    std::uint32_t in_pending_list : 1 = 0;
    std::uint32_t box_loose : 6 = 0;  // sides, -x -y -z +x +y +z, that may be farther out than anything below
  };
  // The transform of a node with one, three cache lines. Only what most of them have; the rest is in stretches_.
  struct alignas(32) Placed {
    std::array<double, 3> translation = {0, 0, 0};  // [m]
    std::array<double, 4> rotation = {0, 0, 0, 1};  // x, y, z, w
    std::uint32_t parent_pose = 0;                  // in placed_
    std::uint32_t stretch = kNone;                  // in stretches_; none: scale 1, center 0
    Affine world;
  };
  struct Stretch {
    std::array<double, 3> scale, center;
    std::array<double, 4> scale_orientation;  // x, y, z, w
  };
  template <class T>
  struct Pool {
    std::vector<T> items;
    std::vector<std::uint32_t> free;
    std::uint32_t take() {
      if (free.empty()) {
        assert(items.size() < kNone);
        items.emplace_back();
        return static_cast<std::uint32_t>(items.size() - 1);
      }
      const std::uint32_t i = free.back();
      free.pop_back();
      items[i] = T{};
      return i;
    }
    void give_back(std::uint32_t i) { free.push_back(i); }
  };

  [[nodiscard]] const Node& at(NodeHandle node) const { return nodes_[slot(node)]; }
  [[nodiscard]] std::uint32_t slot(NodeHandle node) const;
  [[nodiscard]] NodeHandle handle_of(std::uint32_t i) const {
    return i == kNone ? NodeHandle{} : NodeHandle{i, nodes_[i].generation};
  }
  [[nodiscard]] std::uint32_t place(std::uint32_t parent, NodeHandle before) const;
  std::uint32_t new_node(std::uint32_t parent, std::uint32_t before, const TransformFields* transform);
  void free_node(std::uint32_t i);
  void link(std::uint32_t i, std::uint32_t parent, std::uint32_t before);
  void unlink(std::uint32_t i);
  // The node after i, depth first and without going below i, within the subtree of `top`; kNone behind its end.
  [[nodiscard]] std::uint32_t after_subtree(std::uint32_t i, std::uint32_t top) const;
  [[nodiscard]] std::uint32_t after(std::uint32_t i, std::uint32_t top) const;
  void shift_depths(std::uint32_t top, std::int64_t by);
  void relink_poses(std::uint32_t top);
  void drop_stretch(Placed& placed);
  void write_fields(Placed& placed, const TransformFields& fields);
  [[nodiscard]] TransformFields read_fields(const Placed& placed) const;
  Placed& set_placed(NodeHandle node);
  void prefetch_box(const Node& node) const;
  void mark_dirty(std::uint32_t i);
  void update_below(std::uint32_t top);

  void mark_box_pending(std::uint32_t i);
  void update_pending_boxes();
  void make_box(std::uint32_t top);
  void tighten_box(std::uint32_t top);
  void propagate_box_change(std::uint32_t above, const WorldBox& before, const WorldBox& after);
  [[nodiscard]] WorldBox own_box(std::uint32_t i);
  void take_box_slot(std::uint32_t i);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> free_nodes_;
  std::size_t retired_slots_ = 0;  // their generations are used up
  Pool<Placed> placed_;            // [0] is the root's: the identity
  Pool<Stretch> stretches_;
  Pool<LocalBox> local_boxes_;
  std::vector<WorldBox> world_boxes_;  // as local_boxes_, empty until box() is first asked
  std::vector<std::uint32_t> dirty_;   // slots; what is marked `dirty`, and some that no longer are
  std::vector<std::uint32_t> pending_boxes_;
  std::vector<NodeHandle> changed_;
  SceneGraphCounters counters_;
};

// A forward range of handles; see SceneGraph::children() and subtree().
class SceneGraph::NodeRange {
 public:
  class Iterator {
   public:
    using value_type = NodeHandle;
    using difference_type = std::ptrdiff_t;
    Iterator() = default;
    [[nodiscard]] NodeHandle operator*() const { return graph_->handle_of(i_); }
    Iterator& operator++() {
      i_ = deep_ ? graph_->after(i_, top_) : graph_->nodes_[i_].next;
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
    friend class NodeRange;
    [[nodiscard]] bool at_end() const { return i_ == kNone; }
    const SceneGraph* graph_ = nullptr;
    std::uint32_t i_ = kNone, top_ = kNone;
    bool deep_ = false;
  };

  [[nodiscard]] Iterator begin() const { return begin_; }
  [[nodiscard]] std::default_sentinel_t end() const { return {}; }

 private:
  friend class SceneGraph;
  NodeRange(const SceneGraph& graph, std::uint32_t first, std::uint32_t top, bool deep) {
    begin_.graph_ = &graph;
    begin_.i_ = first;
    begin_.top_ = top;
    begin_.deep_ = deep;
  }
  Iterator begin_;
};

inline SceneGraph::NodeRange SceneGraph::children(NodeHandle node) const {
  const std::uint32_t i = slot(node);
  return {*this, nodes_[i].first_child, i, false};
}
inline SceneGraph::NodeRange SceneGraph::subtree(NodeHandle node) const {
  const std::uint32_t i = slot(node);
  return {*this, i, i, true};
}

}  // namespace peerd
