#pragma once
#include <optional>

#include "collision/engines/engine.hpp"
#include "collision/engines/motion_bounds.hpp"
#include "collision/scene/collision_watch.hpp"
#include "core/motion/scene_motion.hpp"

namespace peerd::collision::engines {

// A CollisionWatch by an engine, over a scene that moves by itself as time goes on. An engine serves one of them: it
// knows soups by numbers that are one watch's own.
class EngineWatch {
 public:
  // Both outlive this object, at their places.
  EngineWatch(const Scene& scene, const Engine& engine, HierarchyLoader load_hierarchy, BoxBound bound);
  EngineWatch(const EngineWatch&) = delete;
  EngineWatch& operator=(const EngineWatch&) = delete;

  // Brings the scene to a world time, which never decreases, and answers; valid until the next tick.
  const CollisionWatch::Tick& tick(double time_s);

  [[nodiscard]] const CollisionWatch& watch() const { return watch_; }

 private:
  SceneMotion motion_;
  std::optional<MotionBounds> bounds_;
  CollisionWatch watch_;
};

}  // namespace peerd::collision::engines
