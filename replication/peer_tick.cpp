// Peer: one tick, from contacts to the updates that are due.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "collision/contact/proximity.hpp"
#include "replication/decision/decision.hpp"
#include "replication/peer.hpp"
#include "replication/wire/record.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// What the next interval between two updates may be expected to be.
constexpr double kIntervalMin_s = 0.1, kIntervalMax_s = 0.5;
// To how small a part of the time within which surfaces may meet the search for their time goes.
constexpr double kTimeSteps = 16.0;
// What is squeezed between two others touches each of them many times a millisecond. Contacts of one pair no farther
// apart are one touch, and the last of them is what becomes of it.
constexpr Duration kSameTouch = std::chrono::milliseconds(4);

bool is_same_touch(const ContactEvent& a, const ContactEvent& b) {
  const bool pair =
      (a.collider == b.collider && a.collidee == b.collidee) || (a.collider == b.collidee && a.collidee == b.collider);
  return pair && a.at <= b.at + kSameTouch && b.at <= a.at + kSameTouch;
}

// Who is short of bytes waits for so many before the next datagram: one a tick with a record each would be half
// headers.
constexpr double kSmallestWorthwhileDatagram_bytes = 256.0;

// A model that is expected to err by less than so much of what the thresholds ask won't be corrected before its time is
// up, unless its rounding asks for that.
constexpr double kAllButExact = 1.0 / 16.0, kFinest = 1.0 / 64.0;

// By how much finer it is rounded for that: what rounding moves grows with the square of time, from a 16th of the
// threshold at the kind's horizon, and should be half of it at the time threshold.
double finer(MotionKind kind, Duration time_threshold) {
  const double horizons = to_seconds(time_threshold) / std::exp2(horizon_log2_s(kind));
  return std::clamp(8.0 / (horizons * horizons), kFinest, 1.0);
}

// The tightest threshold in force. What physics moves is told exactly: resting against something and rounded, it could
// lie inside it. Where snapshots go out whatever the thresholds, the tight one says what is close.
Tolerance rounding_tolerance(const PublishPolicy& policy, double threshold_m, double bounding_radius_m, MotionKind kind,
                             double expected_error_m) {
  double distance_m = policy.snapshots_hz > 0 ? std::min(threshold_m, policy.tight_threshold_m) : threshold_m;
  if (policy.wanted_error_m > 0.0) distance_m = std::min(distance_m, policy.wanted_error_m);
  if (expected_error_m < kAllButExact * distance_m) distance_m *= finer(kind, policy.time_threshold);
  // An orientation is rounded by a quarter of this at most: that moves the surface by half of the threshold.
  const double turn_rad = bounding_radius_m > 0.0 ? 2.0 * threshold_m / bounding_radius_m : policy.angle_threshold_rad;
  return {distance_m, std::min(policy.angle_threshold_rad, turn_rad)};
}

// Farther or faster than receivers take it: nobody could be told. What drives an object may do that, and what falls for
// days, or a decision that somebody made up.
bool sendable(const MotionModel& model) { return acceptable(model.state) && within_limits(model); }

// Of objects that come so much later in a tick, what it needs of them comes from memory meanwhile.
constexpr std::ptrdiff_t kOwnAhead = 4, kSamplesAhead = 2;

// So long two that may come near each other within within_s certainly don't, by halves of it: surfaces meet later than
// their spheres. 0 where that is less than a part in kTimeSteps.
double apart_for_s(const collision::MovingBody& a, const collision::MovingBody& b, double within_s, double margin_m) {
  for (double s = 0.5 * within_s; s >= within_s / kTimeSteps; s *= 0.5) {
    if (!collision::may_come_near(a, b, s, margin_m)) return s;
  }
  return 0.0;
}

}  // namespace

void Peer::tick(SimTime t, std::span<const OwnSample> samples) {
  extend_predefined(t);
  begin_motions(t);
  replica_->truth.advance(t);
  auto own = own_objects_.begin();
  for (std::size_t i = 0; i < samples.size(); ++i) {  // most come in the same order
    const OwnSample& sample = samples[i];
    if (i + kOwnAhead < samples.size()) replica_->truth.prefetch(samples[i + kOwnAhead].object);
    if (own == own_objects_.end() || own->first != sample.object) own = own_objects_.find(sample.object);
    if (own == own_objects_.end()) continue;  // lost to another peer
    assert(own->second.driven);
    KinematicState state = sample.has_derivatives ? sample.state : own->second.poses.derive(t, sample.state.pose());
    if (!acceptable(state)) {
      state = at_rest_within_limits(state);
      ++counters_.states_out_of_range;
    }
    replica_->truth.set_base(sample.object, t, state);
    ++own;
  }
  replica_->ghosts.advance(t);
  report_contacts(t);
  publish(t);
}

void Peer::report_contacts(SimTime t) {
  std::vector<ContactEvent> decided;  // in the order of what happened, of one touch the last
  while (const auto event = replica_->truth.poll_event()) {
    const auto* contact = std::get_if<ContactEvent>(&*event);
    if (contact == nullptr) continue;
    const bool a = own_objects_.contains(contact->collider), b = own_objects_.contains(contact->collidee);
    const bool shared = has_two_owners(contact->collider, contact->collidee);
    if (!a && !b && !(shared && is_decision_server())) continue;  // a partner's own contacts; the ghosts tell of them
    if (shared) {
      if (contact->deferred) {
        defer_contact(*contact);
      } else {
        std::erase_if(decided, [&](const ContactEvent& c) { return is_same_touch(c, *contact); });
        decided.push_back(*contact);
      }
      continue;
    }
    colliding_.on_contact(*contact);
    outputs_.push_back(ContactSeen{ContactKind::kOwner, *contact, t});
  }
  for (const ContactEvent& contact : decided) decide(contact, t);
  resolve_overdue_contacts(t);
  const auto others = [&](ObjectId id) { return !own_objects_.contains(id) && owner(id) != kNobody; };
  while (const auto event = replica_->ghosts.poll_event()) {
    if (const auto* met = std::get_if<ContactEvent>(&*event)) republish_across_regions(*met);
    if (const auto* retracted = std::get_if<ContactsRetracted>(&*event)) {
      if (others(retracted->object)) outputs_.push_back(*retracted);
    } else if (const auto& contact = std::get<ContactEvent>(*event);
               others(contact.collider) || others(contact.collidee)) {
      // Of an own object its truth tells, or a decision.
      if (!own_objects_.contains(contact.collider) && !own_objects_.contains(contact.collidee)) colliding_.on_contact(contact);
      outputs_.push_back(ContactSeen{ContactKind::kPredicted, contact, t});
    }
  }
  colliding_.update([&](ObjectId id) { return (own_objects_.contains(id) ? replica_->truth : replica_->ghosts).at(id, t); }, t);
  while (const auto change = colliding_.poll()) outputs_.push_back(*change);
}

// Hands an own object's state to what chooses its models; what physics moves names its law.
void Peer::observe(ObjectId object, OwnObject& own, SimTime t, double latency_s) {
  if (!config_.policy.models || !own.driven) return;
  if (!own.models) own.models.emplace(*config_.policy.models);
  own.models->push(t, replica_->truth.at(object, t), Horizon{latency_s, own.interval_s});
}

// Whether an update is worth one of the budget: of what it mends, rounding its orientation may bring back as much.
bool Peer::is_worth_an_update(OwnObject& own, SimTime t, const GhostError& error) {
  if (config_.policy.wanted_error_m == 0.0) return false;
  const auto least_gain_m = own.budget.least_gain_m(config_.policy, t);
  return least_gain_m && error.distance_m > std::max(*least_gain_m, 2.0 * own.bounding_radius_m * kOrientationError_rad);
}

void Peer::publish(SimTime t) {
  const double latency_s = to_seconds(farthest_latency());
  publish_changed(t);
  not_due_.clear();
  due_updates_.clear();
  schedule_checks_of_changed();
  for (std::size_t index = checks_.next_due(0, t); index != own_objects_.size(); index = checks_.next_due(index + 1, t)) {
    const auto at = own_objects_.nth(index);
    const std::ptrdiff_t left = own_objects_.end() - at;
    if (left > kOwnAhead) prefetch(at[kOwnAhead]);
    if (left > kSamplesAhead && at[kSamplesAhead].second.models) at[kSamplesAhead].second.models->prefetch();
    auto& [object, own] = *at;
    ++counters_.objects_looked_at;
    observe(object, own, t, latency_s);
    const KinematicState truth = replica_->truth.at(object, t), ghost = replica_->ghosts.at(object, t);
    // Where physics takes an object that has met something is not known before its decider says: until then its truth
    // is no better than what the ghosts believe.
    const bool undecided = !own.driven && awaits_decision_on(object);
    const GhostError error = undecided ? GhostError{} : ghost_error(truth, ghost, own.bounding_radius_m);
    const double threshold_m = threshold_now_m(object, t);
    if (const auto reason = why_due(object, own, t, threshold_m, truth, ghost, error)) {
      if (config_.policy.bytes_per_s) {
        due_updates_.push_back({{object, &own, error, threshold_m}, *reason});
      } else {
        publish_update(object, own, t, t, *reason, threshold_m);
      }
      continue;
    }
    if (config_.policy.piggyback_fraction < 1.0) not_due_.push_back({object, &own, error, threshold_m});
    if (!own.driven && !undecided && is_motionless(truth)) checks_.set(index, next_check(object, own, t, error));
  }
  publish_most_urgent(t);
  if (!over_byte_budget_) publish_piggybacked(t);
  send_copies();
}

// Of what is due, as much as the budget of bytes allows.
void Peer::publish_most_urgent(SimTime t) {
  const PublishPolicy& policy = config_.policy;
  if (!policy.bytes_per_s) return;
  std::vector<Vec3> eyes;  // of those who say where they look from; empty where anybody does not: he sees it all
  for (const auto& [peer, member] : members_.all()) {
    const auto from = member.viewpoint ? camera_pose(*member.viewpoint, t) : std::nullopt;
    if (!from) {
      eyes.clear();
      break;
    }
    eyes.push_back(from->position);
  }
  for (Due& due : due_updates_) {
    const Vec3 at = replica_->truth.at(due.what.object, t).position;
    double viewed_from_m = eyes.empty() ? 0.0 : std::numeric_limits<double>::infinity();
    for (const Vec3& from : eyes) viewed_from_m = std::min(viewed_from_m, (at - from).norm());
    const bool is_unpredictable = due.what.own->resend || due.what.own->republish ||
                         (due.reason != PublishReason::kError && due.reason != PublishReason::kTime &&
                          due.reason != PublishReason::kGain);
    const auto last_sent = is_unpredictable ? std::nullopt : due.what.own->last_sent;
    due.urgency = urgency(policy, due.what.threshold_m, due.what.error, last_sent, t, viewed_from_m);
  }
  std::ranges::stable_sort(due_updates_, std::greater{}, &Due::urgency);
  double left = bytes_.left(policy, t);
  if (over_byte_budget_ && left < kSmallestWorthwhileDatagram_bytes) left = 0.0;
  for (const Due& due : due_updates_) {
    const auto& [object, own, error, threshold_m] = due.what;
    if (left > 0.0) {
      left -= static_cast<double>(publish_update(object, *own, t, t, due.reason, threshold_m));
    } else {
      ++counters_.updates_withheld;
    }
  }
  over_byte_budget_ = !(left > 0.0);
}

// What is not due yet but has come so far goes with what is, in a datagram that goes anyway.
void Peer::publish_piggybacked(SimTime t) {
  if (updates_due_.empty()) return;
  boost::container::small_vector<RegionId, 16> due_regions;
  for (const EncodedUpdate& u : updates_due_) {
    const RegionId region = grid_.region_of(u.record().model.state.position);
    if (std::ranges::find(due_regions, region) == due_regions.end()) due_regions.push_back(region);
  }
  const double share = config_.policy.piggyback_fraction;
  for (const NotDue& w : not_due_) {
    const RegionId region = grid_.region_of(replica_->truth.at(w.object, t).position);
    if (std::ranges::find(due_regions, region) == due_regions.end()) continue;
    const GhostError grown{w.error.distance_m / share, w.error.angle_rad / share};
    auto reason = due(config_.policy, w.threshold_m, grown, w.own->last_sent, t, true);
    if (!reason && is_worth_an_update(*w.own, t, grown)) reason = PublishReason::kGain;
    if (reason) publish_update(w.object, *w.own, t, t, *reason, w.threshold_m);
  }
}

// As a tick does, but for the contacts: those wait for the next one, which finds them when they happened.
void Peer::publish_now(HostTime now, std::span<const OwnSample> samples) {
  if (!replica_ || due_tick(now)) return;
  const SimTime t = clock_.to_session(now);
  if (t <= tick_time(last_tick_)) return;  // the session's time was ahead and is being put right
  std::vector<const OwnSample*> wrong;     // as the others believe them
  for (const OwnSample& sample : samples) {
    const auto own = own_objects_.find(sample.object);
    if (own == own_objects_.end() || over_byte_budget_ || published_since_tick(own->second)) continue;
    if (!acceptable(sample.state)) continue;  // the tick says something in its place
    assert(own->second.driven && sample.has_derivatives);
    const GhostError error = ghost_error(sample.state, replica_->ghosts.at(sample.object, t), own->second.bounding_radius_m);
    if (due(config_.policy, least_threshold_m(sample.object), error, own->second.last_sent, t))
      wrong.push_back(&sample);
  }
  if (wrong.empty() && unpublished_changes_.empty()) return;
  const std::uint64_t published_before = counters_.updates_out;
  extend_predefined(t);
  begin_motions(t);
  replica_->truth.advance(t);
  for (const OwnSample* sample : wrong) replica_->truth.set_base(sample->object, t, sample->state);
  replica_->ghosts.advance(t);
  publish_changed(t);
  for (const OwnSample* sample : wrong) {
    OwnObject& own = own_objects_.at(sample->object);
    const double threshold_m = threshold_now_m(sample->object, t);
    const KinematicState ghost = replica_->ghosts.at(sample->object, t);
    const GhostError error = ghost_error(sample->state, ghost, own.bounding_radius_m);
    const auto reason = why_due(sample->object, own, t, threshold_m, sample->state, ghost, error);
    if (!reason) continue;
    observe(sample->object, own, t, to_seconds(farthest_latency()));
    publish_update(sample->object, own, t, t, *reason, threshold_m);
  }
  counters_.updates_at_once += counters_.updates_out - published_before;
  flush_records(false);
}

bool Peer::published_since_tick(const OwnObject& own) const { return own.last_sent && *own.last_sent > tick_time(last_tick_); }

// What nobody could know comes before all else, and of the instant at which it began: what follows from it the others
// find themselves, and so do this peer's ghosts, before they are asked whether anything else is worth an update.
void Peer::publish_changed(SimTime t) {
  bool published = false;
  for (const auto& [object, since] : std::map(unpublished_changes_)) {
    OwnObject& own = own_objects_.at(object);
    if (published_since_tick(own)) continue;
    const bool follows = config_.policy.predict_collisions || replica_->truth.law_since(object, t) == since;
    publish_update(object, own, follows ? since : t, t, PublishReason::kFirst, threshold_now_m(object, t));
    published = true;
  }
  if (published) replica_->ghosts.advance(t);
}

// Whether another update would say what everybody knows: the object rests where they have it; or a decision tells where
// physics takes it, one that is still to come or from within the time threshold. Regions forget what they do not hear
// of, and what a relay passed on has no receipt.
bool Peer::update_is_redundant(ObjectId object, const OwnObject& own, SimTime t, const KinematicState& truth,
                    const KinematicState& ghost) const {
  if (!tracks_acknowledgements()) return false;
  if (is_motionless(truth) && is_motionless(ghost) && is_acknowledged_by_all(own)) return true;
  return !own.driven && (awaits_decision_on(object) || t - decisions_.last(object) < config_.policy.time_threshold);
}

bool Peer::tracks_acknowledgements() const { return !grid_.cuts() && config_.relay.through == kNobody; }

// When a tick has to look next at an object that physics moves and of which no update is due at t. Where it stands, and
// its ghost too, that is when its time is up: what changes that before changes a timeline, or calls look_at().
SimTime Peer::next_check(ObjectId object, const OwnObject& own, SimTime t, const GhostError& error) const {
  const PublishPolicy& policy = config_.policy;
  if (policy.snapshots_hz > 0) return t;
  if (!replica_->truth.is_at_rest_from(object, t) || !replica_->ghosts.is_at_rest_from(object, t)) return t;
  // Something close to it, the budget or another update that goes out may ask for one.
  const GhostError most{error.distance_m / policy.piggyback_fraction, error.angle_rad / policy.piggyback_fraction};
  if (due(policy, least_threshold_m(object), most, t, t)) return t;
  return *own.last_sent + longest_interval(policy, tracks_acknowledgements() && is_acknowledged_by_all(own));
}

void Peer::schedule_check(ObjectId object) {
  if (const std::uint32_t index = own_index_[object.value]; index != kNoIndex) checks_.set(index, SimTime::min());
}

void Peer::schedule_all_checks() {
  for (std::size_t index = 0; index < checks_.size(); ++index) checks_.set(index, SimTime::min());
}

void Peer::schedule_checks_of_changed() {
  const auto check = [this](ObjectId object) { schedule_check(object); };
  replica_->truth.take_changed(check);
  replica_->ghosts.take_changed(check);
}

// What was told last of an own object was not true.
void Peer::republish(ObjectId object) {
  const auto own = own_objects_.find(object);
  if (own == own_objects_.end()) return;
  own->second.republish = true;
  schedule_check(object);
}

// Once it is known what this peer runs, and when that has become less.
void Peer::index_own_objects() {
  std::ranges::fill(own_index_, kNoIndex);
  checks_ = Schedule(own_objects_.size());
  for (std::uint32_t index = 0; const auto& [object, own] : own_objects_) own_index_[object.value] = index++;
  schedule_all_checks();
}

// `error`: of the ghost against the truth, which is that of `own` at t.
std::optional<PublishReason> Peer::why_due(ObjectId object, OwnObject& own, SimTime t, double threshold_m,
                                           const KinematicState& truth, const KinematicState& ghost,
                                           const GhostError& error) {
  const bool old = own.last_sent && t - *own.last_sent >= config_.policy.time_threshold;
  const bool redundant = old && update_is_redundant(object, own, t, truth, ghost);
  if (const auto reason = due(config_.policy, threshold_m, error, own.last_sent, t, redundant)) return reason;
  if (own.republish) return PublishReason::kDecision;
  if (own.resend) return PublishReason::kJoiner;
  if (has_left_region(own, truth.position)) return PublishReason::kRegion;
  if (is_worth_an_update(own, t, error)) return PublishReason::kGain;
  return std::nullopt;
}

// No error below it makes an update due, however close other objects are and whatever the budget has.
double Peer::least_threshold_m(ObjectId object) const {
  const PublishPolicy& policy = config_.policy;
  const double usual_m = policy.error_threshold_m.value_or(model_.scene->object(object).distance_threshold_m);
  const double tight_m = std::min(usual_m, policy.tight_threshold_m);
  return policy.wanted_error_m > 0.0 ? std::min(tight_m, policy.wanted_error_m) : tight_m;
}

// The update goes out at t and is of `at`, not after it. What physics moves names its law as it is and goes on from
// what was told: its truth and all its ghosts are one motion, to the last bit. Contact times are whole nanoseconds, and
// the same motion, rounded at another instant, may meet a wall in another one.
// Returns what it takes [bytes].
std::size_t Peer::publish_update(ObjectId object, OwnObject& own, SimTime at, SimTime t, PublishReason reason, double threshold_m) {
  const PublishPolicy& policy = config_.policy;
  own.budget.spend(policy, t);
  if (own.last_sent) {
    note_unacknowledged(own, t);
    const double interval_s = std::clamp(to_seconds(t - *own.last_sent), kIntervalMin_s, kIntervalMax_s);
    own.interval_s += (interval_s - own.interval_s) / 4.0;
  }
  own.last_sent = t;
  own.republish = false;
  const bool answers = std::exchange(own.resend, false);
  unpublished_changes_.erase(object);
  MotionModel law = replica_->truth.model_at(object, at);
  if (!own.driven && !sendable(law)) {
    law = at_rest_within_limits(replica_->truth.at(object, t));
    at = t;
    replica_->truth.set_base(object, t, law);
    ++counters_.states_out_of_range;
  }
  const bool exact = !own.driven && (policy.models || policy.order == ModelOrder::kSecond);
  MotionModel model = exact ? law : own.models ? own.models->choose() : as_model(policy.order, law.state);
  if (!sendable(model)) {
    model = at_rest_within_limits(law.state);
    ++counters_.states_out_of_range;
  }
  const double expected_error_m = own.models ? own.models->expected_error_m() : threshold_m;
  const Tolerance tolerance = own.driven
                                  ? rounding_tolerance(policy, threshold_m, own.bounding_radius_m, model.kind, expected_error_m)
                                  : Tolerance{};  // none: exact
  const EncodedUpdate& due =
      updates_due_.emplace_back(quantised({object, ++own.sequence, at, model, decisions_.last(object)}, tolerance), t);
  const UpdateRecord& record = due.record();
  if (exact && at == t) replica_->truth.set_base(object, t, record.model);
  replica_->ghosts.set_base(object, at, record.model);
  const std::size_t size_bytes = due.bytes().size();
  ++counters_.updates_out;
  counters_.update_bytes_out += size_bytes;
  ++counters_.update_sizes_out[static_cast<std::size_t>(std::ranges::lower_bound(kRecordSizes, size_bytes) -
                                                        kRecordSizes.begin())];
  outputs_.push_back(Published{t, object, size_bytes, threshold_m, reason});
  note_published(own, record, answers || reason == PublishReason::kFirst);
  own.to_repeat = record;
  own.times_sent = 1;
  copy_later(object, own);
  own.times_with_hello = 0;
  own.sent_in.clear();
  own.acknowledged_by.clear();
  return size_bytes;
}

// The error threshold in force: the tight one in close proximity.
double Peer::threshold_now_m(ObjectId object, SimTime t) {
  const PublishPolicy& policy = config_.policy;
  const double usual_m = policy.error_threshold_m.value_or(model_.scene->object(object).distance_threshold_m);
  const double tight_m = std::min(usual_m, policy.tight_threshold_m);
  if (!policy.track_proximity || tight_m == usual_m) return usual_m;
  const double left_s = time_to_contact_s(object, t, usual_m);
  if (!(left_s < policy.close_proximity_s)) return usual_m;
  return policy.threshold_by_time ? tight_m + (usual_m - tight_m) * left_s / policy.close_proximity_s : tight_m;
}

// Until the object could meet one of another peer (seed, table 4.1: remote-enslaved pairs only), not more than that; at
// least the policy's close proximity where nothing is close. By steps 0 where anything is.
double Peer::time_to_contact_s(ObjectId object, SimTime t, double threshold_m) {
  const bool by_time = config_.policy.threshold_by_time;
  double least_s = config_.policy.close_proximity_s;
  const collision::Body* body = model_.body(object);
  if (body == nullptr) return least_s;
  const KinematicState state = replica_->truth.at(object, t);
  for (const std::uint32_t number : model_.pairs_of(object)) {
    const CollisionPair& pair = model_.pairs[number];
    const ObjectId other = pair.collider == object ? pair.collidee : pair.collider;
    const PeerId other_owner = owner(other);
    if (other_owner == kNobody || other_owner == config_.id || !receives(other)) continue;
    ++counters_.proximity_tests;
    const KinematicState other_state = replica_->truth.at(other, t);
    const collision::MovingBody here{*body, state}, there{*model_.body(other), other_state};
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
