#include "core/animation/file_times.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/animation/network_reader.hpp"
#include "core/vrml/default_values.hpp"

namespace peerd::animation {
namespace {

bool is_past(double t) { return t < kPastBelow_s; }

// The first run from the world's beginning on; nothing where the sensor stays idle.
struct Run {
  double begin_s, end_s, cycle_s;  // cycle_s: when the cycle began that begin_s is in
  friend bool operator==(const Run&, const Run&) = default;
};
std::optional<Run> first_run(TimeSensorFields fields) {
  fields.enabled = true;
  TimeSensorState state = read_sensor(fields, 0.0);
  const double begin_s = starts(state, 0.0) ? 0.0 : next_transition(state, 0.0);
  if (begin_s == kInfinity || !starts(state, begin_s)) return std::nullopt;
  start(state, begin_s);
  return Run{begin_s, state.end_s, cycle_start(state.fields, begin_s)};
}

}  // namespace

TimeSensorFields in_world_time(const TimeSensorFields& file) {
  TimeSensorFields world = file;
  if (is_past(file.start_time) && is_past(file.stop_time) && file.stop_time > file.start_time) {
    if (file.stop_time <= 0.0) return world;  // over in world time, too
    world.start_time = file.start_time - file.stop_time;
    world.stop_time = 0.0;
    return world;
  }
  if (is_past(file.start_time)) world.start_time = 0.0;
  if (is_past(file.stop_time)) world.stop_time = std::min(file.stop_time, 0.0);
  return world;
}

bool runs_alike(const TimeSensorFields& a, const TimeSensorFields& b) { return first_run(a) == first_run(b); }

}  // namespace peerd::animation

namespace peerd::vrml {
namespace {

using animation::TimeSensorFields;

bool is_sensor(const Node& node) { return node.type->name == "TimeSensor"; }

// Returns whether the values say when: an error in the text may have left a field without one.
bool has_times(const Node& node) {
  return std::ranges::all_of(std::array{"startTime", "stopTime", "cycleInterval", "loop", "enabled"},
                             [&](const char* field) { return value_of(node, field).count == 1; });
}

bool same_times(const TimeSensorFields& a, const TimeSensorFields& b) {
  return a.start_time == b.start_time && a.stop_time == b.stop_time;
}

// Sets two times of a node, whose other fields stay as they are.
void set_times(Document& document, Node& node, const TimeSensorFields& times) {
  std::vector<Field> fields(node.given().begin(), node.given().end());
  const auto set = [&](std::string_view name, double time) {
    Field field = value_of(node, name);
    if (field.as<double>()[0] == time) return;
    field.data = document.arena.copy(std::span<const double>(&time, 1)).data();
    const auto given = std::ranges::find_if(fields, [&](const Field& f) { return same_name(f.spec->name, name); });
    if (given != fields.end()) {
      *given = field;
    } else {
      field.at = node.at;
      fields.push_back(field);
    }
  };
  set("startTime", times.start_time);
  set("stopTime", times.stop_time);
  node.fields = document.arena.copy(std::span<const Field>(fields)).data();
  node.field_count = static_cast<std::uint32_t>(fields.size());
}

// The nodes that events of a sensor reach, but for sensors and interpolators.
class DrivenNodes {
 public:
  explicit DrivenNodes(const Document& document) : document_(document) {
    for (const Route& route : document.routes) {
      next_[route.from_node].push_back(route.to_node);
      takes_events_.insert(route.to_node);
    }
  }

  [[nodiscard]] bool takes_events(std::uint32_t node) const { return takes_events_.contains(node); }

  // Returns their names, or their types where they have none; each once, in the order of the file.
  [[nodiscard]] std::vector<std::string> of(std::uint32_t sensor) const {
    std::set<std::uint32_t> reached{sensor};
    std::vector<std::uint32_t> open{sensor};
    while (!open.empty()) {
      const auto routes = next_.find(open.back());
      open.pop_back();
      if (routes == next_.end()) continue;
      for (const std::uint32_t to : routes->second) {
        if (reached.insert(to).second) open.push_back(to);
      }
    }
    std::vector<std::string> names;
    for (const std::uint32_t index : reached) {
      const Node& node = document_.nodes[index];
      if (is_sensor(node) || node.type->name.ends_with("Interpolator")) continue;
      std::string name(node.def.empty() ? "a " + std::string(node.type->name) : std::string(node.def));
      if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
    }
    return names;
  }

 private:
  const Document& document_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> next_;
  std::set<std::uint32_t> takes_events_;
};

std::string joined(const std::vector<std::string>& names) {
  constexpr std::size_t kNamesMax = 64;
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i == kNamesMax) return all + " and " + std::to_string(names.size() - i) + " more";
    all += i == 0 ? "" : i + 1 == names.size() ? " and " : ", ";
    all += names[i];
  }
  return all;
}

std::string digits_of(double time_s) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), time_s).ptr};
}

std::string warning_of(const TimeSensorFields& file, const TimeSensorFields& world,
                       const std::vector<std::string>& driven) {
  const bool by_stop = world.stop_time > world.start_time && world.stop_time < animation::kPastBelow_s;
  const bool runs = file.loop && !by_stop;
  return (by_stop ? "stopTime " + digits_of(file.stop_time) : "startTime " + digits_of(file.start_time)) +
         " counts from 1970 and is past when the world begins: this TimeSensor " +
         (runs ? "runs from the beginning as with startTime 0, and so moves "
               : "does not run by itself, and does not move ") +
         joined(driven) + "; WorldInfo { worldTimes TRUE } lets it count from the beginning";
}

}  // namespace

bool has_world_times(const Document& document) {
  return std::ranges::any_of(document.nodes, [](const Node& node) {
    if (node.type->name != "WorldInfo") return false;
    const Field& value = value_of(node, "worldTimes");
    return value.count == 1 && value.as<bool>()[0];
  });
}

bool needs_world_times(const Document& document) {
  return std::ranges::any_of(document.nodes, [](const Node& node) {
    if (!is_sensor(node) || !has_times(node)) return false;
    const TimeSensorFields times = sensor_fields_of(node);
    return !same_times(animation::in_world_time(times), times);
  });
}

void count_from_1970(Document& document, Problems& problems) {
  if (!needs_world_times(document) || has_world_times(document)) return;
  const DrivenNodes driven(document);
  for (std::uint32_t i = 0; i < document.nodes.size(); ++i) {
    Node& node = document.nodes[i];
    if (!is_sensor(node) || !has_times(node)) continue;
    const TimeSensorFields file = sensor_fields_of(node), world = animation::in_world_time(file);
    if (same_times(file, world)) continue;
    set_times(document, node, world);
    if (animation::runs_alike(file, world) || (!file.enabled && !driven.takes_events(i))) continue;
    if (const auto names = driven.of(i); !names.empty()) problems.warning(node.at, warning_of(file, world, names));
  }
}

}  // namespace peerd::vrml
