#include "replication/publisher.hpp"

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
  }
  return "?";
}

GhostError ghost_error(const KinematicState& truth, const KinematicState& ghost) {
  return {(truth.position - ghost.position).norm(), angle_between(truth.orientation, ghost.orientation)};
}

std::optional<PublishReason> due(const PublishPolicy& policy, double threshold_m, const GhostError& error,
                                 std::optional<SimTime> last_sent, SimTime now) {
  if (!last_sent) return PublishReason::kFirst;
  if (error.distance_m > threshold_m || error.angle_rad > policy.angle_threshold_rad) return PublishReason::kError;
  if (now - *last_sent >= policy.time_threshold) return PublishReason::kTime;
  return std::nullopt;
}

KinematicState as_model(ModelOrder order, const KinematicState& truth) {
  KinematicState model = truth;
  if (order == ModelOrder::kFirst) model.acceleration.setZero();
  return model;
}

}  // namespace peerd::replication
