#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/motion/predefined_motion.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/scene_graph.hpp"

namespace peerd {

// A MovingScene is a read world as it runs: the scene graph of its instances, brought to any world time by its own
// movement. The cost depends on the instances that move: those that nothing drives are placed once. No mesh, triangle
// or box is made until a box is asked for, and then only those below the instance asked for.
class MovingScene {
 public:
  explicit MovingScene(const Scene& scene);  // the scene outlives it, at its place

  // Moves the scene to world time t, forwards or backwards. The result lists the nodes whose place in the world
  // changed; it is valid until the next call.
  std::span<const NodeHandle> go_to(double t_s);
  [[nodiscard]] double time_s() const { return time_s_; }

  [[nodiscard]] NodeHandle node(ObjectId id) const { return parts_.front().nodes[id.value]; }
  [[nodiscard]] const Affine& world_from_local(ObjectId id) const { return graph_.world_from_local(node(id)); }
  // Returns the box in the world of the vertices below an instance that its polygons use. The box is empty where there
  // are none. Geometry that does not collide counts, since it is seen.
  [[nodiscard]] WorldBox box(ObjectId id);

  // Returns the pending Inlines of the scene, by their place in its list, that have not been filled and whose boxes
  // meet `of_interest` as the world stands now.
  [[nodiscard]] std::vector<std::size_t> inlines_near(const WorldBox& of_interest) const;
  // Puts the content of a pending Inline where it belongs; it moves by itself as the rest does. An Inline is filled
  // once.
  void fill_inline(std::size_t pending, std::shared_ptr<const Scene> content);

  [[nodiscard]] const SceneGraph& graph() const { return graph_; }
  [[nodiscard]] std::uint64_t meshes_built() const { return meshes_built_; }

 private:
  // A part of the scene: the world itself, or the content of an Inline, as instances in a graph.
  struct Part {
    Part(const Scene& s, SceneGraph& graph, NodeHandle parent);

    const Scene& scene;
    PredefinedMotion motion;
    std::vector<NodeHandle> nodes;                                  // indexed by instance
    std::vector<std::pair<animation::FieldId, ObjectId>> by_field;  // instances that a driven field moves, sorted
    std::vector<ObjectId> drifting;                                 // instances that a velocityVector moves
    std::vector<bool> has_box;             // indexed by instance; empty until a box is asked for
    std::vector<LocalBox> geometry_boxes;  // indexed by geometry, once it was needed
    std::vector<bool> has_geometry_box;
    bool placed = false;                 // at time_s_
    std::shared_ptr<const Scene> owned;  // keeps `scene` where it is an Inline's
    std::size_t pending = 0;             // index of the Inline
  };
  void place(Part& part, double t_s);
  void set_local_boxes(Part& part, std::uint32_t begin, std::uint32_t end);

  SceneGraph graph_;
  std::deque<Part> parts_;  // the world's own first
  std::vector<animation::FieldId> changing_;
  double time_s_ = 0.0;
  std::uint64_t meshes_built_ = 0;
};

}  // namespace peerd
