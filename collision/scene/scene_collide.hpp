#pragma once
#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <vector>

#include "collision/exact/relative_motion.hpp"
#include "collision/query/wide_query.hpp"
#include "collision/scene/narrow_phase.hpp"
#include "collision/scene/shape_boxes.hpp"
#include "collision/scene/shape_placement.hpp"
#include "core/shape_polygon.hpp"

namespace peerd::collision {

using peerd::ShapePair;
using peerd::ShapePolygon;

// The answer for a collider and a collidee.
struct Collision {
  bool colliding = false;
  std::vector<ShapePair> pairs;  // kWitness: one; kAllPairs: all, sorted, each once; kBox: none
};

// Two Shapes whose boxes overlap, as the exact questions see them.
struct ClosePair {
  std::uint32_t a = 0, b = 0;                  // instances, a < b: a gives the frame
  std::uint64_t version_a = 0, version_b = 0;  // ScaledGeometry::version
  WideTree *tree_a = nullptr, *tree_b = nullptr;
  RelativeMotion a_from_b;
  bool collider_first = true;  // whether a is below the collider
};

// Finds which Shapes of two objects touch. The placement and the boxes outlive this object, and moves are applied
// before each call.
class SceneCollide {
 public:
  SceneCollide(const Scene& scene, ShapePlacement& placement, ShapeBoxes& boxes);
  SceneCollide(const SceneCollide&) = delete;
  SceneCollide& operator=(const SceneCollide&) = delete;

  // The answers of SceneQuery's functions of the same names.
  [[nodiscard]] std::expected<Collision, std::string> collide(ObjectId collider, ObjectId collidee, CollisionType type);
  [[nodiscard]] std::expected<void, std::string> visit_close_pairs(ObjectId collider, ObjectId collidee,
                                                                   const std::function<bool(const ClosePair&)>& visit);
  [[nodiscard]] bool separated_by(ObjectId a, ObjectId b, double gap_m);

  // Lets `narrow_phase` answer about pairs of Shapes in place of the wide trees; null: those. It outlives this object.
  void set_narrow_phase(NarrowPhase* narrow_phase) { narrow_phase_ = narrow_phase; }

  [[nodiscard]] const QueryCounters& counters() const {
    return narrow_phase_ != nullptr ? narrow_phase_->counters() : query_.counters();
  }

 private:
  struct Search;

  const Scene& scene_;
  ShapePlacement& placement_;
  ShapeBoxes& boxes_;
  WideQuery query_;
  NarrowPhase* narrow_phase_ = nullptr;
};

}  // namespace peerd::collision
