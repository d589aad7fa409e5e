#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/math.hpp"
#include "peerd/view/picture/drawn_scene.hpp"

namespace peerd::recorded {

// Messages of Foxglove's well-known schemas as JSON (docs.foxglove.dev, "Message schemas"): a reader knows them by the
// schema's name. Times are in seconds.

inline constexpr const char* kFrameTransforms = "foxglove.FrameTransforms";
inline constexpr const char* kSceneUpdate = "foxglove.SceneUpdate";
// The JSON Schema of each, as far as its messages here go.
[[nodiscard]] std::string frame_transforms_schema();
[[nodiscard]] std::string scene_update_schema();

struct Transform {
  std::string parent, child;
  Pose pose;
};
[[nodiscard]] std::string frame_transforms(double t_s, const std::vector<Transform>& transforms);

// The shapes of a scene: an entity for each node, which goes with the frame `prefix` + its path; what stands is in the
// frame `world`. What `before` names and the scene has no more is deleted; `before` is what it names then.
[[nodiscard]] std::string scene_update(double t_s, const view::ScenePicture& scene, const std::string& prefix,
                                       const std::string& world, std::vector<std::string>& before);

struct ContactMark {
  std::string id, sentence;
  Vec3 position, normal;  // in the world
};
// An arrow along the normal, and the sentence beside it, for three seconds.
[[nodiscard]] std::string contact_mark(double t_s, const ContactMark& mark, const std::string& world);

}  // namespace peerd::recorded
