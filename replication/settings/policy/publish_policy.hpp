#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/model_choice.hpp"

namespace peerd::replication {

enum class ModelOrder : std::uint8_t { kFirst = 1, kSecond = 2 };

// The rules by which a peer publishes updates of its own objects (Ohlenburg 2003, sections 4.2.2 and 4.4.2).
struct PublishPolicy {
  ModelOrder order = ModelOrder::kSecond;
  std::optional<double> error_threshold_m;          // none: the distanceThreshold of each object
  double tight_threshold_m = 0.01;                  // in close proximity
  double angle_threshold_rad = 0.0523598775598299;  // 3 degrees
  // Errors count by the distance of the surface from its predicted place: a turn moves the farthest vertex by so much.
  bool surface_error = false;
  Duration time_threshold = std::chrono::seconds(5);
  // The time threshold of updates that would say what all peers know: the object rests, and all have acknowledged
  // where; or a decision says it.
  Duration resting_time_threshold = std::chrono::seconds(60);
  std::uint32_t snapshots_hz = 0;  // > 0: a state of every object at this rate, whatever the error
  double close_proximity_s = 0.5;  // the close proximity threshold of the thesis
  bool predict_collisions = true;  // remote collision prediction
  bool track_proximity = true;     // adaptive collision prediction tracking
  // An object that is close by bounding spheres counts as close only if its polygons may come nearer than the object's
  // own threshold.
  bool refine_proximity = false;
  // The threshold falls in proportion to the time that is left, down to the tight one at contact; otherwise it falls
  // at once.
  bool threshold_by_time = false;
  // The models to choose from, which the thesis does not have. None: every update is of `order`.
  std::optional<ModelPolicy> models;
  // Below the thresholds above, updates go out by what they gain, as far as the update budget allows. 0 m: they do
  // not.
  double wanted_error_m = 0.0;
  double updates_per_s = 2.0;  // the rate of the update budget of each object
  double updates_saved = 6.0;  // the size of the update budget, >= 1
  // An update that shares a datagram costs its record and no header: an object's update goes along with one that is
  // due from this fraction on of the error that it would wait for otherwise. 1: not before.
  double piggyback_fraction = 1.0;
  std::uint32_t copies = 1;  // copies of each update: two at once, then one a tick until a newer update goes out
  // The bytes that a peer's datagrams may take, headers of UDP and IP aside; none: no limit. Beyond it updates wait,
  // the most urgent leave first; hellos, decisions and changes that nobody could predict do not wait, but use the
  // budget.
  std::optional<double> bytes_per_s;
};

enum class PublishReason : std::uint8_t { kFirst, kError, kTime, kJoiner, kGain, kDecision, kRegion };
[[nodiscard]] const char* to_string(PublishReason);

// The error of the ghost that the receivers hold, against the truth.
struct GhostError {
  double distance_m = 0.0;  // Euclidean, not per axis: a cube of that edge would let 1.7 times as much through
  double angle_rad = 0.0;
};
// `bounding_radius_m`: the distance of the object's farthest vertex from its origin, which the turn moves besides; 0:
// the error of the origin alone.
[[nodiscard]] GhostError ghost_error(const KinematicState& truth, const KinematicState& ghost,
                                     double bounding_radius_m = 0.0);

// The reason for which an update is due now; none when the ghosts of the receivers are still good enough. `redundant`:
// another update would say what all receivers know.
[[nodiscard]] std::optional<PublishReason> due(const PublishPolicy& policy, double threshold_m, const GhostError& error,
                                               std::optional<SimTime> last_sent, SimTime now, bool redundant = false);

// The longest interval between two updates of an object, where no error asks for one.
[[nodiscard]] Duration longest_interval(const PublishPolicy& policy, bool redundant);

// The model that goes into the update: the truth as the model's order can express it.
[[nodiscard]] MotionModel as_model(ModelOrder order, const KinematicState& truth);

// The urgency of an update that is due: the ratio of its error or its time to the threshold, times the time for which
// it has waited [s], so that each object gets a share; divided by the distance of the nearest viewer, `viewed_from_m`.
// `last_sent`: none where a receiver knows nothing of the object.
[[nodiscard]] double urgency(const PublishPolicy& policy, double threshold_m, const GhostError& error,
                             std::optional<SimTime> last_sent, SimTime now, double viewed_from_m);

}  // namespace peerd::replication
