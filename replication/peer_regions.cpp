// Peer: which regions it listens to, which its objects are told in, and what it no longer hears of.
#include <algorithm>
#include <map>
#include <set>

#include "replication/peer.hpp"

namespace peerd::replication {
namespace {

// Who asks for what was told longer ago, or will be, has a broken clock.
constexpr Duration kSubscriptionAgeMax = std::chrono::seconds(10), kSubscriptionAheadMax = std::chrono::seconds(1);
// That somebody has entered a region is told so often at most: enough for one datagram in five lost.
constexpr std::uint32_t kSubscriptionCopies = 4;
// .. and that an object has gone.
constexpr std::uint32_t kHandoverCopies = 4;
// Then so many times more, on the best of links too: nothing else tells of a datagram that was lost. Each with a hello,
// with others of its kind or, that an object has gone, with whatever goes there, once that may be lost for another
// reason than the one before; at the latest in a hello's usual period.
constexpr std::uint32_t kSubscriptionRepeats = 2, kHandoverRepeats = 1;
constexpr Duration kRepeatsApart = std::chrono::milliseconds(100);
// From a need to the states: a tick until this peer notices, one until the others answer, one to spare.
constexpr int kTicksToStates = 3;

double extent_m(const collision::Body& body) { return body.center.norm() + body.radius_m; }

// Of what is announced: whether it goes out at t, once, where repeats are so far apart.
template <class Announcement>
bool is_due_to_send(const Announcement& a, SimTime t, Duration apart) {
  return a.sent_at != t && (a.copies > 0 || (a.repeats > 0 && t - *a.sent_at >= apart));
}

template <class Announcement>
void note_sent(Announcement& a, SimTime t) {
  --(a.copies > 0 ? a.copies : a.repeats);
  a.sent_at = t;
}

}  // namespace

const UpdateRecord* Peer::last_update_of(ObjectId object) const {
  const auto at = last_updates_.find(object);
  return at == last_updates_.end() ? nullptr : &at->second;
}

// ---- what this peer listens to ----

// How long it takes from joining a region until the states of what is there have come: the word that this peer is
// there, and the answer.
Duration Peer::state_request_takes() const {
  return 2 * longest_latency() + kTicksToStates * Duration{std::chrono::seconds(1)} / config_.tick_hz;
}

Duration Peer::lookahead() const { return config_.regions.lookahead.value_or(state_request_takes()); }

// Farthest distances from own objects at which what others run may touch them.
void Peer::measure_contact_ranges(std::span<const std::uint32_t> pairs) {
  if (!grid_.cuts()) return;
  for (const std::uint32_t number : pairs) {
    const CollisionPair& pair = model_.pairs[number];
    if (!has_two_owners(pair.collider, pair.collidee)) continue;
    const double within_m = extent_m(*model_.body(pair.collider)) + extent_m(*model_.body(pair.collidee));
    for (const ObjectId object : {pair.collider, pair.collidee}) {
      const auto own = own_objects_.find(object);
      if (own != own_objects_.end()) own->second.contact_range_m = std::max(own->second.contact_range_m, within_m);
    }
  }
}

// What matters to this peer, as far as its own movement can take it until the states of a region that is joined now
// have come. None: everything.
std::optional<std::vector<Area>> Peer::areas(SimTime t) const {
  if (!config_.interest_radius_m || is_decision_server()) return std::nullopt;
  // What somebody runs is told where its origin is.
  const double radius_m = *config_.interest_radius_m + remote_reach_m_, ahead_s = to_seconds(lookahead());
  std::vector<Area> areas;
  const std::optional<Viewpoint>& view = config_.decisions.viewpoint;
  if (view && !view->object) {
    areas.push_back({view->pose.position, radius_m});
  } else if (view) {
    const ObjectId carrier = *view->object;
    if (!receives(carrier)) return std::nullopt;  // it may be anywhere
    const KinematicState state = own_objects_.contains(carrier) ? truth(carrier, t) : ghost(carrier, t);
    const Vec3 arm = view->pose.position;
    const double speed_m_s = state.velocity.norm() + state.angular_velocity_body.norm() * arm.norm();
    areas.push_back({state.pose() * arm, radius_m + speed_m_s * ahead_s});
  }
  // Close proximity is looked for so long ahead, on top.
  const double near_s = config_.policy.track_proximity ? config_.policy.close_proximity_s : 0.0;
  for (const auto& [object, own] : own_objects_) {
    const KinematicState state = truth(object, t);
    const double speed_m_s = state.velocity.norm();
    if (!view) areas.push_back({state.position, radius_m + speed_m_s * ahead_s});
    if (own.contact_range_m == 0.0) continue;
    areas.push_back(
        {state.position, own.contact_range_m + (speed_m_s + config_.regions.fastest_m_s) * (ahead_s + near_s)});
  }
  return areas;
}

void Peer::follow_interest(SimTime t) {
  if (!grid_.cuts()) return;
  if (config_.policy.predict_collisions) counters_.predictions_skipped += unreceived_pairs_;
  const auto wanted = areas(t);
  for (const Interest::Change& change : wanted ? interest_.follow(t, *wanted) : interest_.follow_all(t)) {
    if (change.joined) {
      join(change.region);
    } else {
      leave_region(change.region, t);
    }
  }
  if (last_tick_ % config_.tick_hz == 0) expire_silent_objects(t);
}

void Peer::join(RegionId region) {
  ++counters_.regions_joined;
  members_.reset_loss_of(region);
  outputs_.push_back(Join{region});
  request_states_of(region);
}

// Of everybody who has told of something there until now.
void Peer::request_states_of(RegionId region) {
  const SimTime since = clock_.to_session(*called_at_);  // not the tick's own time, which may be long past
  pending_subscriptions_.push_back({{region, since}, copies_against(loss(), kSubscriptionCopies), kSubscriptionRepeats});
}

void Peer::leave_region(RegionId region, SimTime t) {
  ++counters_.regions_left;
  outputs_.push_back(Leave{region});
  std::erase_if(pending_subscriptions_, [&](const PendingSubscription& e) { return e.subscription.region == region; });
  std::vector<ObjectId> unreceived;
  for (const auto& [object, reception] : last_receptions_) {
    if (reception.region == region) unreceived.push_back(object);
  }
  for (const ObjectId object : unreceived) leave_interest(object, t);
}

// Of the regions that this peer has entered, at most so many, to say so. Where nothing goes anyway, none before it is
// time for one of them.
std::vector<Subscription> Peer::take_subscriptions(std::size_t most, bool goes_anyway) {
  const SimTime t = tick_time(last_tick_);
  const auto must_go = [&](const PendingSubscription& e) { return is_due_to_send(e, t, config_.hello_period); };
  std::vector<Subscription> now;
  if (!goes_anyway && std::ranges::none_of(pending_subscriptions_, must_go)) return now;
  for (PendingSubscription& e : pending_subscriptions_) {
    if (now.size() == most) break;
    if (!is_due_to_send(e, t, kRepeatsApart)) continue;
    note_sent(e, t);
    now.push_back(e.subscription);
  }
  std::erase_if(pending_subscriptions_, [](const PendingSubscription& e) { return e.copies + e.repeats == 0; });
  return now;
}

// To everybody: who has objects in a region need not listen to it.
void Peer::announce_subscriptions() {
  for (;;) {
    Message m = blank();
    m.subscriptions = take_subscriptions(kSubscriptionsMax, false);
    if (m.subscriptions.empty()) return;
    send(m);
  }
}

// ---- what this peer hears of ----

// False for what has gone where this peer does not listen: the update says where it is, and that this was the last.
bool Peer::accept_by_region(const UpdateRecord& update, SimTime session_now) {
  if (!grid_.cuts()) return true;
  const Vec3& position = update.model.state.position;
  if (!interest_.receives(position)) {
    leave_interest(update.object, session_now);
    return false;
  }
  last_receptions_.insert_or_assign(update.object, LastReception{grid_.region_of(position), session_now});
  // Watched before it is told where it is: what it has met since then counts.
  if (unreceived_.erase(update.object) > 0) {
    unreceived_pairs_ -= pairs_with_received(update.object);
    shown_.erase(update.object);  // what has been drawn since means nothing: it is shown at once where it is
    watch_decided_pairs(model_.pairs_of(update.object));
  }
  return true;
}

void Peer::stop_receiving(ObjectId object) {
  if (unreceived_.insert(object).second) unreceived_pairs_ += pairs_with_received(object);
  last_receptions_.erase(object);
  last_updates_.erase(object);
}

std::size_t Peer::pairs_with_received(ObjectId object) const {
  return static_cast<std::size_t>(std::ranges::count_if(model_.pairs_of(object), [&](std::uint32_t number) {
    const CollisionPair& pair = model_.pairs[number];
    return receives(pair.collider == object ? pair.collidee : pair.collider);
  }));
}

void Peer::leave_interest(ObjectId object, SimTime t) {
  if (!receives(object)) return;
  ++counters_.sights_lost;
  stop_receiving(object);
  colliding_.forget(object, t);
  watch_decided_pairs(model_.pairs_of(object));
}

// The word that an object has gone may be lost, all its copies. Every owner speaks once in the time threshold, if that
// is this peer's too and there are bytes for it: who is silent for longer is asked before it is forgotten.
void Peer::expire_silent_objects(SimTime t) {
  const Duration half = config_.policy.time_threshold / 2, latency = longest_latency();
  const Duration answered = std::max(half + latency, state_request_takes());
  std::set<RegionId> questioned;
  std::vector<ObjectId> silent;
  for (auto& [object, reception] : last_receptions_) {
    if (reception.requested_at) {
      if (t - *reception.requested_at > answered) silent.push_back(object);
    } else if (t - reception.at > 3 * half + latency) {
      reception.requested_at = t;
      questioned.insert(reception.region);
    }
  }
  for (const RegionId region : questioned) request_states_of(region);
  for (const ObjectId object : silent) leave_interest(object, t);
}

// ---- where own objects are told ----

RegionId Peer::region_of_object(ObjectId object) const {
  const auto own = own_objects_.find(object);
  if (own != own_objects_.end() && own->second.published_position) return grid_.region_of(*own->second.published_position);
  const auto reception = last_receptions_.find(object);
  return reception == last_receptions_.end() ? kWholeScene : reception->second.region;
}

// Whether it is farther from the cell that it was told in than others grow their areas for.
bool Peer::has_left_region(const OwnObject& own, const Vec3& position) const {
  if (!grid_.cuts() || !own.published_position || grid_.region_of(position) == grid_.region_of(*own.published_position)) return false;
  return grid_.outside_m(position, *own.published_position) > config_.regions.hysteresis.margin_m;
}

// The region is that of the position as it was rounded, so that receivers know it too.
void Peer::note_published(OwnObject& own, const UpdateRecord& update, bool receiver_may_hold_nothing) {
  if (!grid_.cuts()) return;
  const RegionId now = grid_.region_of(update.model.state.position);
  const RegionId before = own.published_position ? grid_.region_of(*own.published_position) : now;
  own.copy_until_received = before != now || receiver_may_hold_nothing;
  own.published_position = update.model.state.position;
  if (before == now) return;
  ++counters_.handovers;
  announce_handover(update, before, now);
}

// Where the object was told before, that it is gone. What is told next in its new region takes none of that back; only
// its return does. Regions that it left earlier hear where it is now.
void Peer::announce_handover(const UpdateRecord& update, RegionId from, RegionId to) {
  const Handover handover{update.object, update.sequence, to};
  std::erase_if(pending_handovers_,
                [&](const PendingHandover& d) { return d.handover.object == handover.object && (d.from == from || d.from == to); });
  for (PendingHandover& d : pending_handovers_) {
    if (d.handover.object == handover.object) d.handover = handover;
  }
  pending_handovers_.push_back({handover, from, copies_against(loss(), kHandoverCopies), kHandoverRepeats});
}

// Copies go out a tick apart.
void Peer::sort_handovers(std::map<RegionId, Batch>& due) {
  const SimTime t = tick_time(last_tick_);
  for (const Duration apart : {config_.hello_period, kRepeatsApart}) {  // first what must go, then what may with it
    for (PendingHandover& d : pending_handovers_) {
      if (!is_due_to_send(d, t, apart) || (apart == kRepeatsApart && !due.contains(d.from))) continue;
      note_sent(d, t);
      due[d.from].handovers.push_back(d.handover);
    }
  }
  std::erase_if(pending_handovers_, [](const PendingHandover& d) { return d.copies + d.repeats == 0; });
}

void Peer::on_handovers(PeerId sender, std::span<const Handover> handovers, SimTime session_now) {
  for (const Handover& g : handovers) {
    if (owner(g.object) != sender) {
      drop(sender, "not_owner");
      continue;
    }
    std::uint32_t& last = members_.find(sender)->last_sequence[g.object];
    if (g.sequence < last) continue;  // it has come back, or farther, since
    if (interest_.joined(g.to)) {     // its update is on the way; if this peer leaves before it comes, it is gone
      if (const auto reception = last_receptions_.find(g.object); reception != last_receptions_.end()) {
        reception->second.region = g.to;
        reception->second.requested_at.reset();
      }
      continue;
    }
    last = g.sequence;
    leave_interest(g.object, session_now);
  }
}

// Somebody listens to those regions who may know nothing of what is there.
void Peer::on_subscriptions(PeerId sender, std::span<const Subscription> subscriptions, SimTime session_now) {
  if (!grid_.cuts()) return;
  std::map<RegionId, SimTime> since;  // the last of each
  for (const Subscription& e : subscriptions) {
    if (e.since < session_now - kSubscriptionAgeMax || e.since > session_now + kSubscriptionAheadMax) {
      drop(sender, "entered_time");
      continue;
    }
    SimTime& last = since.try_emplace(e.region, e.since).first->second;
    last = std::max(last, e.since);
  }
  if (since.empty()) return;
  for (auto& [object, own] : own_objects_) {
    if (!own.published_position) continue;
    const auto there = since.find(grid_.region_of(*own.published_position));
    if (there == since.end() || (own.last_sent && *own.last_sent > there->second)) continue;
    own.resend = true;
    schedule_check(object);
  }
}

// Two own objects, or an own and another's, that are told in different regions have met, as all predict who hear of
// both. Who hears of one of them must be told what became of it.
void Peer::republish_across_regions(const ContactEvent& contact) {
  if (!grid_.cuts() || owner(contact.collider) == kNobody || owner(contact.collidee) == kNobody) return;
  if (region_of_object(contact.collider) == region_of_object(contact.collidee)) return;
  for (const ObjectId object : {contact.collider, contact.collidee}) republish(object);
}

}  // namespace peerd::replication
