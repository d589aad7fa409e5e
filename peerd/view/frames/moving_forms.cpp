#include "peerd/view/frames/moving_forms.hpp"

#include <algorithm>
#include <variant>

namespace peerd::view {
namespace {

template <class Value>
std::optional<std::uint32_t> number_of(const std::vector<Value>& all, const Value& value) {
  const auto at = std::ranges::find(all, value);
  if (at == all.end()) return std::nullopt;
  return static_cast<std::uint32_t>(at - all.begin());
}

}  // namespace

std::optional<std::uint32_t> MovingForms::of_geometry(std::uint32_t geometry) const {
  return number_of(geometries, geometry);
}
std::optional<std::uint32_t> MovingForms::of_shape(ObjectId shape) const { return number_of(shapes, shape); }

MovingForms moving_forms(const Scene& scene, const PredefinedMotion& motion, const Carriers& carriers) {
  MovingForms forms{motion.flexible_geometries(), {}};
  std::ranges::sort(forms.geometries);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (instance.kind != NodeKind::kShape || instance.geometry == Instance::kNone) continue;
    if (const ObjectId id = scene.id_of(i); carriers.distorted(id)) forms.shapes.push_back(id);
  }
  return forms;
}

}  // namespace peerd::view
