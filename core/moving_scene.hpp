#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/predefined_motion.hpp"
#include "core/scene.hpp"
#include "core/scene_graph.hpp"

namespace peerd {

// A read world as it runs: the scene graph of its instances, brought to any world time by its own movement. Costs what
// moves: instances that nothing drives are placed once. No mesh, triangle or box is made until a box is asked for, and
// then only those below what was asked.
class MovingScene {
 public:
  explicit MovingScene(const Scene& scene);  // the scene outlives it, at its place

  // To world time t, forwards or backwards. The nodes whose place in the world changed; valid until the next call.
  std::span<const NodeHandle> go_to(double t_s);
  [[nodiscard]] double time_s() const { return time_s_; }

  [[nodiscard]] NodeHandle node(ObjectId id) const { return nodes_[id.value]; }
  [[nodiscard]] const Affine& world_from_local(ObjectId id) const { return graph_.world_from_local(node(id)); }
  // Of the vertices below an instance that its polygons use, in the world. Empty where it has none. What doesn't collide
  // is within: it is seen.
  [[nodiscard]] WorldBox box(ObjectId id);

  [[nodiscard]] const SceneGraph& graph() const { return graph_; }
  [[nodiscard]] std::uint64_t meshes_built() const { return meshes_built_; }

 private:
  void give_boxes(ObjectId id);

  const Scene& scene_;
  PredefinedMotion motion_;
  SceneGraph graph_;
  std::vector<NodeHandle> nodes_;                           // by instance
  std::vector<std::pair<animation::FieldId, ObjectId>> by_field_;  // what a driven field moves, sorted
  std::vector<animation::FieldId> changing_;
  std::vector<bool> has_box_;           // by instance; empty until a box is asked for
  std::vector<LocalBox> geometry_box_;  // by geometry, once it was needed
  std::vector<bool> has_geometry_box_;
  double time_s_ = 0.0;
  bool placed_ = false;  // at time_s_
  std::uint64_t meshes_built_ = 0;
};

}  // namespace peerd
