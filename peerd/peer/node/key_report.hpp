#pragma once
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "core/motion/key_codes.hpp"
#include "core/scene/scene.hpp"
#include "peerd/peer/node/log_line.hpp"

namespace peerd {

// The effect of one key press at this peer: every refusal carries its reason.
struct KeyReport {
  struct Change {
    std::size_t sensor = 0;  // index into Scene::key_sensors
    ObjectId recipient;
    Vec3 velocity_world = Vec3::Zero();  // [m/s] added, or set
    bool absolute = false;               // the velocity was set
    std::string refused;                 // why it was not changed; empty: it was
  };
  KeyEvent key;
  std::string refused;          // why no sensor got the key; empty: they could
  std::size_t hits = 0;         // sensors that got the key, those without a recipient included
  std::vector<Change> changes;  // in file order
  bool consumed = false;

  // Whether at least one sensor got the key and every change was made.
  [[nodiscard]] bool done() const;
};

// A sensor's DEF name, or its index among the world's sensors, for messages.
[[nodiscard]] std::string name_of_sensor(const Scene& scene, std::size_t sensor);

// One line for each change, or a single one where there is none; refusals are warnings.
[[nodiscard]] std::vector<LogLine> describe(const KeyReport& report, const Scene& scene);

}  // namespace peerd
