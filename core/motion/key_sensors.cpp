#include "core/motion/key_sensors.hpp"

#include <algorithm>
#include <cassert>
#include <map>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/vrml/document.hpp"

namespace peerd {

std::expected<KeyEvent, std::string> key_of(const KeySensor& sensor) {
  KeyEvent key{sensor.key_value, sensor.key_state};
  if (!sensor.key_name.empty()) {
    const auto named = find_held_key(sensor.key_name);
    if (!named) return named;
    key = *named;
  }
  key.is_release = sensor.on_release;
  return canonical(key);
}

KeySensors::KeySensors(const Scene& scene, const KeySensors* before) {
  if (scene.key_sensors.empty()) return;
  std::unordered_map<std::uint32_t, std::size_t> of_node;
  for (const KeySensor& s : scene.key_sensors) {
    of_node.emplace(s.node, sensors_.size());
    const auto key = key_of(s);
    Sensor sensor{scene.document->ids.id_of(s.node),
                  s.enabled,
                  key ? std::optional(*key) : std::nullopt,
                  s.consume,
                  s.enabled,
                  {},
                  {}};
    if (before != nullptr) {
      const auto same = std::ranges::find(before->sensors_, sensor.node, &Sensor::node);
      if (same != before->sensors_.end() && same->enabled_in_file == s.enabled) sensor.enabled = same->enabled;
    }
    sensors_.push_back(std::move(sensor));
  }
  assert(scene.document);
  const auto& routes = scene.document->routes;
  for (std::size_t i = 0; i < routes.size(); ++i) {
    const auto from = of_node.find(routes[i].from_node), to = of_node.find(routes[i].to_node);
    if (from == of_node.end() || to == of_node.end()) continue;  // the reader has warned of it
    Sensor& sensor = sensors_[from->second];
    auto& list = routes[i].from->name == "keyHit" ? sensor.from_hit : sensor.from_enabled;
    list.push_back({to->second, routes[i].to->name == "disable", i});
  }
}

KeySensors::Outcome KeySensors::press(const KeyEvent& key) {
  const KeyEvent pressed = canonical(key);
  Outcome outcome;
  for (std::size_t i = 0; i < sensors_.size() && !outcome.consumed; ++i) {
    const Sensor& sensor = sensors_[i];
    if (!sensor.enabled || sensor.key != pressed) continue;
    outcome.hits.push_back(i);
    outcome.consumed = sensor.consume;
  }
  if (!outcome.hits.empty()) send(outcome.hits);
  return outcome;
}

// The events spread wave by wave: those of a wave have come over the same number of ROUTEs. The time is linear in the
// ROUTEs, since each sensor sets its `enabled` once.
void KeySensors::send(const std::vector<std::size_t>& hits) {
  struct Arrival {
    std::size_t place;
    bool value;
  };
  std::map<std::size_t, Arrival> wave, next;  // indexed by sensor: the event to its `enabled`
  std::unordered_set<std::size_t> taken;
  const auto pass_on = [&](const std::vector<Route>& routes, bool value) {
    for (const Route& route : routes) {
      if (taken.contains(route.to)) continue;
      const Arrival arrival{route.place, value != route.inverts};
      const auto [at, is_new] = next.try_emplace(route.to, arrival);
      if (!is_new && route.place > at->second.place) at->second = arrival;
    }
  };
  for (const std::size_t i : hits) pass_on(sensors_[i].from_hit, true);
  while (!next.empty()) {
    wave = std::exchange(next, {});
    for (const auto& [sensor, arrival] : wave) {
      taken.insert(sensor);
      sensors_[sensor].enabled = arrival.value;
    }
    for (const auto& [sensor, arrival] : wave) pass_on(sensors_[sensor].from_enabled, arrival.value);
  }
}

}  // namespace peerd
