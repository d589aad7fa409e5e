#include "replication/objects/updates/publication.hpp"

#include <algorithm>
#include <cassert>
#include <functional>
#include <limits>
#include <utility>

#include "core/prefetch.hpp"
#include "replication/objects/updates/rounding.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// The smoothed interval between two updates stays within these [s].
constexpr double kIntervalMin_s = 0.1, kIntervalMax_s = 0.5;
// An update tells a driven object's place as exactly as this.
constexpr double kCoarsestStep_m = 1.0 / (1 << -kStepMost_log2);
// A peer that is short of bytes waits for so many before the next datagram: a datagram with one record at each tick
// would be half header.
constexpr double kSmallestWorthwhileDatagram_bytes = 256.0;
// A datagram's header (version, sender, number, the incarnation's low bits) leaves so much for records.
constexpr std::size_t kRecordsMax_bytes = kDatagramMax_bytes - 19 - kUpdatesHeader_bytes - kDecisionsHeader_bytes;
// A handover: three varints; the first also takes the list's tag and length.
constexpr std::size_t kHandoverMax_bytes = 15 + 4;
// While an object is checked, what a tick needs of those that come so much later is fetched from memory.
constexpr std::ptrdiff_t kOwnAhead = 4, kSamplesAhead = 2;

// The ghost of what rests elsewhere is mended this long after the object's last update, by when decisions on their way
// have come. Where the ghost can't lie there, because another ghost does, the object is published once in this time and
// not at each tick.
constexpr Duration kRestMendedAfter = std::chrono::seconds(1);
// An object has come to rest once it has stood this long: those of a rack that is struck stand for a moment.
constexpr Duration kRestKnownAfter = std::chrono::milliseconds(1500);

// Whether physics has brought the object to rest at another place than its ghost. The ghost would stand there for a
// minute, or creep away as far as the threshold allows, and physics can be published exactly.
bool rests_elsewhere(const OwnObject& own, const KinematicState& truth, const GhostError& error) {
  const bool is_elsewhere = error.distance_m > kSamePlace_m || error.angle_rad > kSameAngle_rad;
  return !own.driven && is_elsewhere && is_motionless(truth);
}

// Whether receivers take the model: it is not too far or too fast. A model that is may come from what drives the
// object, from a fall of days, or from a forged decision.
bool sendable(const MotionModel& model) { return acceptable(model.state) && within_limits(model); }

}  // namespace

Publication::Publication(const PeerConfig& config, const ModelInForce& model, const Membership& members,
                         const Owners& owners, OwnObjects& own, Launches& launches, Replica& replica,
                         RegionSubscriptions& regions, ContactDecisions& decisions, const TickGrid& ticks,
                         Outbox& outbox, PeerCounters& counters)
    : config_(config),
      members_(members),
      owners_(owners),
      own_(own),
      launches_(launches),
      replica_(replica),
      regions_(regions),
      decisions_(decisions),
      ticks_(ticks),
      outbox_(outbox),
      counters_(counters),
      thresholds_(config, model, owners, replica, counters),
      repeater_(config, members, own, !regions.cuts(), counters) {}

void Publication::restart() {
  updates_due_.clear();
  copies_due_.clear();
}

// ---- observing ----

void Publication::take(SimTime t, std::span<const OwnSample> samples) {
  MotionWorld& truth = replica_.truth();
  auto own = own_.begin();
  for (std::size_t i = 0; i < samples.size(); ++i) {  // most come in the same order
    const OwnSample& sample = samples[i];
    if (i + kOwnAhead < samples.size()) truth.prefetch(samples[i + kOwnAhead].object);
    if (own == own_.end() || own->first != sample.object) own = own_.map().find(sample.object);
    if (own == own_.end() || !own->second.driven) continue;  // lost to another peer, if only for a moment
    MotionModel law(sample.has_derivatives ? sample.state : own->second.poses.derive(t, sample.state.pose()));
    if (!acceptable(law.state)) {
      law.state = at_rest_within_limits(law.state);
      ++counters_.states_out_of_range;
    }
    // A carrier comes before what it carries, in the order of their ids.
    if (truth.is_carried(sample.object)) law.state = truth.in_carrier(sample.object, t, law.state);
    truth.set_base(sample.object, t, law);
    ++own;
  }
}

// Hands a driven object's state to what chooses its models; what physics moves names its law.
void Publication::observe(ObjectId object, OwnObject& own, SimTime t, double latency_s) {
  if (!config_.policy.models || !own.driven) return;
  if (!own.models) own.models.emplace(*config_.policy.models);
  own.models->push(t, replica_.truth().relative_at(object, t), Horizon{latency_s, own.interval_s});
}

// ---- finding what is due ----

// Whether an update is worth one of the budget: rounding its orientation may bring back as much as it mends.
bool Publication::is_worth_an_update(OwnObject& own, SimTime t, const GhostError& error) const {
  if (config_.policy.wanted_error_m == 0.0) return false;
  const auto least_gain_m = own.budget.least_gain_m(config_.policy, t);
  return least_gain_m &&
         error.distance_m > std::max(*least_gain_m, 2.0 * own.bounding_radius_m * kOrientationError_rad);
}

// Acknowledgements are tracked only without regions, which forget what is not published anew, and without a relay,
// whose updates are not acknowledged.
bool Publication::tracks_acknowledgements() const { return !regions_.cuts() && config_.relay.through == kNobody; }

// Whether another update would say what all receivers know. That is so where the object rests at a place that all peers
// have acknowledged, as exactly as an update tells it, or where a decision, which is still to come or from within the
// time threshold, says where physics takes it.
bool Publication::update_is_redundant(ObjectId object, const OwnObject& own, SimTime t, const KinematicState& truth,
                                      const KinematicState& ghost, const GhostError& error) const {
  if (!tracks_acknowledgements()) return false;
  const bool is_there = !own.driven || error.distance_m <= kCoarsestStep_m;
  if (is_there && is_motionless(truth) && is_motionless(ghost) && repeater_.is_acknowledged_by_all(own)) return true;
  return !own.driven &&
         (decisions_.awaits_decision_on(object) || t - decisions_.log().last(object) < config_.policy.time_threshold);
}

// The truth has this peer's own objects, and the ghosts have all: another peer's object rests on this one in the
// ghosts.
bool Publication::bears_another(ObjectId object, SimTime t) const {
  return replica_.truth().presses_another(object, t) || replica_.ghosts().presses_another(object, t);
}

// Whether the ghost of a driven object that stands is elsewhere, and others rest on it: all peers let those rest on the
// ghost.
bool Publication::is_support_elsewhere(ObjectId object, const OwnObject& own, SimTime t, const KinematicState& truth,
                                       const GhostError& error) const {
  return own.driven && error.distance_m > kSamePlace_m && is_motionless(truth) && bears_another(object, t);
}

// `error`: of the ghost against the truth, which is that of `own` at t.
std::optional<PublishReason> Publication::why_due(ObjectId object, OwnObject& own, SimTime t, double threshold_m,
                                                  const KinematicState& truth, const KinematicState& ghost,
                                                  const GhostError& error) const {
  const bool old = own.last_sent && t - *own.last_sent >= config_.policy.time_threshold;
  const bool redundant = old && update_is_redundant(object, own, t, truth, ghost, error);
  if (const auto reason = due(config_.policy, threshold_m, error, own.last_sent, t, redundant)) return reason;
  if (own.republish) return PublishReason::kDecision;
  if (own.resend) return PublishReason::kJoiner;
  if (regions_.has_left_region(own, replica_.truth().at(object, t).position)) return PublishReason::kRegion;
  if (is_worth_an_update(own, t, error)) return PublishReason::kGain;
  if (is_support_elsewhere(object, own, t, truth, error)) return PublishReason::kError;
  if (rests_elsewhere(own, truth, error) && t - *own.last_sent >= kRestMendedAfter &&
      t - replica_.truth().law_since(object, t) >= kRestKnownAfter) {
    return PublishReason::kError;
  }
  return std::nullopt;
}

// When a tick has to check an object next that physics moves and of which no update is due at t. Where it stands, and
// its ghost too, that is when its time is up: a change before that changes a timeline, or calls OwnObjects::check().
SimTime Publication::next_check(ObjectId object, const OwnObject& own, SimTime t, const KinematicState& truth,
                                const GhostError& error) const {
  const PublishPolicy& policy = config_.policy;
  if (policy.snapshots_hz > 0) return t;
  if (!replica_.truth().is_at_rest_from(object, t) || !replica_.ghosts().is_at_rest_from(object, t)) return t;
  // An object close to it, the budget or another update that goes out may ask for an update.
  const GhostError most{error.distance_m / policy.piggyback_fraction, error.angle_rad / policy.piggyback_fraction};
  if (due(policy, thresholds_.least_m(object), most, t, t)) return t;
  const Duration longest = longest_interval(policy, tracks_acknowledgements() && repeater_.is_acknowledged_by_all(own));
  return *own.last_sent + (rests_elsewhere(own, truth, error) ? std::min(longest, kRestMendedAfter) : longest);
}

bool Publication::published_since_tick(const OwnObject& own) const {
  return own.last_sent && *own.last_sent > ticks_.last_time();
}

// ---- making updates ----

void Publication::publish(SimTime t) {
  const double latency_s = to_seconds(members_.longest_mean_delay());
  assert(latency_s >= 0.0);
  MotionWorld &truths = replica_.truth(), &ghosts = replica_.ghosts();
  publish_changed(t);
  not_due_.clear();
  due_updates_.clear();
  replica_.take_changed([this](ObjectId object) { own_.check(object); });
  OwnObjects::Map& all = own_.map();
  for (std::size_t index = own_.next_to_check(0, t); index != all.size(); index = own_.next_to_check(index + 1, t)) {
    const auto at = all.nth(index);
    const std::ptrdiff_t left = all.end() - at;
    if (left > kOwnAhead) prefetch(at[kOwnAhead]);
    if (left > kSamplesAhead && at[kSamplesAhead].second.models) at[kSamplesAhead].second.models->prefetch();
    auto& [object, own] = *at;
    ++counters_.objects_looked_at;
    observe(object, own, t, latency_s);
    // An object that is carried is published relative to its carrier: when that is corrected, it needs no update.
    const KinematicState truth = truths.relative_at(object, t), ghost = ghosts.relative_at(object, t);
    // The way of an object that has met something is not known before the contact is decided: until then its truth is
    // no better than the ghosts.
    const bool undecided = !own.driven && decisions_.awaits_decision_on(object);
    const GhostError error = undecided ? GhostError{} : ghost_error(truth, ghost, own.bounding_radius_m);
    const double threshold_m = thresholds_.at(object, t);
    own.threshold_m = threshold_m;
    if (const auto reason = why_due(object, own, t, threshold_m, truth, ghost, error)) {
      if (config_.policy.bytes_per_s) {
        due_updates_.push_back({{object, &own, error, threshold_m}, *reason});
      } else {
        publish_update(object, own, t, t, *reason, threshold_m);
      }
      continue;
    }
    if (config_.policy.piggyback_fraction < 1.0) not_due_.push_back({object, &own, error, threshold_m});
    if (!own.driven && !undecided && is_motionless(truth))
      own_.check_from(index, next_check(object, own, t, truth, error));
  }
  publish_most_urgent(t);
  if (over_byte_budget_) return;
  publish_piggybacked(t);
  repeater_.copy(copies_due_);
}

// Makes as many of the due updates as the byte budget allows.
void Publication::publish_most_urgent(SimTime t) {
  const PublishPolicy& policy = config_.policy;
  if (!policy.bytes_per_s) return;
  std::vector<Vec3> eyes;  // the members' viewpoints; empty where a member has none: it sees everything
  for (const auto& [peer, member] : members_.all()) {
    const auto from = member.viewpoint ? decisions_.camera_pose(*member.viewpoint, t) : std::nullopt;
    if (!from) {
      eyes.clear();
      break;
    }
    eyes.push_back(from->position);
  }
  for (Due& due : due_updates_) {
    const Vec3 at = replica_.truth().at(due.what.object, t).position;
    double viewed_from_m = eyes.empty() ? 0.0 : std::numeric_limits<double>::infinity();
    for (const Vec3& from : eyes) viewed_from_m = std::min(viewed_from_m, (at - from).norm());
    const bool is_unpredictable = due.what.own->resend || due.what.own->republish ||
                                  (due.reason != PublishReason::kError && due.reason != PublishReason::kTime &&
                                   due.reason != PublishReason::kGain);
    const auto last_sent = is_unpredictable ? std::nullopt : due.what.own->last_sent;
    due.urgency = urgency(policy, due.what.threshold_m, due.what.error, last_sent, t, viewed_from_m);
  }
  std::ranges::stable_sort(due_updates_, std::greater{}, &Due::urgency);
  double left = outbox_.bytes().left(policy, t);
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

// An object of which no update is due but whose error has come so far goes with what is due, in a datagram that goes
// anyway.
void Publication::publish_piggybacked(SimTime t) {
  if (updates_due_.empty()) return;
  const RegionGrid& grid = regions_.grid();
  boost::container::small_vector<RegionId, 16> due_regions;
  for (const EncodedUpdate& u : updates_due_) {
    const RegionId region = grid.region_of(replica_.position_of(u.record()));
    if (std::ranges::find(due_regions, region) == due_regions.end()) due_regions.push_back(region);
  }
  const double share = config_.policy.piggyback_fraction;
  assert(share > 0.0 && share <= 1.0);
  for (const Checked& w : not_due_) {
    const RegionId region = grid.region_of(replica_.truth().at(w.object, t).position);
    if (std::ranges::find(due_regions, region) == due_regions.end()) continue;
    const GhostError grown{w.error.distance_m / share, w.error.angle_rad / share};
    auto reason = due(config_.policy, w.threshold_m, grown, w.own->last_sent, t, true);
    if (!reason && is_worth_an_update(*w.own, t, grown)) reason = PublishReason::kGain;
    if (reason) publish_update(w.object, *w.own, t, t, *reason, w.threshold_m);
  }
}

// A change that nobody could know comes before all else, and of the instant at which it began: what follows from it the
// receivers find themselves, and so do this peer's ghosts, before they are asked whether anything else is worth an
// update.
void Publication::publish_changed(SimTime t) {
  bool published = false;
  for (const auto& [object, since] : std::map(launches_.unpublished())) {
    OwnObject& own = own_.at(object);
    if (published_since_tick(own)) continue;
    const bool follows = config_.policy.predict_collisions || replica_.truth().law_since(object, t) == since;
    publish_update(object, own, follows ? since : t, t, PublishReason::kFirst, thresholds_.at(object, t));
    published = true;
  }
  if (published) replica_.advance_ghosts(t);
}

bool Publication::is_urgent(const OwnSample& sample, SimTime t) const {
  const OwnObject* own = std::as_const(own_).find(sample.object);
  if (own == nullptr || !own->driven || over_byte_budget_ || published_since_tick(*own)) return false;
  if (!acceptable(sample.state)) return false;  // the tick publishes a state within the limits in its place
  assert(sample.has_derivatives);
  const KinematicState relative = replica_.truth().in_carrier(sample.object, t, sample.state);
  const GhostError error =
      ghost_error(relative, replica_.ghosts().relative_at(sample.object, t), own->bounding_radius_m);
  return due(config_.policy, thresholds_.least_m(sample.object), error, own->last_sent, t).has_value();
}

void Publication::publish_at_once(SimTime t, std::span<const OwnSample* const> samples) {
  publish_changed(t);
  for (const OwnSample* sample : samples) {
    OwnObject& own = own_.at(sample->object);
    const double threshold_m = thresholds_.at(sample->object, t);
    const KinematicState ghost = replica_.ghosts().relative_at(sample->object, t);
    const KinematicState truth = replica_.truth().in_carrier(sample->object, t, sample->state);
    const GhostError error = ghost_error(truth, ghost, own.bounding_radius_m);
    const auto reason = why_due(sample->object, own, t, threshold_m, truth, ghost, error);
    if (!reason) continue;
    observe(sample->object, own, t, to_seconds(members_.longest_mean_delay()));
    publish_update(sample->object, own, t, t, *reason, threshold_m);
  }
}

// The drive of an object that others bear. Receivers go back no further than kWorldHistory.
std::optional<Drive> Publication::drive_of(ObjectId object, const OwnObject& own, SimTime at) const {
  const MotionWorld& truth = replica_.truth();
  if (own.driven || !truth.is_borne(object)) return std::nullopt;
  const Vec3 free = truth.vector_in_carrier(object, at, truth.unborne_acceleration(object, at));
  if (!acceptable(free)) return std::nullopt;
  return Drive{free, std::clamp(own.driven_since.value_or(at), at - kWorldHistory, at)};
}

// The update goes out at t and is of `at`, not after it. What physics moves names its law as it is and goes on from
// what was published: its truth and all its ghosts are one motion, to the last bit. Contact times are whole
// nanoseconds, and the same motion, rounded at another instant, may meet a wall in another one.
// Returns the record's size [bytes].
std::size_t Publication::publish_update(ObjectId object, OwnObject& own, SimTime at, SimTime t, PublishReason reason,
                                        double threshold_m) {
  const PublishPolicy& policy = config_.policy;
  own.budget.spend(policy, t);
  if (own.last_sent) {
    repeater_.before_update(own, t);
    const double interval_s = std::clamp(to_seconds(t - *own.last_sent), kIntervalMin_s, kIntervalMax_s);
    own.interval_s += (interval_s - own.interval_s) / 4.0;
  }
  own.last_sent = t;
  own.republish = false;
  const bool answers = std::exchange(own.resend, false);
  launches_.note_published(object);
  MotionModel law = replica_.truth().model_at(object, at);
  if (!own.driven && !sendable(law)) {
    law = at_rest_within_limits(replica_.truth().relative_at(object, t));
    at = t;
    replica_.truth().set_base(object, t, law);
    ++counters_.states_out_of_range;
  }
  const bool exact = !own.driven && (policy.models || policy.order == ModelOrder::kSecond);
  const bool has_choice = own.models && at == t;  // what it has seen goes until t
  MotionModel model = exact ? law : has_choice ? own.models->choose() : as_model(policy.order, law.state);
  if (!sendable(model)) {
    model = at_rest_within_limits(law.state);
    ++counters_.states_out_of_range;
  }
  const double expected_error_m = own.models ? own.models->expected_error_m() : threshold_m;
  // An object that physics moves is published exactly: resting against something and rounded, it could lie inside it.
  const Tolerance tolerance =
      own.driven ? rounding_tolerance(policy, threshold_m, own.bounding_radius_m, model.kind, expected_error_m)
                 : Tolerance{};
  const UpdateRecord as_it_is{object,
                              ++own.sequence,
                              at,
                              model,
                              decisions_.last_on(object),
                              {},
                              replica_.model().carrier_of(object),
                              drive_of(object, own, at)};
  assert(at <= t && own.sequence > 0);
  UpdateRecord rounded = quantised(as_it_is, tolerance);
  // A driven object that stands and bears others is published exactly, too: physics has brought them to the height at
  // which it stands, and publishes that exactly.
  if (own.driven && is_motionless(rounded.model.state) && bears_another(object, at)) {
    rounded.model = at_rest(model.state.pose());
    rounded = quantised(rounded, Tolerance{});
  }
  const EncodedUpdate& due = updates_due_.emplace_back(rounded, t);
  const UpdateRecord& record = due.record();
  // A law that began at t is published as it is. To lay it again would retract the answers of others to it at t.
  const bool is_new = replica_.truth().law_since(object, t) == t;
  if (exact && at == t && !is_new) replica_.truth().restate(object, t, record.model);
  replica_.ghosts().set_base(object, at, record.model, {}, replica_.base_of(record).free);
  replica_.keep_update(record);
  decisions_.on_drive(record);
  const std::size_t size_bytes = due.bytes().size();
  ++counters_.updates_out;
  counters_.update_bytes_out += size_bytes;
  ++counters_.update_sizes_out[static_cast<std::size_t>(std::ranges::lower_bound(kRecordSizes, size_bytes) -
                                                        kRecordSizes.begin())];
  outbox_.push(Published{t, object, size_bytes, threshold_m, reason});
  regions_.on_published(own, record, answers || reason == PublishReason::kFirst);
  repeater_.on_update(object, own, record);
  return size_bytes;
}

void Publication::repeat_updates(HostTime now, SimTime session_now) {
  if (!over_byte_budget_) repeater_.repeat(now, session_now, updates_due_);
}

// Whether this peer looks for contacts of the two, and has found none since then.
bool Publication::has_found_none(ObjectId a, ObjectId b, SimTime since) const {
  const bool is_left = decisions_.awaits_decision_on(a) && decisions_.awaits_decision_on(b);
  return owners_.have_two(a, b) && decisions_.watch().searches(a, b) && replica_.model().is_answered(a, b) &&
         decisions_.log().last(a, b) < since && !is_left;
}

void Publication::on_predicted_contact(const ContactEvent& contact, SimTime t) {
  if (owners_.of(contact.collider) == kNobody || owners_.of(contact.collidee) == kNobody) return;
  if (regions_.cuts() && regions_.region_of(contact.collider) != regions_.region_of(contact.collidee)) {
    for (const ObjectId object : {contact.collider, contact.collidee}) own_.republish(object);
  }
  const SimTime tick_before = ticks_.time_of(ticks_.last() - 1);
  if (contact.at <= tick_before || over_byte_budget_) return;
  if (!has_found_none(contact.collider, contact.collidee, tick_before)) return;
  for (const ObjectId object : {contact.collider, contact.collidee}) {
    OwnObject* const own = own_.find(object);
    if (own == nullptr || !own->driven || !own->last_sent) continue;
    const SimTime before = contact.at - Duration{1};
    const KinematicState truth = replica_.truth().relative_at(object, before);
    if (is_at_same_place(truth, replica_.ghosts().relative_at(object, before))) continue;
    publish_update(object, *own, before, t, PublishReason::kError, thresholds_.at(object, t));
  }
}

// ---- datagrams ----

// Each region's records go by themselves. Copies of decisions and handovers go out a tick apart.
void Publication::flush(bool with_decisions) {
  if (regions_.cuts()) {
    std::map<RegionId, std::vector<EncodedUpdate>> updates;
    if (with_decisions) updates[kWholeScene];
    for (const EncodedUpdate& u : updates_due_) {
      updates[regions_.grid().region_of(replica_.position_of(u.record()))].push_back(u);
    }
    std::map<RegionId, std::vector<Handover>> handovers;
    if (with_decisions) {
      handovers = regions_.take_handovers([&](RegionId region) { return updates.contains(region); });
      for (const auto& [region, due] : handovers) updates[region];
    }
    for (auto& [region, records] : updates) {
      const auto due = handovers.find(region);
      flush_region(region, due == handovers.end() ? std::span<const Handover>{} : due->second, records,
                   with_decisions && region == kWholeScene);
    }
  } else {
    flush_region(kWholeScene, {}, updates_due_, with_decisions);
  }
  updates_due_.clear();
  if (copies_due_.empty()) return;
  std::swap(updates_due_, copies_due_);
  flush(false);
}

void Publication::flush_region(RegionId region, std::span<const Handover> handovers, std::span<EncodedUpdate> updates,
                               bool with_decisions) {
  Message m = outbox_.blank();
  std::size_t used_bytes = 0, first = 0, next = 0;  // m goes with the updates [first, next)
  const auto send_all = [&] { send(m, region, updates.subspan(first, next - first)); };
  const auto make_room = [&](std::size_t size_bytes) {
    assert(size_bytes <= kRecordsMax_bytes);
    if (used_bytes > 0 && used_bytes + size_bytes > kRecordsMax_bytes) {
      send_all();
      m = outbox_.blank();
      first = next;
      used_bytes = 0;
    }
    used_bytes += size_bytes;
  };
  for (const Handover& g : handovers) {
    make_room(kHandoverMax_bytes);
    m.handovers.push_back(g);
  }
  for (; next < updates.size(); ++next) {
    EncodedUpdate& update = updates[next];
    update.count_from(updates[first].record().at);
    make_room(update.bytes().size());
    update.count_from(updates[first].record().at);  // from itself, where it comes first in another datagram
  }
  if (with_decisions) {
    for (DecisionLog::Entry& entry : decisions_.entries()) {
      if (entry.copies == 0) continue;
      make_room(encoded_size_bytes(entry.record));
      m.decisions.push_back(entry.record);
      --entry.copies;
    }
  }
  if (used_bytes > 0) send_all();
}

void Publication::send(Message& message, RegionId region, std::span<const EncodedUpdate> updates) {
  const bool is_for_all = region == kWholeScene;
  const std::optional<std::uint32_t> number =
      is_for_all ? regions_.send_to_peers(message, updates) : outbox_.send(message, region, updates);
  if (is_for_all && members_.is_large() && std::ranges::any_of(message.decisions, [&](const DecisionRecord& d) {
        return decisions_.is_of_scene(d);  // whose the scene object is concerns all
      })) {
    Message copy = outbox_.blank();
    copy.decisions = message.decisions;
    (void)outbox_.send(copy);
  }
  if (!number) return;
  if (is_for_all) {
    for (const EncodedUpdate& u : updates) repeater_.note_sent(u.record(), *number);
  }
  decisions_.note_sent(message.decisions, *number);
}

}  // namespace peerd::replication
