#include "peerd/view/picks/page_sensor.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <span>

#include "core/motion/sensor_events.hpp"
#include "core/vrml/default_values.hpp"
#include "peerd/peer/node/edit_operation.hpp"

namespace peerd::view {
namespace {

struct NumberField {
  std::string_view field, name;
};
struct Kind {
  std::string_view type;
  SensorKind kind;
  std::span<const NumberField> numbers;
};

constexpr std::array<NumberField, 3> kPlaneNumbers{
    {{"minPosition", "min"}, {"maxPosition", "max"}, {"offset", "offset"}}};
constexpr std::array<NumberField, 4> kCylinderNumbers{
    {{"diskAngle", "disk_angle_rad"}, {"minAngle", "min"}, {"maxAngle", "max"}, {"offset", "offset"}}};
constexpr std::array<NumberField, 1> kSphereNumbers{{{"offset", "offset"}}};
constexpr std::array<NumberField, 2> kProximityNumbers{{{"center", "center"}, {"size", "size"}}};

constexpr std::array<Kind, 5> kKinds{{
    {"TouchSensor", SensorKind::kTouch, {}},
    {"PlaneSensor", SensorKind::kPlane, kPlaneNumbers},
    {"CylinderSensor", SensorKind::kCylinder, kCylinderNumbers},
    {"SphereSensor", SensorKind::kSphere, kSphereNumbers},
    {"ProximitySensor", SensorKind::kProximity, kProximityNumbers},
}};

const Kind* kind_of(std::string_view type) {
  const auto found = std::ranges::find(kKinds, type, &Kind::type);
  return found == kKinds.end() ? nullptr : &*found;
}

// The path or DEF name by which edits know a node of the document; empty: they know it by none.
std::string name_for_edits(const Scene& scene, std::uint32_t node) {
  const vrml::Document& document = *scene.document;
  const auto known = [&](const std::string& name) {
    const auto found = find_node(scene, name);
    return found && *found == document.ids.id_of(node);
  };
  if (std::string def(document.nodes[node].def); !def.empty() && known(def)) return def;
  const auto at = std::ranges::find(scene.instances, node, &Instance::node);
  if (at == scene.instances.end()) return {};
  std::string path = scene.path_of(scene.id_of(static_cast<std::uint32_t>(at - scene.instances.begin())));
  return known(path) ? path : std::string();
}

}  // namespace

bool is_page_sensor(std::string_view type) { return kind_of(type) != nullptr; }

SensorReading read_sensor(const Scene& scene, std::uint32_t node) {
  const vrml::Document& document = *scene.document;
  const vrml::Node& from = document.nodes[node];
  const Kind* const kind = kind_of(from.type->name);
  assert(kind != nullptr);
  SensorReading reading;
  PageSensor& sensor = reading.sensor;
  sensor.kind = kind->kind;
  sensor.type = kind->type;
  sensor.node = node;
  sensor.enabled = vrml::value_of(from, "enabled").as<bool>()[0];
  const std::string_view mover = sensor.kind == SensorKind::kProximity ? "viewer" : "pointer";
  const auto events = events_by_people(from.type->name);
  for (const vrml::Route& route : document.routes) {
    if (route.from_node != node || route.from == nullptr || route.to == nullptr) continue;
    const std::string event(route.from->name);
    if (std::ranges::find(events, event) == events.end()) {
      reading.left_out.push_back("its " + event + " would be an edit for each movement of the " + std::string(mover));
      continue;
    }
    std::string target =
        route.to->access == vrml::Access::kExposedField ? name_for_edits(scene, route.to_node) : std::string();
    if (target.empty()) {
      reading.left_out.push_back("its " + event + " leads to what no edit can set");
      continue;
    }
    sensor.targets.push_back({event, std::move(target), std::string(route.to->name), route.to_node});
    reading.worked.push_back(&route);
  }
  for (const auto& [field, name] : kind->numbers) {
    const auto given = vrml::value_of(from, field).as<float>();
    sensor.numbers.emplace_back(name, std::vector<float>(given.begin(), given.end()));
  }
  if (vrml::find_field(*from.type, "autoOffset") == nullptr) return reading;
  sensor.auto_offset = vrml::value_of(from, "autoOffset").as<bool>()[0];
  // The offset is where the last drag ended, whoever dragged.
  if (sensor.targets.empty() || !sensor.auto_offset) return reading;
  if (std::string self = name_for_edits(scene, node); !self.empty()) {
    sensor.targets.push_back({"offset", std::move(self), "offset", node});
  }
  return reading;
}

}  // namespace peerd::view
