#pragma once
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "collision/engines/space_time.hpp"
#include "collision/scene/scene_meshes.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/scene.hpp"

namespace peerd::collision::engines {

// Bounds how the objects of a scene go on as the world moves by itself: by the velocityVectors, and by the speeds of
// the interpolators' present segments, through all Transforms from the world down to each Shape (product rule). Nothing
// is known of a geometry whose vertices move: an object with one is compared at each tick.
class MotionBounds : public SpaceTime {
 public:
  explicit MotionBounds(const Scene& scene);  // the scene outlives it, at its place

  // `objects`: by BroadIndex.
  void set_objects(std::span<const ObjectId> objects);
  // Sets the present, which never decreases [s].
  void set_time(double now_s);

  [[nodiscard]] double now_s() const override { return now_s_; }
  [[nodiscard]] SpaceTimeBound bound(BroadIndex object) override;

 private:
  // Bounds hold for so long at most [s]: what is bounded by the product rule grows with that.
  static constexpr double kHorizon_s = 4.0;

  struct PlacedShape {
    std::vector<ObjectId> path;  // its Transforms, from the world down
    double farthest_m = 0.0;     // the distance of its box's farthest corner from the origin of its own frame
  };
  struct Object {
    std::vector<PlacedShape> shapes;  // those that collide
    bool is_flexible = false;
    std::optional<double> bounded_at_s{};  // when `bound` was computed
    SpaceTimeBound bound;
  };
  [[nodiscard]] bool has_just_changed(ObjectId id);
  struct Velocity {
    Vec3 m_s = Vec3::Zero();  // in the frame of the parent
    double error_m_s = 0.0;
  };
  [[nodiscard]] Object object_of(ObjectId id);
  [[nodiscard]] Velocity translation_velocity(ObjectId id, const PredefinedMotion::FieldRates& rates);
  [[nodiscard]] SpaceTimeBound bound_of(const PlacedShape& shape);

  const Scene& scene_;
  PredefinedMotion motion_;
  SceneMeshes meshes_;
  double now_s_ = -std::numeric_limits<double>::infinity();
  std::vector<Object> objects_;  // by BroadIndex
};

}  // namespace peerd::collision::engines
