#include "peerd/peer/node/key_report.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "core/vrml/document.hpp"

namespace peerd {

bool KeyReport::done() const {
  return refused.empty() && hits > 0 &&
         std::ranges::all_of(changes, [](const Change& change) { return change.refused.empty(); });
}

std::string name_of_sensor(const Scene& scene, std::size_t sensor) {
  const std::string_view def = scene.document->nodes.at(scene.key_sensors.at(sensor).node).def;
  return def.empty() ? fmt::format("KeySensor {}", sensor) : std::string(def);
}

std::vector<LogLine> describe(const KeyReport& report, const Scene& scene) {
  const std::string key = name_of(report.key);
  if (!report.refused.empty()) return {{LogLevel::kWarning, fmt::format("{} does nothing: {}", key, report.refused)}};
  if (report.hits == 0 && report.key.is_release) return {};  // most keys are for their presses alone
  if (report.hits == 0) return {{LogLevel::kInfo, fmt::format("{}: no enabled KeySensor listens to it", key)}};
  std::vector<LogLine> lines;
  for (const KeyReport::Change& c : report.changes) {
    const std::string what = fmt::format("{}: {}", key, name_of_sensor(scene, c.sensor));
    if (!c.refused.empty()) {
      lines.push_back(
          {LogLevel::kWarning, fmt::format("{} does not move {}: {}", what, scene.path_of(c.recipient), c.refused)});
      continue;
    }
    const Vec3& v = c.velocity_world;
    lines.push_back({LogLevel::kInfo, fmt::format("{} {} the velocity of {}{} ({:g}, {:g}, {:g}) m/s", what,
                                                  c.absolute ? "sets" : "changes", scene.path_of(c.recipient),
                                                  c.absolute ? " to" : " by", v.x(), v.y(), v.z())});
  }
  if (lines.empty()) lines.push_back({LogLevel::kInfo, fmt::format("{}: {} KeySensors got it", key, report.hits)});
  return lines;
}

}  // namespace peerd
