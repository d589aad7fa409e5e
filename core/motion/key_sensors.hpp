#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "core/motion/key_codes.hpp"
#include "core/scene/scene.hpp"

namespace peerd {

// KeySensors finds the KeySensors of a world that receive a key (the thesis, C.3). Its state belongs to one peer: a key
// is pressed at one peer, and no other peer needs to know which of its sensors are enabled. Only the effect of a sensor
// on its recipient is shared, as movement.
//
//   key ──> sensor ──> sensor ──> sensor ──> application       asked in file order; one with `consume` ends the row
//             │keyHit                                          a sensor that gets the key sends keyHit TRUE
//             └──ROUTE──> enabled, disable of other sensors ──ROUTE──> ..
//
// The sensors that get a key are chosen before any event that the key causes, as if all sensors looked at the keyboard
// at once: two sensors on one key that enable each other take turns. The events of a key have one timestamp, by the
// rules of animation/animation.hpp: `enabled` of each sensor takes one event and sends one; of several events the one
// counts that came over the fewest ROUTEs, and of those the one whose ROUTE is last in the file.
//
// `disable` TRUE is `enabled` FALSE, and `disable` FALSE is `enabled` TRUE. So the enabled_changed of one sensor,
// ROUTEd to `disable` of another, makes the other its opposite. A disabled sensor gets no key, so it consumes none.
class KeySensors {
 public:
  // Keeps no reference to the scene. `before`: the sensors of the scene before an edit; those whose fields say what
  // they said stay as they are.
  explicit KeySensors(const Scene& scene, const KeySensors* before = nullptr);

  struct Outcome {
    std::vector<std::size_t> hits;  // indices into Scene::key_sensors, in file order
    bool consumed = false;          // the application does not get it
  };
  // Presses or releases the key: each sensor works at one of the two. A key that repeats is pressed again each time.
  Outcome press(const KeyEvent& key);

  [[nodiscard]] bool enabled(std::size_t sensor) const { return sensors_[sensor].enabled; }

 private:
  struct Route {
    std::size_t to = 0;     // a sensor
    bool inverts = false;   // to its disable, else to its enabled
    std::size_t place = 0;  // among the file's ROUTEs
  };
  struct Sensor {
    NodeId node;
    bool enabled_in_file = true;
    std::optional<KeyEvent> key;  // canonical; none: it has a name that no key has
    bool consume = true, enabled = true;
    std::vector<Route> from_hit, from_enabled;
  };
  void send(const std::vector<std::size_t>& hits);

  std::vector<Sensor> sensors_;
};

// Returns the key of a sensor, in canonical form. The error is a sentence about its name.
[[nodiscard]] std::expected<KeyEvent, std::string> key_of(const KeySensor& sensor);

}  // namespace peerd
