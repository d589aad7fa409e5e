#include "replication/publish/proximity_threshold.hpp"

#include <algorithm>
#include <cassert>

#include "collision/contact/proximity.hpp"

namespace peerd::replication {
namespace {

// The search for the time within which surfaces may meet goes down to so small a part of it.
constexpr double kTimeSteps = 16.0;

// A time [s] for which two objects that may come near each other within within_s certainly don't, by halves of it:
// surfaces meet later than their bounding spheres. 0 where that is less than a part in kTimeSteps.
double apart_for_s(const collision::MovingBody& a, const collision::MovingBody& b, double within_s, double margin_m) {
  for (double s = 0.5 * within_s; s >= within_s / kTimeSteps; s *= 0.5) {
    if (!collision::may_come_near(a, b, s, margin_m)) return s;
  }
  return 0.0;
}

}  // namespace

ProximityThreshold::ProximityThreshold(const PeerConfig& config, const ModelInForce& model, const Owners& owners,
                                       const Replica& replica, PeerCounters& counters)
    : config_(config), model_(model), owners_(owners), replica_(replica), counters_(counters) {}

double ProximityThreshold::usual_m(ObjectId object) const {
  return config_.policy.error_threshold_m.value_or(model_->scene->object(object).distance_threshold_m);
}

double ProximityThreshold::least_m(ObjectId object) const {
  const PublishPolicy& policy = config_.policy;
  const double tight_m = std::min(usual_m(object), policy.tight_threshold_m);
  return policy.wanted_error_m > 0.0 ? std::min(tight_m, policy.wanted_error_m) : tight_m;
}

double ProximityThreshold::at(ObjectId object, SimTime t) const {
  const PublishPolicy& policy = config_.policy;
  const double usual_m = this->usual_m(object), tight_m = std::min(usual_m, policy.tight_threshold_m);
  if (!policy.track_proximity || tight_m == usual_m) return usual_m;
  const double left_s = time_to_contact_s(object, t, usual_m);
  assert(left_s >= 0.0);
  if (!(left_s < policy.close_proximity_s)) return usual_m;
  return policy.threshold_by_time ? tight_m + (usual_m - tight_m) * left_s / policy.close_proximity_s : tight_m;
}

// The time [s] until the object could meet one of another peer (Ohlenburg 2003, table 4.1: remote-enslaved pairs only),
// not more than that; at least the policy's close proximity where nothing is close. By steps 0 where anything is.
double ProximityThreshold::time_to_contact_s(ObjectId object, SimTime t, double threshold_m) const {
  const bool by_time = config_.policy.threshold_by_time;
  double least_s = config_.policy.close_proximity_s;
  const collision::Body* body = model_->body(object);
  if (body == nullptr) return least_s;
  const KinematicState state = replica_.truth().at(object, t);
  for (const std::uint32_t number : model_->pairs_of(object)) {
    const CollisionPair& pair = model_->pairs[number];
    const ObjectId other = pair.collider == object ? pair.collidee : pair.collider;
    const PeerId other_owner = owners_.of(other);
    if (other_owner == kNobody || other_owner == config_.id || !replica_.receives(other)) continue;
    ++counters_.proximity_tests;
    const KinematicState other_state = replica_.truth().at(other, t);
    const collision::MovingBody here{*body, state}, there{*model_->body(other), other_state};
    double left_s = collision::proximity_time_s(here, there);
    if (!(left_s < least_s)) continue;
    if (config_.policy.refine_proximity && pair.type != CollisionType::kBox) {
      ++counters_.proximity_refined;
      if (!collision::may_come_near(here, there, least_s, threshold_m)) continue;
      if (by_time) left_s = std::max(left_s, apart_for_s(here, there, least_s, threshold_m));
    }
    if (!by_time || left_s == 0.0) return 0.0;
    least_s = left_s;
  }
  return least_s;
}

}  // namespace peerd::replication
