#pragma once
#include <string>
#include <vector>

#include "core/motion/key_codes.hpp"
#include "core/scene/scene.hpp"
#include "peerd/node/describe.hpp"

namespace peerd {

// What became of one press of a key at this peer: nothing of it is silent.
struct KeyReport {
  struct Change {
    std::size_t sensor = 0;  // into Scene::key_sensors
    ObjectId recipient;
    Vec3 velocity_world = Vec3::Zero();  // [m/s] added, or set
    bool absolute = false;
    std::string refused;  // why it was not done; empty: it was
  };
  KeyEvent key;
  std::string refused;          // why no sensor was asked; empty: they were
  std::size_t hits = 0;         // sensors that got it, those without a recipient too
  std::vector<Change> changes;  // in file order
  bool consumed = false;

  // Somebody got it, and all that it should have changed was changed.
  [[nodiscard]] bool done() const;
};

// For messages: a sensor's DEF name, or its place among the world's.
[[nodiscard]] std::string name_of_sensor(const Scene& scene, std::size_t sensor);

// A line for each change, or one where there is none; what was refused is a warning.
[[nodiscard]] std::vector<LogLine> describe(const KeyReport& report, const Scene& scene);

}  // namespace peerd
