#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/motion/model_choice.hpp"

namespace peerd::replication {

enum class ModelOrder : std::uint8_t { kFirst = 1, kSecond = 2 };

// When a peer tells the others how an object of its own moves (seed 4.2.2 and 4.4.2).
struct PublishPolicy {
  ModelOrder order = ModelOrder::kSecond;
  std::optional<double> error_threshold_m;          // none: each object's own distanceThreshold
  double tight_threshold_m = 0.01;                  // in close proximity
  double angle_threshold_rad = 0.0523598775598299;  // 3 degrees
  // Errors count by how far the surface is from where it is believed: a turn moves the farthest vertex by so much.
  bool surface_error = false;
  Duration time_threshold = std::chrono::seconds(5);
  // .. of what everybody knows: it rests, and all are known to have heard where; or a decision tells of it.
  Duration resting_time_threshold = std::chrono::seconds(60);
  std::uint32_t snapshots_hz = 0;  // > 0: a state of every object at this rate, whatever the others believe
  double close_proximity_s = 0.5;  // the seed's close proximity threshold
  bool predict_collisions = true;  // remote collision prediction
  bool track_proximity = true;     // adaptive collision prediction tracking
  // Of what bounding spheres say is close, only those whose polygons may come nearer than the object's own threshold.
  bool refine_proximity = false;
  // The threshold falls in proportion to the time that is left, down to the tight one at contact; else at once.
  bool threshold_by_time = false;
  // Beyond the seed. None: every update is of `order`.
  std::optional<ModelPolicy> models;
  // Below the thresholds above, updates go out by what they gain, as far as the budget allows. 0 m: not.
  double wanted_error_m = 0.0;
  double updates_per_s = 2.0;  // the budget's rate, for each object
  double updates_saved = 6.0;  // how much of it can be saved up; >= 1
  // What shares a datagram costs its record and no header: it goes along with what is due from this share on of the
  // error that it would wait for otherwise. 1: not before.
  double piggyback_fraction = 1.0;
  std::uint32_t copies = 1;  // of each update: two at once, then one a tick until a newer update goes out
  // What a peer's datagrams may take, headers of UDP and IP aside; none: what they need. Beyond it updates wait, the
  // most urgent first out; hellos, decisions and what nobody could know do not wait, but take of it.
  std::optional<double> bytes_per_s;
};

enum class PublishReason : std::uint8_t { kFirst, kError, kTime, kJoiner, kGain, kDecision, kRegion };
[[nodiscard]] const char* to_string(PublishReason);

// How far the ghost that the others hold is from the truth.
struct GhostError {
  double distance_m = 0.0;  // Euclidean, not per axis: a cube of that edge would let 1.7 times as much through
  double angle_rad = 0.0;
};
// `bounding_radius_m`: of the object's farthest vertex from its origin, which the turn moves besides; 0: the origin's error.
[[nodiscard]] GhostError ghost_error(const KinematicState& truth, const KinematicState& ghost, double bounding_radius_m = 0.0);

// Why an update is due now; none when the others still believe well enough. `known`: another one would say what
// everybody knows.
[[nodiscard]] std::optional<PublishReason> due(const PublishPolicy& policy, double threshold_m, const GhostError& error,
                                               std::optional<SimTime> last_sent, SimTime now, bool redundant = false);

// From one update of an object to the next, where no error asks for it.
[[nodiscard]] Duration longest_interval(const PublishPolicy& policy, bool redundant);

// What goes into the update: the truth as the model's order can express it.
[[nodiscard]] MotionModel as_model(ModelOrder order, const KinematicState& truth);

// How much an update is wanted that is due: how many times its error or its time is of what it waits for, times how
// long it has waited [s], so that each object gets a share; the less the farther away the nearest of those is who see
// it, `viewed_from_m`. `last_sent`: none where somebody knows nothing of it.
[[nodiscard]] double urgency(const PublishPolicy& policy, double threshold_m, const GhostError& error,
                             std::optional<SimTime> last_sent, SimTime now, double viewed_from_m);

}  // namespace peerd::replication
