#include "peerd/view/frames/driven_looks.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <span>
#include <utility>

#include "core/animation/network_reader.hpp"
#include "core/vrml/default_values.hpp"

namespace peerd::view {
namespace {

// PredefinedMotion has the same bound: chains of TimeSensors that start each other are stepped through.
constexpr std::size_t kTransitionsMax = std::size_t{1} << 20;

constexpr std::array<std::string_view, 3> kMaterial{"diffuseColor", "emissiveColor", "transparency"};
constexpr std::array<std::string_view, 3> kLight{"color", "intensity", "on"};

std::span<const std::string_view> shown_fields(std::string_view type) {
  if (type == "Material") return kMaterial;
  if (type == "DirectionalLight" || type == "PointLight" || type == "SpotLight") return kLight;
  return {};
}

// How many numbers a value has; 0: its type is none of those that looks have.
std::size_t number_count(animation::FieldType type) {
  using enum animation::FieldType;
  if (type == kBool || type == kFloat) return 1;
  return type == kColor ? 3 : 0;
}

}  // namespace

DrivenLooks::DrivenLooks(const std::shared_ptr<const vrml::Document>& document) : document_(document) {
  if (document_ == nullptr || document_->routes.empty()) return;
  const auto is_shown = [&](const vrml::Route& route) {
    return !shown_fields(document_->nodes[route.to_node].type->name).empty();
  };
  if (std::ranges::none_of(document_->routes, is_shown)) return;
  const vrml::NetworkReadResult reading = vrml::read_network(document_);
  if (!reading.has_sensors) return;
  animation_.emplace(reading.network, animation::AnimationOptions{.max_transitions = kTransitionsMax});
  for (const animation::Field& field : animation_->driven()) {
    const std::uint32_t node = reading.document_node[field.node];
    const auto shown = shown_fields(document_->nodes[node].type->name);
    const auto known = std::ranges::find(shown, field.name);
    if (known == shown.end() || number_count(field.type) == 0) continue;
    looks_.push_back({node, *known, field.id});
  }
  std::ranges::sort(looks_, {}, [](const Look& look) { return std::pair(look.node, look.field); });
}

std::optional<std::uint32_t> DrivenLooks::find(std::uint32_t node, std::string_view field) const {
  const auto at = std::ranges::lower_bound(looks_, std::pair(node, field), {},
                                           [](const Look& look) { return std::pair(look.node, look.field); });
  if (at == looks_.end() || at->node != node || at->field != field) return std::nullopt;
  return static_cast<std::uint32_t>(at - looks_.begin());
}

void DrivenLooks::value(std::uint32_t look, double t_s, std::vector<float>& out) {
  assert(look < looks_.size());
  const Look& asked = looks_[look];
  out.clear();
  if (animation_->value(asked.id, t_s, value_)) {
    const std::size_t count = number_count(value_.type);
    for (std::size_t i = 0; i < count; ++i) out.push_back(static_cast<float>(value_.number[i]));
    return;
  }
  const vrml::Field& given = vrml::value_of(document_->nodes[asked.node], asked.field);
  if (given.spec->type == vrml::FieldType::kSFBool) return out.push_back(given.as<bool>()[0] ? 1.0F : 0.0F);
  const auto floats = given.as<float>();
  out.assign(floats.begin(), floats.end());
}

}  // namespace peerd::view
