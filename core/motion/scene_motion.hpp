#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "core/motion/predefined_motion.hpp"
#include "core/scene/scene.hpp"
#include "core/shared_array.hpp"

namespace peerd {

// The poses of all of a scene at a world time when no peer runs it: each Transform is where PredefinedMotion has it. A
// call costs what moves. The class is not thread-safe, because PredefinedMotion is not.
class SceneMotion {
 public:
  explicit SceneMotion(const Scene& scene);  // the scene outlives it, at its place

  // The fields of all Transforms at world time t_s, by their index in Scene::transforms: a function of the scene and of
  // t_s alone. The reference is valid until the next call.
  [[nodiscard]] const std::vector<TransformFields>& transforms_at(double t_s);

  struct MovedGeometry {
    std::uint32_t index = 0;  // into Scene::geometries
    Geometry form;
  };
  // The flexible geometries at world time t_s whose vertices are not where the last call had them, by index; the first
  // call gives all of them.
  [[nodiscard]] std::vector<MovedGeometry> moved_geometries(double t_s);

 private:
  const Scene& scene_;
  PredefinedMotion motion_;
  std::vector<TransformFields> transforms_;
  std::map<std::uint32_t, SharedArray<Eigen::Vector3f>> points_;  // of the last call, by geometry
};

}  // namespace peerd
