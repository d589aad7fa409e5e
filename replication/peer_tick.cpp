// Peer: one tick, from contacts to the updates that are due.
#include <algorithm>
#include <cassert>

#include "collision/proximity.hpp"
#include "replication/decision.hpp"
#include "replication/peer.hpp"

namespace peerd::replication {
namespace {

// What the next interval between two updates may be expected to be.
constexpr double kIntervalMin_s = 0.1, kIntervalMax_s = 0.5;

}  // namespace

void Peer::tick(SimTime t, std::span<const OwnSample> samples) {
  tell_predefined(t);
  replica_->truth.advance(t);
  for (const OwnSample& sample : samples) {
    const auto own = own_.find(sample.object);
    if (own == own_.end()) continue;  // lost to another peer
    assert(own->second.driven);
    replica_->truth.set_base(sample.object, t,
                             sample.has_derivatives ? sample.state : own->second.poses.derive(t, sample.state.pose()));
  }
  replica_->ghosts.advance(t);
  report_contacts(t);
  publish(t);
}

void Peer::report_contacts(SimTime t) {
  while (const auto event = replica_->truth.poll_event()) {
    const auto* contact = std::get_if<ContactEvent>(&*event);
    if (contact == nullptr) continue;
    const bool a = own_.contains(contact->collider), b = own_.contains(contact->collidee);
    const bool shared = is_shared(contact->collider, contact->collidee);
    if (!a && !b && !(shared && serves())) continue;  // a partner's own contacts; the ghosts tell of them
    if (shared) {
      contact->held ? hold(*contact) : decide(*contact, t);
      continue;
    }
    colliding_.on_contact(*contact);
    outputs_.push_back(ContactSeen{ContactKind::kOwner, *contact, t});
  }
  release_held(t);
  const auto others = [&](ObjectId id) { return !own_.contains(id) && owner(id) != kNobody; };
  while (const auto event = replica_->ghosts.poll_event()) {
    if (const auto* taken_back = std::get_if<TakenBack>(&*event)) {
      if (others(taken_back->object)) outputs_.push_back(*taken_back);
    } else if (const auto& contact = std::get<ContactEvent>(*event);
               others(contact.collider) || others(contact.collidee)) {
      // Of an own object its truth tells, or a decision.
      if (!own_.contains(contact.collider) && !own_.contains(contact.collidee)) colliding_.on_contact(contact);
      outputs_.push_back(ContactSeen{ContactKind::kPredicted, contact, t});
    }
  }
  colliding_.update([&](ObjectId id) { return (own_.contains(id) ? replica_->truth : replica_->ghosts).at(id, t); }, t);
  while (const auto change = colliding_.poll()) outputs_.push_back(*change);
}

Horizon Peer::horizon(const Own& own) const { return {to_seconds(farthest_latency()), own.interval_s}; }

// Hands every own object's state to what chooses its models.
void Peer::observe(SimTime t) {
  if (!config_.policy.models) return;
  for (auto& [object, own] : own_) {
    if (!own.models) own.models.emplace(*config_.policy.models);
    own.models->push(t, replica_->truth.at(object, t), horizon(own));
  }
}

// Whether an update is worth one of the budget: the others are wrong by more, or will be: the velocity has jumped where
// the ghost's has not. Nothing is known yet of how the new run goes on, so only what it begins with is compared.
bool Peer::gains(ObjectId object, Own& own, SimTime t, const GhostError& error) {
  const PublishPolicy& policy = config_.policy;
  if (policy.wanted_error_m == 0.0) return false;
  const auto worth_m = own.budget.worth_m(policy, t);
  if (!worth_m) return false;
  if (error.distance_m > *worth_m) return true;
  if (!policy.at_corners || !own.models || !own.models->at_corner()) return false;
  const double ahead_s = horizon(own).middle_s();
  const auto straight_on = [&](const KinematicState& s) { return Vec3(s.position + ahead_s * s.velocity); };
  return (straight_on(replica_->ghosts.at(object, t)) - straight_on(replica_->truth.at(object, t))).norm() > *worth_m;
}

void Peer::publish(SimTime t) {
  const PublishPolicy& policy = config_.policy;
  observe(t);
  const std::uint32_t copies = copies_against(loss(), policy.copies);
  for (auto& [object, own] : own_) {
    const KinematicState truth = replica_->truth.at(object, t);
    const GhostError error = ghost_error(truth, replica_->ghosts.at(object, t));
    double threshold_m = policy.error_threshold_m.value_or(model_.scene->object(object).distance_threshold_m);
    if (policy.track_proximity && in_close_proximity(object, t, threshold_m)) {
      threshold_m = std::min(threshold_m, policy.tight_threshold_m);
    }
    if (own.starts && t >= *own.starts) {  // it has begun to move: nobody could know
      own.starts.reset();
      own.last_sent.reset();
    }
    std::optional<PublishReason> reason = due(policy, threshold_m, error, own.last_sent, t);
    if (!reason && own.retell) reason = PublishReason::kDecision;
    if (!reason && own.resend) reason = PublishReason::kJoiner;
    if (!reason && gains(object, own, t, error)) reason = PublishReason::kGain;
    if (!reason) continue;
    own.budget.spend(policy, t);
    if (own.last_sent) {
      const double interval_s = std::clamp(to_seconds(t - *own.last_sent), kIntervalMin_s, kIntervalMax_s);
      own.interval_s += (interval_s - own.interval_s) / 4.0;
    }
    own.last_sent = t;
    own.resend = own.retell = false;
    const MotionModel model = own.models ? own.models->choose() : as_model(policy.order, truth);
    const UpdateRecord record{object, ++own.sequence, t, model, decisions_.last(object)};
    replica_->ghosts.set_base(object, t, record.model);
    ++counters_.updates_out;
    outputs_.push_back(Published{t, object, encoded_size_bytes(record), threshold_m, *reason});
    updates_due_.push_back(record);
    own.to_repeat = record;
    own.copies = copies - 1;
  }
  send_copies();
}

bool Peer::in_close_proximity(ObjectId object, SimTime t, double threshold_m) {
  const collision::Body* body = model_.body(object);
  if (body == nullptr) return false;
  const KinematicState state = replica_->truth.at(object, t);
  return std::ranges::any_of(model_.pairs, [&](const CollisionPair& pair) {
    if (pair.collider != object && pair.collidee != object) return false;
    const ObjectId other = pair.collider == object ? pair.collidee : pair.collider;
    const PeerId other_owner = owner(other);
    if (other_owner == kNobody || other_owner == config_.id) return false;  // seed, table 4.1: remote-enslaved only
    ++counters_.proximity_tests;
    const KinematicState other_state = replica_->truth.at(other, t);
    const collision::MovingBody here{*body, state}, there{*model_.body(other), other_state};
    const double within_s = config_.policy.close_proximity_s;
    if (!(collision::proximity_time_s(here, there) < within_s)) return false;
    if (!config_.policy.refine_proximity || pair.type == CollisionType::kBox) return true;
    ++counters_.proximity_refined;
    return collision::may_come_near(here, there, within_s, threshold_m);
  });
}

}  // namespace peerd::replication
