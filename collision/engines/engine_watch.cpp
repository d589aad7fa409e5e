#include "collision/engines/engine_watch.hpp"

#include <memory>
#include <utility>

namespace peerd::collision::engines {
namespace {

WatchEngine watch_engine(const Engine& engine, MotionBounds* bounds) {
  WatchEngine out{engine.narrow_phase.get(), engine.broad_phase, {}};
  if (bounds != nullptr) {
    out.make_broad = [bounds](std::span<const ObjectId> objects) -> std::unique_ptr<BroadPhase> {
      bounds->set_objects(objects);
      return std::make_unique<SpaceTimeBroadPhase>(*bounds);
    };
  }
  return out;
}

}  // namespace

EngineWatch::EngineWatch(const Scene& scene, const Engine& engine, HierarchyLoader load_hierarchy, BoxBound bound)
    : motion_(scene),
      bounds_(engine.has_space_time_bounds ? std::optional<MotionBounds>(std::in_place, scene) : std::nullopt),
      watch_(scene, std::move(load_hierarchy), {}, watch_engine(engine, bounds_ ? &*bounds_ : nullptr)) {
  watch_.set_box_bound(bound);
}

const CollisionWatch::Tick& EngineWatch::tick(double time_s) {
  if (bounds_) bounds_->set_time(time_s);
  watch_.set_transforms(motion_.transforms_at(time_s));
  for (SceneMotion::MovedGeometry& moved : motion_.moved_geometries(time_s)) {
    watch_.reshape(moved.index, std::move(moved.form));
  }
  return watch_.tick();
}

}  // namespace peerd::collision::engines
