#pragma once
#include <string_view>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/transform.hpp"

namespace peerd::collision {

// The object of that path, which the scene has.
inline ObjectId id(const Scene& scene, std::string_view path) { return scene.find(path).value(); }

// The pose of a Shape in the world, from the Transforms above it, without the caches of a query.
inline StretchedPose placed(const Scene& scene, std::uint32_t shape) {
  std::vector<TransformFields> path;
  for (auto i = static_cast<std::int32_t>(shape); i >= 0; i = scene.instances[static_cast<std::size_t>(i)].parent) {
    path.insert(path.begin(), scene.transform(ObjectId{static_cast<std::uint32_t>(i)}));
  }
  return stretched_pose(path);
}

// Two objects of several Shapes: uneven scales, a shared Shape, a Shape without polygons and one that does not collide.
inline constexpr std::string_view kGroups = R"(
  DEF A Group { children [
    Transform { rotation 1 2 3 0.7 scale 1.5 0.5 1 children DEF BALL Shape { geometry Sphere {} } }
    Transform { translation 1 0.5 0 scale 2 2 2 scaleOrientation 0 0 1 0.3 children [
      Transform { rotation 0 1 0 0.4 scale 0.5 1 0.25 children Shape { geometry Cone {} } }
      Shape { geometry Box { size 0.5 0.5 0.5 } } ] } ] }
  DEF B Transform { translation 0.8 0.2 0.1 rotation 0 1 1 1 center 0.1 0 0 children [
    USE BALL
    Transform { translation 0 1 0 children [ Shape { geometry Cylinder {} } Shape { geometry PointSet {} } ] }
    Collision { collide FALSE children Shape { geometry Box { size 9 9 9 } } } ] })";

}  // namespace peerd::collision
