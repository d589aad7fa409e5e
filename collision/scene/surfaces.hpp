#pragma once
#include <cassert>
#include <cstdint>

#include "core/scene/scene.hpp"

namespace peerd::collision {

// The two sets of Shapes that questions are about: those that collide (thesis, appendix C: `collide`, `proxy`) and
// those that are drawn. Most Shapes are in both; a proxy only collides, and the geometry that it stands for is only
// drawn.
enum class Surfaces : std::uint8_t { kColliding, kDrawn };

// Whether an instance is a Shape of that set.
[[nodiscard]] inline bool is_surface(const Scene& scene, std::uint32_t instance, Surfaces which) {
  assert(instance < scene.instances.size());
  const Instance& i = scene.instances[instance];
  return i.geometry != Instance::kNone && (which == Surfaces::kDrawn ? i.drawn : i.collides);
}

}  // namespace peerd::collision
