#include "core/animation/network_reader.hpp"

#include <cassert>
#include <map>
#include <optional>

#include "core/animation/animation.hpp"
#include "core/vrml/default_values.hpp"

namespace peerd::vrml {
namespace {

// Returns the type of the animation field; nothing for types that predefined movement does not have.
std::optional<animation::FieldType> moving_type(FieldType type) {
  using animation::FieldType;
  switch (type) {
    case vrml::FieldType::kSFBool:
      return FieldType::kBool;
    case vrml::FieldType::kSFInt32:
      return FieldType::kInt32;
    case vrml::FieldType::kSFFloat:
      return FieldType::kFloat;
    case vrml::FieldType::kSFTime:
      return FieldType::kTime;
    case vrml::FieldType::kSFColor:
      return FieldType::kColor;
    case vrml::FieldType::kSFVec2f:
      return FieldType::kVec2;
    case vrml::FieldType::kSFVec3f:
      return FieldType::kVec3;
    case vrml::FieldType::kSFRotation:
      return FieldType::kRotation;
    case vrml::FieldType::kMFFloat:
      return FieldType::kFloats;
    case vrml::FieldType::kMFColor:
      return FieldType::kColors;
    case vrml::FieldType::kMFVec2f:
      return FieldType::kVec2s;
    case vrml::FieldType::kMFVec3f:
      return FieldType::kVec3s;
    case vrml::FieldType::kMFRotation:
      return FieldType::kRotations;
    default:
      return std::nullopt;
  }
}

std::optional<animation::InterpolatorType> interpolator_type(std::string_view name) {
  using enum animation::InterpolatorType;
  if (name == "ColorInterpolator") return kColor;
  if (name == "CoordinateInterpolator") return kCoordinate;
  if (name == "NormalInterpolator") return kNormal;
  if (name == "OrientationInterpolator") return kOrientation;
  if (name == "PositionInterpolator") return kPosition;
  if (name == "ScalarInterpolator") return kScalar;
  return std::nullopt;
}

animation::Node read_node(const std::shared_ptr<const Document>& document, const Node& node) {
  const auto floats = [&](std::string_view field) {
    return SharedArray<float>(document, value_of(node, field).as<float>());
  };
  if (node.type->name == "TimeSensor") return sensor_fields_of(node);
  if (const auto type = interpolator_type(node.type->name)) {
    return animation::Interpolator{*type, floats("key"), floats("keyValue")};
  }
  return animation::PlainNode{};
}

}  // namespace

animation::TimeSensorFields sensor_fields_of(const Node& node) {
  const auto time = [&](std::string_view field) { return value_of(node, field).as<double>()[0]; };
  const auto flag = [&](std::string_view field) { return value_of(node, field).as<bool>()[0]; };
  return {.cycle_interval = time("cycleInterval"),
          .enabled = flag("enabled"),
          .loop = flag("loop"),
          .start_time = time("startTime"),
          .stop_time = time("stopTime")};
}

NetworkReadResult read_network(const std::shared_ptr<const Document>& document) {
  NetworkReadResult reading;
  std::map<std::uint32_t, std::uint32_t> place;  // places of the document's nodes in the network
  const auto node = [&](std::uint32_t index) {
    const auto [it, is_new] = place.try_emplace(index, static_cast<std::uint32_t>(reading.network.nodes.size()));
    if (is_new) {
      reading.network.nodes.push_back(read_node(document, document->nodes[index]));
      reading.document_node.push_back(index);
      reading.has_sensors |= std::holds_alternative<animation::TimeSensorFields>(reading.network.nodes.back());
    }
    return it->second;
  };
  for (const Route& route : document->routes) {
    const auto type = moving_type(route.from->type);
    if (!type) continue;  // strings, nodes, images: nothing that moves by itself sends them
    reading.network.routes.push_back({.from_node = node(route.from_node),
                                      .from_field = std::string(route.from->name),
                                      .to_node = node(route.to_node),
                                      .to_field = std::string(route.to->name),
                                      .type = *type});
    reading.routes_at.push_back(route.at);
  }
  return reading;
}

void check_network(const std::shared_ptr<const Document>& document, Problems& problems) {
  if (document->routes.empty()) return;
  const NetworkReadResult reading = read_network(document);
  if (!reading.has_sensors) return;
  const animation::Animation animation(reading.network);
  for (const animation::Finding& finding : animation.findings()) {
    const auto at_route = [&](const char* what) { problems.warning(reading.routes_at[finding.index], what); };
    const auto at_node = [&](const char* what) {
      const Node& node = document->nodes[reading.document_node[finding.index]];
      problems.warning(node.at, "this " + std::string(node.type->name) + what);
    };
    using enum animation::Problem;
    switch (finding.problem) {
      case kNoSuchNode:
      case kNoSuchField:
      case kTypeMismatch:
        assert(false && "the parser lets no such ROUTE through");
        break;
      case kRouteToKeys:
        at_route("a ROUTE into the keys of an interpolator is not followed");
        break;
      case kRepeated:
        at_route("this ROUTE is there already; it counts once");
        break;
      case kUnsortedKeys:
        at_node(" has keys out of order: each counts as the greatest up to it");
        break;
      case kNoKeys:
        at_node(" has no keys: it sends nothing");
        break;
      case kUnusedKeys:
        at_node(" has keys without a keyValue, or keyValues without a key; they are not used");
        break;
      case kBadTimeSensor:
        at_node(" has a time that cannot be; it counts as the default");
        break;
      case kShortCycleInterval:
        at_node(" has a cycleInterval below 1/1024 s; it counts as that");
        break;
    }
  }
}

}  // namespace peerd::vrml
