#include "core/animation/event_graph.hpp"

#include <cmath>
#include <utility>

namespace peerd::animation {
namespace {

struct SensorPortName {
  std::string_view name;
  PortKind kind;
  std::uint8_t slot;
  FieldType type;
};

constexpr std::uint8_t index_of(SensorOutput o) { return static_cast<std::uint8_t>(o); }
constexpr std::uint8_t index_of(SensorInput i) { return static_cast<std::uint8_t>(i); }

// 6.50
constexpr SensorPortName kSensorPorts[] = {
    {"isActive", PortKind::kSensorOutput, index_of(SensorOutput::kIsActive), FieldType::kBool},
    {"cycleTime", PortKind::kSensorOutput, index_of(SensorOutput::kCycleTime), FieldType::kTime},
    {"fraction_changed", PortKind::kSensorOutput, index_of(SensorOutput::kFraction), FieldType::kFloat},
    {"time", PortKind::kSensorOutput, index_of(SensorOutput::kTime), FieldType::kTime},
    {"stopTime", PortKind::kSensorInput, index_of(SensorInput::kStopTime), FieldType::kTime},
    {"enabled", PortKind::kSensorInput, index_of(SensorInput::kEnabled), FieldType::kBool},
    {"loop", PortKind::kSensorInput, index_of(SensorInput::kLoop), FieldType::kBool},
    {"cycleInterval", PortKind::kSensorInput, index_of(SensorInput::kCycleInterval), FieldType::kTime},
    {"startTime", PortKind::kSensorInput, index_of(SensorInput::kStartTime), FieldType::kTime},
};

// A field x is also written set_x or x_changed.
bool names_field(std::string_view field, std::string_view exposed_field) {
  if (field.starts_with("set_")) return field.substr(4) == exposed_field;
  if (field.ends_with("_changed")) return field.substr(0, field.size() - 8) == exposed_field;
  return field == exposed_field;
}

std::uint64_t field_key(std::uint32_t node, std::uint32_t name) { return std::uint64_t{node} << 32 | name; }

}  // namespace

EventGraph::EventGraph(const Network& network) {
  const auto count = static_cast<std::uint32_t>(network.nodes.size());
  index_of_node.assign(count, kNone);
  kind_of_node_.assign(count, NodeKind::kPlain);
  for (std::uint32_t n = 0; n < count; ++n) {
    if (const auto* sensor = std::get_if<TimeSensorFields>(&network.nodes[n])) {
      kind_of_node_[n] = NodeKind::kSensor;
      index_of_node[n] = static_cast<std::uint32_t>(sensor_node.size());
      sensor_node.push_back(n);
      sensor_outputs.push_back({kNone, kNone, kNone, kNone});
      if (!(sensor->cycle_interval > 0.0) || !std::isfinite(sensor->cycle_interval) ||
          !std::isfinite(sensor->start_time) || !std::isfinite(sensor->stop_time)) {
        findings.push_back({Problem::kBadTimeSensor, n});
      } else if (sensor->cycle_interval < kShortestCycle_s) {
        findings.push_back({Problem::kShortCycleInterval, n});
      }
    } else if (const auto* interpolator = std::get_if<Interpolator>(&network.nodes[n])) {
      kind_of_node_[n] = NodeKind::kInterpolator;
      index_of_node[n] = static_cast<std::uint32_t>(interpolators.size());
      interpolators.push_back(*interpolator);
      key_ports.push_back({kNone, kNone});
      Interpolator& copy = interpolators.back();
      if (!is_sorted(copy.key.span())) {
        findings.push_back({Problem::kUnsortedKeys, n});
        std::vector<float> sorted(copy.key.begin(), copy.key.end());
        sort_keys(sorted);
        copy.key = std::move(sorted);
      }
      const Keys used = usable(copy.type, keys_of(copy));
      if (used.key.empty()) {
        findings.push_back({Problem::kNoKeys, n});
      } else if (used.key.size() != copy.key.size() || used.key_value.size() != copy.key_value.size()) {
        findings.push_back({Problem::kUnusedKeys, n});
      }
    }
  }
  links.resize(network.routes.size());
  for (std::uint32_t r = 0; r < network.routes.size(); ++r) {
    if (const auto problem = add_route(network, network.routes[r], r)) findings.push_back({*problem, r});
  }
  mark_driven();
  mark_sensor_inputs();
}

std::optional<EventGraph::PortSpec> EventGraph::port_spec_of(std::uint32_t node, std::string_view field,
                                                             FieldType type) const {
  switch (kind_of_node_[node]) {
    case NodeKind::kPlain:
      return PortSpec{field, PortKind::kRelay, 0, type, true, true, type};
    case NodeKind::kSensor:
      for (const SensorPortName& p : kSensorPorts) {
        const bool out = p.kind == PortKind::kSensorOutput;
        if (out ? field == p.name : names_field(field, p.name))
          return PortSpec{p.name, p.kind, p.slot, p.type, !out, true, p.type};
      }
      return std::nullopt;
    case NodeKind::kInterpolator:
      break;
  }
  const InterpolatorType itype = interpolators[index_of_node[node]].type;
  if (field == "set_fraction" || field == "value_changed") {
    return PortSpec{"value_changed", PortKind::kInterpolator, 0, value_type(itype), field[0] == 's',
                    field[0] == 'v', FieldType::kFloat};
  }
  if (names_field(field, "key"))
    return PortSpec{"key", PortKind::kKey, 0, FieldType::kFloats, true, true, FieldType::kFloats};
  if (names_field(field, "keyValue")) {
    return PortSpec{"keyValue", PortKind::kKey, 1, key_value_type(itype), true, true, key_value_type(itype)};
  }
  return std::nullopt;
}

std::optional<std::uint32_t> EventGraph::find(std::uint32_t node, std::string_view field) const {
  if (node >= kind_of_node_.size()) return std::nullopt;
  const auto slot = port_spec_of(node, field, FieldType::kFloat);
  if (!slot) return std::nullopt;
  const auto name = name_ids_.find(std::string(slot->name));
  if (name == name_ids_.end()) return std::nullopt;
  const auto port = port_of_field_.find(field_key(node, name->second));
  if (port == port_of_field_.end()) return std::nullopt;
  return port->second;
}

std::optional<std::uint32_t> EventGraph::find_or_add(std::uint32_t node, std::string_view field, FieldType type,
                                                     bool in) {
  if (node >= kind_of_node_.size()) return std::nullopt;
  const auto slot = port_spec_of(node, field, type);
  if (!slot || (in ? !slot->in : !slot->out)) return std::nullopt;
  const auto [name, new_name] =
      name_ids_.try_emplace(std::string(slot->name), static_cast<std::uint32_t>(names.size()));
  if (new_name) names.emplace_back(slot->name);
  const auto id = static_cast<std::uint32_t>(ports.size());
  const auto [port, added] = port_of_field_.try_emplace(field_key(node, name->second), id);
  if (!added) return port->second;
  EventPort c;
  c.node = node;
  c.name = name->second;
  c.kind = slot->kind;
  c.slot = slot->slot;
  c.type = slot->type;
  c.feeds_sensor = slot->kind == PortKind::kSensorInput;
  ports.push_back(c);
  if (c.kind == PortKind::kSensorOutput) sensor_outputs[index_of_node[node]][c.slot] = id;
  if (c.kind == PortKind::kKey) key_ports[index_of_node[node]][c.slot] = id;
  return id;
}

std::optional<Problem> EventGraph::add_route(const Network& network, const Route& route, std::uint32_t index) {
  if (route.from_node >= network.nodes.size() || route.to_node >= network.nodes.size()) return Problem::kNoSuchNode;
  const auto from_port = port_spec_of(route.from_node, route.from_field, route.type);
  const auto to_port = port_spec_of(route.to_node, route.to_field, route.type);
  if (!from_port || !from_port->out || !to_port || !to_port->in) return Problem::kNoSuchField;
  if (from_port->type != route.type || to_port->in_type != route.type) return Problem::kTypeMismatch;
  if (to_port->kind == PortKind::kKey) return Problem::kRouteToKeys;
  const std::uint32_t from = *find_or_add(route.from_node, route.from_field, route.type, false);
  const std::uint32_t to = *find_or_add(route.to_node, route.to_field, route.type, true);
  const FieldType takes = ports[to].kind == PortKind::kInterpolator ? FieldType::kFloat : ports[to].type;
  if (ports[from].type != route.type || takes != route.type) return Problem::kTypeMismatch;  // two ROUTEs of one field
  if (!routed_.insert(field_key(from, to)).second) return Problem::kRepeated;
  links[index] = {from, to, ports[to].first_in, ports[from].first_out};
  ports[to].first_in = index;
  ports[from].first_out = index;
  return std::nullopt;
}

void EventGraph::mark_driven() {
  std::vector<std::uint32_t> todo;
  for (std::uint32_t c = 0; c < ports.size(); ++c) {
    if (ports[c].kind == PortKind::kSensorOutput) todo.push_back(c);
  }
  while (!todo.empty()) {
    const std::uint32_t c = todo.back();
    todo.pop_back();
    for (std::uint32_t r = ports[c].first_out; r != kNone; r = links[r].next_out) {
      EventPort& to = ports[links[r].to];
      if (std::exchange(to.driven, true)) continue;
      todo.push_back(links[r].to);
    }
  }
}

void EventGraph::mark_sensor_inputs() {
  std::vector<std::uint32_t> todo;
  for (std::uint32_t c = 0; c < ports.size(); ++c) {
    if (ports[c].feeds_sensor) todo.push_back(c);
  }
  while (!todo.empty()) {
    const std::uint32_t c = todo.back();
    todo.pop_back();
    for (std::uint32_t r = ports[c].first_in; r != kNone; r = links[r].next_in) {
      EventPort& from = ports[links[r].from];
      if (from.kind != PortKind::kRelay || std::exchange(from.feeds_sensor, true)) continue;
      todo.push_back(links[r].from);
    }
  }
}

}  // namespace peerd::animation
