#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/motion/key_codes.hpp"
#include "core/scene/scene.hpp"

namespace peerd {

// Which KeySensors of a world get a key (seed, C.3). One peer's own: a key is pressed at one peer, and which of its
// sensors are enabled is nobody else's business. Only what a sensor does to its recipient is shared, as movement.
//
//   key ──> sensor ──> sensor ──> sensor ──> application       asked in file order; one with `consume` ends the row
//             │keyHit                                          those that get it send keyHit TRUE
//             └──ROUTE──> enabled, disable of other sensors ──ROUTE──> ..
//
// Who gets a key is decided before any event that the key causes, as if all sensors looked at the keyboard at once: two
// sensors on one key that enable each other take turns. The events of a key have one timestamp, by the rules of
// animation/animation.hpp: `enabled` of each sensor takes one event and sends one; of several that one counts which
// came over the fewest ROUTEs, and of those the one whose ROUTE is last in the file.
//
// `disable` TRUE is `enabled` FALSE, and `disable` FALSE is `enabled` TRUE: so one sensor's enabled_changed, ROUTEd to
// another's disable, makes it the other's opposite. A disabled sensor gets no key, so it consumes none.
class KeySensors {
 public:
  explicit KeySensors(const Scene& scene);  // reads it; keeps nothing of it

  struct Outcome {
    std::vector<std::size_t> hits;  // indices into Scene::key_sensors, in file order
    bool consumed = false;          // the application does not get it
  };
  // The key goes down. A release means nothing to the seed's sensors; a key that repeats is pressed again each time.
  Outcome press(const KeyEvent& key);

  [[nodiscard]] bool enabled(std::size_t sensor) const { return sensors_[sensor].enabled; }

 private:
  struct Route {
    std::size_t to = 0;     // a sensor
    bool inverts = false;   // to its disable, else to its enabled
    std::size_t place = 0;  // among the file's ROUTEs
  };
  struct Sensor {
    KeyEvent key;  // canonical
    bool consume = true, enabled = true;
    std::vector<Route> from_hit, from_enabled;
  };
  void send(const std::vector<std::size_t>& hits);

  std::vector<Sensor> sensors_;
};

}  // namespace peerd
