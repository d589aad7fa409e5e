#include "core/motion/scene_motion.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace peerd {

SceneMotion::SceneMotion(const Scene& scene) : scene_(scene), motion_(scene), transforms_(scene.transforms) {}

const std::vector<TransformFields>& SceneMotion::transforms_at(double t_s) {
  for (const ObjectId id : motion_.driven_transforms()) {
    transforms_[scene_.at(id).transform] = motion_.transform(id, t_s);
  }
  return transforms_;
}

std::vector<SceneMotion::MovedGeometry> SceneMotion::moved_geometries(double t_s) {
  std::vector<MovedGeometry> moved;
  for (const std::uint32_t geometry : motion_.flexible_geometries()) {
    Geometry form = motion_.geometry(geometry, t_s);
    const auto& points = std::get<FaceSetGeometry>(form).points;
    const auto& [last, is_new] = points_.try_emplace(geometry, points);
    if (!is_new && std::ranges::equal(last->second, points)) continue;
    last->second = points;
    moved.push_back({geometry, std::move(form)});
  }
  return moved;
}

}  // namespace peerd
