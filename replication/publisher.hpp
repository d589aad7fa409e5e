#pragma once
#include <cstdint>
#include <limits>
#include <optional>

#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/wire.hpp"

namespace peerd::replication {

// When a peer tells the others how an object of its own moves (seed 4.2.2 and 4.4.2).
struct PublishPolicy {
  ModelOrder order = ModelOrder::kSecond;
  std::optional<double> error_threshold_m;          // none: each object's own distanceThreshold
  double tight_threshold_m = 0.01;                  // in close proximity
  double angle_threshold_rad = 0.0523598775598299;  // 3 degrees
  Duration time_threshold = std::chrono::seconds(5);
  double close_proximity_s = 0.5;  // the seed's close proximity threshold
  bool predict_collisions = true;  // remote collision prediction
  bool track_proximity = true;     // adaptive collision prediction tracking
  // Of what bounding spheres say is close, only those whose polygons may come nearer than the object's own threshold.
  bool refine_proximity = false;
};

enum class PublishReason : std::uint8_t { kFirst, kError, kTime, kJoiner };
[[nodiscard]] const char* to_string(PublishReason);

// How far the ghost that the others hold is from the truth.
struct GhostError {
  double distance_m = 0.0;  // Euclidean, not per axis: a cube of that edge would let 1.7 times as much through
  double angle_rad = 0.0;
};
[[nodiscard]] GhostError ghost_error(const KinematicState& truth, const KinematicState& ghost);

// Why an update is due now; none when the others still believe well enough.
[[nodiscard]] std::optional<PublishReason> due(const PublishPolicy& policy, double threshold_m, const GhostError& error,
                                               std::optional<SimTime> last_sent, SimTime now);

// What goes into the update: the truth as the model's order can express it.
[[nodiscard]] KinematicState as_model(ModelOrder order, const KinematicState& truth);

}  // namespace peerd::replication
