#include "replication/settings/policy/publish_policy.hpp"

#include <algorithm>
#include <cmath>

namespace peerd::replication {

const char* to_string(PublishReason reason) {
  switch (reason) {
    case PublishReason::kFirst:
      return "first";
    case PublishReason::kError:
      return "error";
    case PublishReason::kTime:
      return "time";
    case PublishReason::kJoiner:
      return "joiner";
    case PublishReason::kGain:
      return "gain";
    case PublishReason::kDecision:
      return "decision";
    case PublishReason::kRegion:
      return "region";
  }
  return "?";
}

GhostError ghost_error(const KinematicState& truth, const KinematicState& ghost, double bounding_radius_m) {
  const double angle_rad = angle_between(truth.orientation, ghost.orientation);
  return {(truth.position - ghost.position).norm() + 2.0 * bounding_radius_m * std::sin(0.5 * angle_rad), angle_rad};
}

Duration longest_interval(const PublishPolicy& policy, bool redundant) {
  return redundant ? std::max(policy.time_threshold, policy.resting_time_threshold) : policy.time_threshold;
}

std::optional<PublishReason> due(const PublishPolicy& policy, double threshold_m, const GhostError& error,
                                 std::optional<SimTime> last_sent, SimTime now, bool redundant) {
  if (!last_sent) return PublishReason::kFirst;
  if (policy.snapshots_hz > 0) {
    // Half a millisecond of slack: ticks are whole nanoseconds, and 1/60 s is not a whole number of them.
    const Duration period = Duration{std::chrono::seconds(1)} / policy.snapshots_hz - std::chrono::microseconds(500);
    return now - *last_sent >= period ? std::optional(PublishReason::kTime) : std::nullopt;
  }
  if (error.distance_m > threshold_m || error.angle_rad > policy.angle_threshold_rad) return PublishReason::kError;
  if (now - *last_sent >= longest_interval(policy, redundant)) return PublishReason::kTime;
  return std::nullopt;
}

double urgency(const PublishPolicy& policy, double threshold_m, const GhostError& error,
               std::optional<SimTime> last_sent, SimTime now, double viewed_from_m) {
  constexpr double kNear_m = 1.0;  // a viewer is no closer than that
  constexpr double kNever = 1e9;   // the urgency of an object of which a receiver knows nothing
  const double near_m = std::max(viewed_from_m, kNear_m);
  if (!last_sent) return kNever / near_m;
  const double waited_s = to_seconds(now - *last_sent);
  const auto times = [](double value, double limit) { return value > 0.0 ? value / limit : 0.0; };
  const double most =
      std::max({times(waited_s, to_seconds(policy.time_threshold)), times(error.distance_m, threshold_m),
                times(error.angle_rad, policy.angle_threshold_rad)});
  return waited_s > 0.0 ? most * waited_s / near_m : 0.0;
}

MotionModel as_model(ModelOrder order, const KinematicState& truth) {
  MotionModel model = truth;
  if (order == ModelOrder::kFirst) {
    model.kind = MotionKind::kFirst;
    model.state.acceleration.setZero();
  }
  return model;
}

}  // namespace peerd::replication
