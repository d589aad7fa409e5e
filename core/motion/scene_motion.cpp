#include "core/motion/scene_motion.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace peerd {

SceneMotion::SceneMotion(const Scene& scene) : scene_(scene), motion_(scene), transforms_(scene.transforms) {}

const std::vector<TransformFields>& SceneMotion::transforms_at(double t_s) {
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    if (scene_.instances[i].transform == Instance::kNone) continue;
    TransformFields& fields = transforms_[scene_.instances[i].transform];
    fields.translation = scene_.transform({i}).translation + scene_.object({i}).velocity * t_s;
  }
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
