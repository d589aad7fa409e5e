#include "core/animation/cell_graph.hpp"

#include <cmath>
#include <utility>

namespace peerd::animation {
namespace {

struct SensorPort {
  std::string_view name;
  CellKind kind;
  std::uint8_t port;
  FieldType type;
};

constexpr std::uint8_t index_of(SensorOutput o) { return static_cast<std::uint8_t>(o); }
constexpr std::uint8_t index_of(SensorInput i) { return static_cast<std::uint8_t>(i); }

// 6.50
constexpr SensorPort kSensorPorts[] = {
    {"isActive", CellKind::kSensorOutput, index_of(SensorOutput::kIsActive), FieldType::kBool},
    {"cycleTime", CellKind::kSensorOutput, index_of(SensorOutput::kCycleTime), FieldType::kTime},
    {"fraction_changed", CellKind::kSensorOutput, index_of(SensorOutput::kFraction), FieldType::kFloat},
    {"time", CellKind::kSensorOutput, index_of(SensorOutput::kTime), FieldType::kTime},
    {"stopTime", CellKind::kSensorInput, index_of(SensorInput::kStopTime), FieldType::kTime},
    {"enabled", CellKind::kSensorInput, index_of(SensorInput::kEnabled), FieldType::kBool},
    {"loop", CellKind::kSensorInput, index_of(SensorInput::kLoop), FieldType::kBool},
    {"cycleInterval", CellKind::kSensorInput, index_of(SensorInput::kCycleInterval), FieldType::kTime},
    {"startTime", CellKind::kSensorInput, index_of(SensorInput::kStartTime), FieldType::kTime},
};

// x, set_x or x_changed
bool means(std::string_view field, std::string_view exposed_field) {
  if (field.starts_with("set_")) return field.substr(4) == exposed_field;
  if (field.ends_with("_changed")) return field.substr(0, field.size() - 8) == exposed_field;
  return field == exposed_field;
}

std::uint64_t field_key(std::uint32_t node, std::uint32_t name) { return std::uint64_t{node} << 32 | name; }

}  // namespace

CellGraph::CellGraph(const Network& network) {
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
      key_cells.push_back({kNone, kNone});
      Interpolator& ours = interpolators.back();
      if (!is_sorted(ours.key.span())) {
        findings.push_back({Problem::kUnsortedKeys, n});
        std::vector<float> sorted(ours.key.begin(), ours.key.end());
        sort_keys(sorted);
        ours.key = std::move(sorted);
      }
      const Keys used = usable(ours.type, keys_of(ours));
      if (used.key.empty()) {
        findings.push_back({Problem::kNoKeys, n});
      } else if (used.key.size() != ours.key.size() || used.key_value.size() != ours.key_value.size()) {
        findings.push_back({Problem::kUnusedKeys, n});
      }
    }
  }
  links.resize(network.routes.size());
  for (std::uint32_t r = 0; r < network.routes.size(); ++r) {
    if (const auto problem = add_route(network, network.routes[r], r)) findings.push_back({*problem, r});
  }
  mark_driven();
  mark_control();
}

std::optional<CellGraph::Port> CellGraph::port_of(std::uint32_t node, std::string_view field, FieldType type) const {
  switch (kind_of_node_[node]) {
    case NodeKind::kPlain:
      return Port{field, CellKind::kRelay, 0, type, true, true, type};
    case NodeKind::kSensor:
      for (const SensorPort& p : kSensorPorts) {
        const bool out = p.kind == CellKind::kSensorOutput;
        if (out ? field == p.name : means(field, p.name))
          return Port{p.name, p.kind, p.port, p.type, !out, true, p.type};
      }
      return std::nullopt;
    case NodeKind::kInterpolator:
      break;
  }
  const InterpolatorType itype = interpolators[index_of_node[node]].type;
  if (field == "set_fraction" || field == "value_changed") {
    return Port{"value_changed", CellKind::kInterpolator, 0, value_type(itype), field[0] == 's',
                field[0] == 'v', FieldType::kFloat};
  }
  if (means(field, "key")) return Port{"key", CellKind::kKey, 0, FieldType::kFloats, true, true, FieldType::kFloats};
  if (means(field, "keyValue")) {
    return Port{"keyValue", CellKind::kKey, 1, key_value_type(itype), true, true, key_value_type(itype)};
  }
  return std::nullopt;
}

std::optional<std::uint32_t> CellGraph::find(std::uint32_t node, std::string_view field) const {
  if (node >= kind_of_node_.size()) return std::nullopt;
  const auto port = port_of(node, field, FieldType::kFloat);
  if (!port) return std::nullopt;
  const auto name = name_ids_.find(std::string(port->name));
  if (name == name_ids_.end()) return std::nullopt;
  const auto cell = cell_of_field_.find(field_key(node, name->second));
  if (cell == cell_of_field_.end()) return std::nullopt;
  return cell->second;
}

std::optional<std::uint32_t> CellGraph::find_or_add(std::uint32_t node, std::string_view field, FieldType type,
                                                    bool in) {
  if (node >= kind_of_node_.size()) return std::nullopt;
  const auto port = port_of(node, field, type);
  if (!port || (in ? !port->in : !port->out)) return std::nullopt;
  const auto [name, new_name] =
      name_ids_.try_emplace(std::string(port->name), static_cast<std::uint32_t>(names.size()));
  if (new_name) names.emplace_back(port->name);
  const auto id = static_cast<std::uint32_t>(cells.size());
  const auto [cell, added] = cell_of_field_.try_emplace(field_key(node, name->second), id);
  if (!added) return cell->second;
  Cell c;
  c.node = node;
  c.name = name->second;
  c.kind = port->kind;
  c.port = port->port;
  c.type = port->type;
  c.control = port->kind == CellKind::kSensorInput;
  cells.push_back(c);
  if (c.kind == CellKind::kSensorOutput) sensor_outputs[index_of_node[node]][c.port] = id;
  if (c.kind == CellKind::kKey) key_cells[index_of_node[node]][c.port] = id;
  return id;
}

std::optional<Problem> CellGraph::add_route(const Network& network, const Route& route, std::uint32_t index) {
  if (route.from_node >= network.nodes.size() || route.to_node >= network.nodes.size()) return Problem::kNoSuchNode;
  const auto from_port = port_of(route.from_node, route.from_field, route.type);
  const auto to_port = port_of(route.to_node, route.to_field, route.type);
  if (!from_port || !from_port->out || !to_port || !to_port->in) return Problem::kNoSuchField;
  if (from_port->type != route.type || to_port->in_type != route.type) return Problem::kTypeMismatch;
  if (to_port->kind == CellKind::kKey) return Problem::kRouteToKeys;
  const std::uint32_t from = *find_or_add(route.from_node, route.from_field, route.type, false);
  const std::uint32_t to = *find_or_add(route.to_node, route.to_field, route.type, true);
  const FieldType takes = cells[to].kind == CellKind::kInterpolator ? FieldType::kFloat : cells[to].type;
  if (cells[from].type != route.type || takes != route.type) return Problem::kTypeMismatch;  // two ROUTEs of one field
  if (!routed_.insert(field_key(from, to)).second) return Problem::kRepeated;
  links[index] = {from, to, cells[to].first_in, cells[from].first_out};
  cells[to].first_in = index;
  cells[from].first_out = index;
  return std::nullopt;
}

void CellGraph::mark_driven() {
  std::vector<std::uint32_t> todo;
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    if (cells[c].kind == CellKind::kSensorOutput) todo.push_back(c);
  }
  while (!todo.empty()) {
    const std::uint32_t c = todo.back();
    todo.pop_back();
    for (std::uint32_t r = cells[c].first_out; r != kNone; r = links[r].next_out) {
      Cell& to = cells[links[r].to];
      if (std::exchange(to.driven, true)) continue;
      todo.push_back(links[r].to);
    }
  }
}

void CellGraph::mark_control() {
  std::vector<std::uint32_t> todo;
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    if (cells[c].control) todo.push_back(c);
  }
  while (!todo.empty()) {
    const std::uint32_t c = todo.back();
    todo.pop_back();
    for (std::uint32_t r = cells[c].first_in; r != kNone; r = links[r].next_in) {
      Cell& from = cells[links[r].from];
      if (from.kind != CellKind::kRelay || std::exchange(from.control, true)) continue;
      todo.push_back(links[r].from);
    }
  }
}

}  // namespace peerd::animation
