#pragma once
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/motion/motion_source.hpp"

namespace peerd::config {

// The motions of driven objects. All other objects move by their velocityVector.
using Motions = std::map<ObjectId, motion::MotionSource>;

// The objects of the scene that a peer's paths and patterns stand for.
struct PeerObjects {
  std::vector<ObjectId> owned;                       // in the order of the settings, without duplicates
  std::vector<ObjectId> owned_by_founder;            // owned if this peer founds the session
  Motions motions;                                   // owned objects that are driven
  std::map<std::string, ObjectId> outside;           // owned objects that a program moves, by the name that it uses
  std::map<ObjectId, replication::Launch> launches;  // owned objects that physics moves
  std::optional<ObjectId> viewpoint;
  std::vector<std::optional<ObjectId>> views;  // what carries each of the peer's views; none: it stands
};

// Finds the owned objects and the motions of each of run.peers, in their order. No other function connects settings
// with the scene. What the file gives to the founder, and no peer's settings own: peers of one configuration know who
// begins together, and the lowest id of those owns it, whenever it comes; a peer of a configuration of its own has to
// see whether it founds the session.
[[nodiscard]] Result<std::vector<PeerObjects>> resolve(const RunSettings& run, const Scene& scene);

// The objects that some peer of some run owns, ascending. Patterns that name nothing are left out: resolve() reports
// them.
[[nodiscard]] std::vector<ObjectId> owned_in(std::span<const RunSettings> runs, const Scene& scene);

// The settings that do nothing, as one warning each: motions of the scenario where no peer owns what they name, or
// motions of the peers come first; and owned nodes that their owner cannot move, or that only a ROUTE would move.
[[nodiscard]] std::vector<std::string> settings_without_effect(const RunSettings& run, const Scene& scene);

}  // namespace peerd::config
