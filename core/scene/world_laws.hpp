#pragma once
#include <optional>

#include "core/math.hpp"
#include "core/vrml/document.hpp"

namespace peerd {

// The laws that a world's file gives to all objects that physics moves.
struct WorldLaws {
  Vec3 gravity = Vec3::Zero();           // [m/s^2], world frame
  std::optional<double> return_below{};  // [m], y in the world frame: an object below it begins anew; none: nowhere
};

// The laws of the first WorldInfo that has each of them. Linear in the nodes.
[[nodiscard]] WorldLaws world_laws(const vrml::Document& document);

}  // namespace peerd
