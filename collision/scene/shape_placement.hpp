#pragma once
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <vector>

#include "collision/scene/instance_index.hpp"
#include "collision/scene/scaled_geometries.hpp"
#include "collision/scene/scene_meshes.hpp"
#include "core/scene/scene.hpp"

namespace peerd::collision {

// A Shape's place in the world, as far as a question needed it.
struct PlacedShape {
  bool known = false;                         // `pose` and what follows from it hold
  bool had_pose = false;                      // there was a pose before this one
  StretchedPose pose;                         // the Shape's path in two parts (core/transform.hpp)
  Affine world_from_shape;                    // the same, in one
  double displacement_m = 0.0;                // a bound of how far any vertex went from the pose before to this one
  std::uint64_t updated_batch = 0;            // the batch of moves after which the pose was computed
  ScaledGeometry* scaled_geometry = nullptr;  // the geometry with that stretch, once a question needed its polygons
};

// Places the Shapes of a scene: it knows all Transforms, computes a Shape's pose when a question needs it, and holds
// the scaled geometry that the pose asks for. Moves are gathered until apply_moves(), which every question does first.
class ShapePlacement {
 public:
  // The scene outlives this object, at its place.
  ShapePlacement(const Scene& scene, HierarchyLoader load_hierarchy);
  ShapePlacement(const ShapePlacement&) = delete;
  ShapePlacement& operator=(const ShapePlacement&) = delete;

  // A Transform's fields from now on, by its index in Scene::transforms. False where they are the same ones.
  bool move(std::uint32_t transform, const TransformFields& fields);

  // Forgets the poses below everything that moved. invalidate(begin, end) is called for each such subtree of instances,
  // in ascending order; subtrees within others are passed over.
  template <class Invalidate>
  void apply_moves(Invalidate&& invalidate) {
    if (moved_.empty()) return;
    begin_batch();
    std::uint32_t end = 0;
    for (const std::uint32_t moved : moved_) {
      if (moved < end) continue;
      end = scene_.instances[moved].subtree_end;
      assert(end > moved && end <= placed_.size());
      for (std::uint32_t i = moved; i < end; ++i) placed_[i].known = false;
      invalidate(moved, end);
    }
    moved_.clear();
  }

  // A geometry has another form from now on.
  void reshape(std::uint32_t geometry, const Geometry& form);

  [[nodiscard]] const PlacedShape& placed(std::uint32_t shape);
  // The scaled geometry of a Shape. The error names the Shape and says which vertex can't be used.
  [[nodiscard]] std::expected<ScaledGeometry*, std::string> scaled_geometry(std::uint32_t shape);
  [[nodiscard]] WideTree& tree(std::uint32_t shape, ScaledGeometry& scaled_geometry) {
    return geometries_.tree(scene_.id_of(shape), scaled_geometry);
  }
  // How far a Shape's vertices went since the last batch of moves but one [m]; 0 where it did not move in that batch.
  [[nodiscard]] double displacement_m(std::uint32_t shape) {
    const PlacedShape& at = placed(shape);
    return at.updated_batch == batch_ ? at.displacement_m : 0.0;
  }

  [[nodiscard]] const Mesh& mesh(std::uint32_t shape) { return meshes_.mesh(geometry_of(shape)); }
  [[nodiscard]] const LocalBox& local_box(std::uint32_t shape) { return meshes_.local_box(geometry_of(shape)); }
  [[nodiscard]] std::span<const std::uint32_t> instances_of_transform(std::uint32_t transform) const {
    return instances_of_transform_.of(transform);
  }
  [[nodiscard]] std::span<const std::uint32_t> instances_of_geometry(std::uint32_t geometry) const {
    return instances_of_geometry_.of(geometry);
  }
  [[nodiscard]] const ScaledGeometries& geometries() const { return geometries_; }
  [[nodiscard]] std::uint64_t meshes_built() const { return meshes_.meshes_built(); }

 private:
  void begin_batch();
  [[nodiscard]] std::uint32_t geometry_of(std::uint32_t shape) const {
    assert(shape < scene_.instances.size() && scene_.instances[shape].geometry != Instance::kNone);
    return scene_.instances[shape].geometry;
  }

  const Scene& scene_;
  SceneMeshes meshes_;
  ScaledGeometries geometries_;
  InstanceIndex instances_of_transform_, instances_of_geometry_;
  std::vector<TransformFields> transforms_;
  std::vector<std::uint32_t> moved_;   // the instances whose Transform has moved since apply_moves()
  std::uint64_t batch_ = 0;            // batches of moves so far
  std::vector<PlacedShape> placed_;    // by instance
  std::vector<TransformFields> path_;  // scratch of placed()
};

}  // namespace peerd::collision
