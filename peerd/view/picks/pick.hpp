#pragma once
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "peerd/view/frames/picture_input.hpp"

namespace peerd::view {

struct PickHit {
  std::uint32_t node = 0;  // of the picture
  ObjectId object;         // its mover; of what stands, the nearest Transform at or above the Shape, or else the Shape
  ObjectId shape;
  std::uint32_t polygon = 0;
  double distance_m = 0;
  Vec3 position = Vec3::Zero(), normal = Vec3::Zero();  // in the world; the normal points to the ray's side
};

// Rays meet what is drawn, or what collides, such as the proxy of a Collision, be it drawn or not.
enum class Pickable : std::uint8_t { kDrawn, kColliding };

// Finds what a ray hits first among all that it meets, with each mover where place() has put it: the exact ray query of
// the collision floor (collision/scene/scene_query.hpp) on a scene in which each mover stands by itself.
class ScenePicker {
 public:
  explicit ScenePicker(const PictureInput& input, Pickable what = Pickable::kDrawn);
  ~ScenePicker();
  ScenePicker(const ScenePicker&) = delete;
  ScenePicker& operator=(const ScenePicker&) = delete;

  void place(std::uint32_t node, const Pose& pose);
  // The error says what is wrong with the ray, or which Shape cannot be used.
  [[nodiscard]] std::expected<std::optional<PickHit>, std::string> pick(const Vec3& origin, const Vec3& direction);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace peerd::view
