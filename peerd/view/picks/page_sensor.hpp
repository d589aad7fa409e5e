#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/vrml/document.hpp"

namespace peerd::view {

enum class SensorKind : std::uint8_t { kTouch, kPlane, kCylinder, kSphere, kProximity };

// A PageSensor is a sensor of VRML97 that a viewer's page works. What its events do to the world are edits of the
// fields to which its ROUTEs lead: so they take effect at one instant for all peers. That needs fields that keep their
// values, and events that are few, because each edit stays in the log.
struct PageSensor {
  struct Target {
    std::string event;        // the sensor's eventOut; "offset": what autoOffset keeps
    std::string path, field;  // of the node: its path, or its DEF name
    std::uint32_t node = 0;   // into Document::nodes
  };

  SensorKind kind = SensorKind::kTouch;
  std::string_view type;   // the name of the node's type
  std::uint32_t node = 0;  // into Document::nodes
  std::vector<Target> targets;
  // The sensor's own fields that are numbers, each by the name that a page knows it by.
  std::vector<std::pair<std::string_view, std::vector<float>>> numbers;
  bool auto_offset = false;  // of those that are dragged
  bool enabled = true;
};

struct SensorReading {
  PageSensor sensor;
  std::vector<const vrml::Route*> worked;  // the ROUTEs that lead to its targets
  std::vector<std::string> left_out;       // why others do nothing, a few words each
};

// Whether nodes of that type are sensors that a page works.
[[nodiscard]] bool is_page_sensor(std::string_view type);
// Reads such a node of the scene's document.
[[nodiscard]] SensorReading read_sensor(const Scene& scene, std::uint32_t node);

}  // namespace peerd::view
