#include "core/scene/world_laws.hpp"

#include <optional>

namespace peerd {

WorldLaws world_laws(const vrml::Document& document) {
  std::optional<Vec3> gravity;
  std::optional<double> return_below;
  for (const vrml::Node& node : document.nodes) {
    if (node.type->name != "WorldInfo") continue;
    if (const vrml::Field* const given = node.find("gravity"); given != nullptr && !gravity) {
      const auto g = given->as<float>();
      gravity = Vec3(g[0], g[1], g[2]);
    }
    if (const vrml::Field* const given = node.find("returnBelow"); given != nullptr && !return_below) {
      return_below = given->as<float>()[0];
    }
  }
  return {gravity.value_or(Vec3(Vec3::Zero())), return_below};
}

}  // namespace peerd
