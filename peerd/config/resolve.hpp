#pragma once
#include <map>
#include <optional>
#include <vector>

#include "core/scene/scene.hpp"
#include "peerd/config/scenario.hpp"
#include "peerd/motion/motion_source.hpp"

namespace peerd::config {

// What drives objects. Those that it does not hold move by their velocityVector.
using Motions = std::map<ObjectId, MotionSource>;

// A peer's paths and patterns as nodes of the scene.
struct PeerObjects {
  std::vector<ObjectId> owned;                       // in the order of the settings, none twice
  Motions motions;                                   // of owned objects
  std::map<std::string, ObjectId> outside;           // owned objects that a program moves, by the name that it uses
  std::map<ObjectId, replication::Launch> launches;  // of owned objects that physics moves
  std::optional<ObjectId> viewpoint;
};

// Who runs and drives what: the one place where settings meet the scene. For each of run.peers, in their order.
[[nodiscard]] Result<std::vector<PeerObjects>> resolve(const RunSettings& run, const Scene& scene);

}  // namespace peerd::config
