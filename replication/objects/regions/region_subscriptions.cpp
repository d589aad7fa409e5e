#include "replication/objects/regions/region_subscriptions.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <ranges>
#include <set>
#include <utility>

#include "core/scene/bounding_radius.hpp"
#include "replication/physics/parts/part_at.hpp"

namespace peerd::replication {
namespace {

// Subscriptions from longer ago, or from farther ahead, come from a broken clock.
constexpr Duration kSubscriptionAgeMax = std::chrono::seconds(10), kSubscriptionAheadMax = std::chrono::seconds(1);
// The most copies of an announcement: enough for one datagram in five lost.
constexpr std::uint32_t kSubscriptionCopies = 4, kHandoverCopies = 4;
// Repetitions after the copies, on the best of links too, for nothing else shows that a datagram was lost. A
// subscription goes with a hello or with others of its kind, a handover with whatever goes there, once that may be
// lost for another reason than the one before; at the latest in a hello's usual period.
constexpr std::uint32_t kSubscriptionRepeats = 2, kHandoverRepeats = 1;
constexpr Duration kRepeatsApart = std::chrono::milliseconds(100);
// Ticks from a need to the states: one until this peer notices, one until the others answer, one to spare.
constexpr int kTicksToStates = 3;
// The corners of a box are no farther away than this many times the farthest point in it: sqrt(3), rounded up.
constexpr double kCorner = 1.7320508075688774;

}  // namespace

bool RegionSubscriptions::Announcement::is_due(SimTime t, Duration apart) const {
  return sent_at != t && (copies > 0 || (repeats > 0 && t - *sent_at >= apart));
}

void RegionSubscriptions::Announcement::note_sent(SimTime t) {
  assert(!is_over());
  --(copies > 0 ? copies : repeats);
  sent_at = t;
}

RegionSubscriptions::RegionSubscriptions(const PeerConfig& config, const ModelInForce& model, Membership& members,
                                         const Owners& owners, OwnObjects& own, Replica& replica, const TickGrid& ticks,
                                         Outbox& outbox, PeerCounters& counters,
                                         OnReceptionChanged on_reception_changed)
    : config_(config),
      model_(model),
      members_(members),
      owners_(owners),
      own_(own),
      replica_(replica),
      ticks_(ticks),
      outbox_(outbox),
      counters_(counters),
      on_reception_changed_(std::move(on_reception_changed)),
      grid_(config.regions.grid()),
      interest_(grid_, config.regions.hysteresis) {
  assert(on_reception_changed_);
}

void RegionSubscriptions::drop(PeerId sender, const char* reason) {
  ++counters_.drops[reason];
  if (Member* member = members_.find(sender)) ++member->drops[reason];
}

// ---- the regions that this peer listens to ----

// The time from joining a region until the states of its objects have come: the way of the subscription, and that of
// the answer.
Duration RegionSubscriptions::state_request_takes() const {
  return 2 * members_.longest_latency() + kTicksToStates * Duration{std::chrono::seconds(1)} / config_.tick_hz;
}

void RegionSubscriptions::measure_contact_ranges(const PairNumbers& pairs, bool anew) {
  if (anew) contact_ranges_.clear();
  if (!grid_.cuts()) return;
  forget_ranges_of_others();
  for (const std::uint32_t number : pairs) {
    assert(number < model_->pairs.size());
    const auto [first, end] = model_->part_pairs_of_pair(number);
    for (std::uint32_t k = first; k < end; ++k) {
      const PartPair parts = model_->part_pairs[k];
      if (parts.fixed) continue;
      note_contact_range(parts, true);
      note_contact_range(parts, false);
    }
  }
}

// An object may have gone to another owner, or to none.
void RegionSubscriptions::forget_ranges_of_others() {
  assert(grid_.cuts());
  const auto is_mine = [&](std::uint32_t node) { return own_.contains(model_->nodes[node].object); };
  std::erase_if(contact_ranges_, [&](const auto& range) {
    return std::ranges::none_of(chain_of(range.first, ModelNode::kNone), is_mine);
  });
  for (auto& [reach, partners] : contact_ranges_) {
    std::erase_if(partners.moving,
                  [&](const auto& partner) { return !is_anothers(model_->nodes[partner.first].object); });
  }
}

// Notes what the one side may meet, where own objects move it and those of others the other side.
void RegionSubscriptions::note_contact_range(const PartPair& parts, bool of_collider) {
  const auto is_mine = [&](std::uint32_t node) { return own_.contains(model_->nodes[node].object); };
  if (!model_->any_mover(parts, of_collider, is_mine)) return;
  const auto is_another = [&](std::uint32_t node) { return is_anothers(model_->nodes[node].object); };
  if (!model_->any_mover(parts, !of_collider, is_another)) return;
  const CollisionPair& pair = model_->pairs[parts.pair];
  const bool boxes = pair.type == CollisionType::kBox;
  const Reach collider = boxes ? Reach{ModelNode::kNone, pair.collider} : Reach{parts.a, {}};
  const Reach collidee = boxes ? Reach{ModelNode::kNone, pair.collidee} : Reach{parts.b, {}};
  const Reach &mine = of_collider ? collider : collidee, &other = of_collider ? collidee : collider;
  note_partners(contact_ranges_[mine], other, parts.common);
}

bool RegionSubscriptions::is_anothers(ObjectId object) const {
  const PeerId owner = owners_.of(object);
  return owner != kNobody && owner != config_.id;
}

void RegionSubscriptions::note_partners(Partners& partners, const Reach& partner, std::uint32_t common) const {
  for (const std::uint32_t node : chain_of(partner, common)) {
    if (!is_anothers(model_->nodes[node].object)) continue;
    const bool whole = partner.part == ModelNode::kNone;
    const bool is_its_body =
        whole ? model_->parts_of_node[node] == std::vector{node} && model_->nodes[node].object == partner.end
              : partner.part == node;
    if (is_its_body) {
      partners.fixed_m = std::max(partners.fixed_m, (whole ? kCorner : 1.0) * model_->bodies[node].extent_m());
    } else {
      partners.moving.emplace(node, partner);
    }
  }
}

// Returns the nodes that move a part, below `common`; for a whole end those that move any of its parts.
std::vector<std::uint32_t> RegionSubscriptions::chain_of(const Reach& reach, std::uint32_t common) const {
  if (reach.part != ModelNode::kNone) return model_->chain_of(reach.part, common);
  std::vector<std::uint32_t> all;
  for (const std::uint32_t part : model_->parts_of_node[model_->index_of(reach.end)]) {
    std::ranges::copy(model_->chain_of(part), std::back_inserter(all));
  }
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  return all;
}

RegionSubscriptions::Reached RegionSubscriptions::reached(const MotionWorld& world, const Reach& reach, SimTime t,
                                                          double within_s) const {
  const auto at = [&](std::uint32_t part) { return part_at(*model_, world, replica_.flexible(), part, t, within_s); };
  if (reach.part != ModelNode::kNone) {
    const PartAt part = at(reach.part);
    return {part.state, part.extent_m};
  }
  Reached whole{world.at(reach.end, t)};
  for (const std::uint32_t each : model_->parts_of_node[model_->index_of(reach.end)]) {
    const PartAt part = at(each);
    const double away_m = (part.state.position - whole.frame.position).norm();
    const double goes_m = (part.state.velocity - whole.frame.velocity).norm() * within_s;
    whole.extent_m = std::max(whole.extent_m, kCorner * (away_m + goes_m + part.extent_m));
  }
  return whole;
}

std::vector<Area> RegionSubscriptions::contact_areas(SimTime t, double within_s) const {
  std::vector<Area> areas;
  for (const auto& [reach, partners] : contact_ranges_) {
    const Reached mine = reached(replica_.truth(), reach, t, within_s);
    double theirs_m = partners.fixed_m;
    for (const auto& [node, partner] : partners.moving) {
      const Reached part = reached(replica_.ghosts(), partner, t, within_s);
      const KinematicState owned = replica_.ghosts().at(model_->nodes[node].object, t);
      const double goes_m = (part.frame.velocity - owned.velocity).norm() * within_s;
      theirs_m = std::max(theirs_m, (part.frame.position - owned.position).norm() + goes_m + part.extent_m);
    }
    const double speed_m_s = mine.frame.velocity.norm() + config_.regions.fastest_m_s;
    areas.push_back({mine.frame.position, mine.extent_m + theirs_m + speed_m_s * within_s});
  }
  return areas;
}

// A carrier of another peer moves an own object, however far away its origin is.
void RegionSubscriptions::add_carriers(SimTime t, double within_s, std::vector<Area>& areas) const {
  for (const auto& [object, own] : std::as_const(own_)) {
    const ModelNode* const node = model_->node(object);
    if (node == nullptr) continue;
    for (std::uint32_t up = node->carrier; up != ModelNode::kNone; up = model_->nodes[up].carrier) {
      if (!is_anothers(model_->nodes[up].object)) continue;
      const KinematicState state = replica_.truth().at(model_->nodes[up].object, t);
      areas.push_back({state.position, (state.velocity.norm() + config_.regions.fastest_m_s) * within_s});
    }
  }
}

// The areas that matter to this peer, as far as its own movement can take it until the states of a region that is
// joined now have come. None: everything matters.
std::optional<std::vector<Area>> RegionSubscriptions::areas(SimTime t) const {
  if (!config_.interest_radius_m || config_.is_decision_server()) return std::nullopt;
  // Objects are published where their origins are.
  const double radius_m = *config_.interest_radius_m + remote_radius_m_;
  const double ahead_s = to_seconds(config_.regions.lookahead.value_or(state_request_takes()));
  assert(radius_m >= 0.0 && ahead_s >= 0.0);
  std::vector<Area> areas;
  const std::optional<Viewpoint>& view = config_.decisions.viewpoint;
  if (view && !view->object) {
    areas.push_back({view->pose.position, radius_m});
  } else if (view) {
    const ObjectId carrier = *view->object;
    if (!model_->scene->contains(carrier) || !replica_.receives(carrier)) return std::nullopt;  // it may be anywhere
    const KinematicState state = own_.contains(carrier) ? replica_.truth(carrier, t) : replica_.ghost(carrier, t);
    const Vec3 arm = view->pose.position;
    const double speed_m_s = state.velocity.norm() + state.angular_velocity_body.norm() * arm.norm();
    areas.push_back({state.pose() * arm, radius_m + speed_m_s * ahead_s});
  }
  // Close proximity is searched so long ahead, on top.
  const double near_s = config_.policy.track_proximity ? config_.policy.close_proximity_s : 0.0;
  std::ranges::copy(contact_areas(t, ahead_s + near_s), std::back_inserter(areas));
  add_carriers(t, ahead_s, areas);
  if (view && members_.is_large()) {  // others say where it publishes that they are here
    for (const auto& [object, own] : std::as_const(own_)) areas.push_back({replica_.truth(object, t).position, 0.0});
  }
  if (view) return areas;
  for (const auto& [object, own] : std::as_const(own_)) {
    const KinematicState state = replica_.truth(object, t);
    areas.push_back({state.position, radius_m + state.velocity.norm() * ahead_s});
  }
  return areas;
}

void RegionSubscriptions::follow_interest(SimTime t, SimTime now) {
  if (!grid_.cuts()) return;
  if (config_.policy.predict_collisions) counters_.predictions_skipped += unreceived_pairs_;
  const auto wanted = areas(t);
  for (const Interest::Change& change : wanted ? interest_.follow(t, *wanted) : interest_.follow_all(t)) {
    if (change.joined) {
      join(change.region, now);
    } else {
      leave(change.region, t);
    }
  }
  if (ticks_.begins_a_second()) expire_silent_objects(t, now);
}

void RegionSubscriptions::join(RegionId region, SimTime now) {
  ++counters_.regions_joined;
  members_.reset_loss_of(region);
  outbox_.push(Join{region});
  request_states_of(region, now);
}

// `now` is not the tick's own time, which may be long past.
void RegionSubscriptions::request_states_of(RegionId region, SimTime now) {
  const std::uint32_t copies = copies_against(members_.worst_loss_to_peers(), kSubscriptionCopies);
  pending_subscriptions_.push_back({{copies, kSubscriptionRepeats}, {region, now}});
}

void RegionSubscriptions::leave(RegionId region, SimTime t) {
  ++counters_.regions_left;
  outbox_.push(Leave{region});
  std::erase_if(pending_subscriptions_, [&](const PendingSubscription& p) { return p.subscription.region == region; });
  std::vector<ObjectId> unreceived;
  for (const auto& [object, reception] : last_receptions_) {
    if (reception.region == region) unreceived.push_back(object);
  }
  for (const ObjectId object : unreceived) leave_interest(object, t);
}

std::vector<Subscription> RegionSubscriptions::take(std::size_t most, bool goes_anyway) {
  const SimTime t = ticks_.last_time();
  const auto must_go = [&](const PendingSubscription& p) { return p.is_due(t, config_.hello_period); };
  std::vector<Subscription> now;
  if (!goes_anyway && std::ranges::none_of(pending_subscriptions_, must_go)) return now;
  for (PendingSubscription& p : pending_subscriptions_) {
    if (now.size() == most) break;
    if (!p.is_due(t, kRepeatsApart)) continue;
    p.note_sent(t);
    now.push_back(p.subscription);
  }
  std::erase_if(pending_subscriptions_, [](const PendingSubscription& p) { return p.is_over(); });
  assert(now.size() <= most);
  return now;
}

void RegionSubscriptions::announce() {
  for (;;) {
    Message m = outbox_.blank();
    m.subscriptions = take(kSubscriptionsMax, false);
    if (m.subscriptions.empty()) return;
    (void)send_to_peers(m);
  }
}

// Owners listen where they publish. A peer that owns nothing says where it listens that it is here: a spectator, or one
// that decides for others. One that is yet to publish its objects listens to everything: all would be near to it.
std::vector<RegionId> RegionSubscriptions::regions_for(const Message& message) const {
  std::vector<RegionId> regions;
  for (const auto& [object, own] : std::as_const(own_)) {
    if (own.published_position) regions.push_back(grid_.region_of(*own.published_position));
  }
  for (const Subscription& asked : message.subscriptions) regions.push_back(asked.region);
  for (const DecisionRecord& d : message.decisions) {
    for (const ObjectId object : {d.collider, d.collidee}) regions.push_back(region_of(object));
  }
  std::erase(regions, kWholeScene);
  if (regions.empty() || (own_.size() == 0 && message.hello)) {
    std::ranges::copy(interest_.regions() | std::views::keys, std::back_inserter(regions));
    std::erase(regions, kWholeScene);
  }
  std::ranges::sort(regions);
  regions.erase(std::ranges::unique(regions).begin(), regions.end());
  return regions;
}

std::optional<std::uint32_t> RegionSubscriptions::send_to_peers(Message& message,
                                                                std::span<const EncodedUpdate> updates) {
  if (!members_.is_large()) return outbox_.send(message, kWholeScene, updates);
  const std::vector<RegionId> regions = regions_for(message);
  return regions.empty() ? std::nullopt : std::optional(outbox_.send_nearby(message, regions, updates));
}

// ---- the objects that this peer receives ----

bool RegionSubscriptions::accept(const UpdateRecord& update, SimTime session_now) {
  if (!grid_.cuts()) return true;
  const Vec3 position = replica_.position_of(update);
  if (!interest_.receives(position)) {
    leave_interest(update.object, session_now);
    return false;
  }
  last_receptions_.insert_or_assign(update.object, LastReception{grid_.region_of(position), session_now});
  // The pairs of the object are watched before the worlds have its position: what it has met since then counts.
  if (replica_.set_received(update.object, true)) {
    unreceived_pairs_ -= pairs_with_received(update.object);
    on_reception_changed_(update.object, true);
  }
  return true;
}

void RegionSubscriptions::stop_receiving(ObjectId object) {
  if (replica_.set_received(object, false)) unreceived_pairs_ += pairs_with_received(object);
  last_receptions_.erase(object);
  replica_.forget_update_of(object);
}

std::size_t RegionSubscriptions::pairs_with_received(ObjectId object) const {
  return static_cast<std::size_t>(std::ranges::count_if(model_->pairs_of(object), [&](std::uint32_t number) {
    const CollisionPair& pair = model_->pairs[number];
    return replica_.receives(pair.collider == object ? pair.collidee : pair.collider);
  }));
}

void RegionSubscriptions::follow_model() {
  const Scene& scene = *model_->scene;
  std::erase_if(last_receptions_, [&](const auto& reception) { return !scene.contains(reception.first); });
  std::erase_if(pending_handovers_, [&](const PendingHandover& p) { return !scene.contains(p.handover.object); });
  const auto is_unreceived = [&](const CollisionPair& pair) {
    return !replica_.receives(pair.collider) || !replica_.receives(pair.collidee);
  };
  unreceived_pairs_ = static_cast<std::size_t>(std::ranges::count_if(model_->pairs, is_unreceived));
}

void RegionSubscriptions::leave_interest(ObjectId object, SimTime t) {
  if (!replica_.receives(object)) return;
  ++counters_.sights_lost;
  stop_receiving(object);
  replica_.colliding().forget(object, t);
  on_reception_changed_(object, false);
}

void RegionSubscriptions::on_claimed(ObjectId object, SimTime last_tick) {
  if (!grid_.cuts()) return;
  if (config_.interest_radius_m) {
    remote_radius_m_ = std::max(remote_radius_m_, bounding_radius_m(*model_->scene, object));
  }
  stop_receiving(object);
  if (replica_.begun()) replica_.colliding().forget(object, last_tick);
}

void RegionSubscriptions::on_known_everywhere(ObjectId object) {
  last_receptions_.erase(object);
  if (!replica_.set_received(object, true)) return;
  unreceived_pairs_ -= pairs_with_received(object);
  on_reception_changed_(object, true);
}

void RegionSubscriptions::restart_at(SimTime now) {
  pending_subscriptions_.clear();
  interest_.restart_at(now);
  if (!grid_.cuts()) return;
  for (const auto& [object, peer] : owners_) {
    if (peer != config_.id) stop_receiving(object);
  }
}

// All copies of a handover may be lost. Every owner publishes once in the time threshold, if that is this peer's too
// and there are bytes for it: an owner that is silent for longer is asked before its object is forgotten.
void RegionSubscriptions::expire_silent_objects(SimTime t, SimTime now) {
  const Duration half = config_.policy.time_threshold / 2, latency = members_.longest_latency();
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
  for (const RegionId region : questioned) request_states_of(region, now);
  for (const ObjectId object : silent) leave_interest(object, t);
}

void RegionSubscriptions::on_handovers(PeerId sender, std::span<const Handover> handovers, SimTime session_now) {
  for (const Handover& g : handovers) {
    if (owners_.of(g.object) != sender) {
      drop(sender, "not_owner");
      continue;
    }
    std::uint32_t& last = members_.find(sender)->last_sequence[g.object];
    if (g.sequence < last) continue;  // the object has come back, or gone farther, since
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

// ---- the regions in which own objects are published ----

RegionId RegionSubscriptions::region_of(ObjectId object) const {
  const OwnObject* own = std::as_const(own_).find(object);
  if (own != nullptr && own->published_position) return grid_.region_of(*own->published_position);
  const auto reception = last_receptions_.find(object);
  return reception == last_receptions_.end() ? kWholeScene : reception->second.region;
}

bool RegionSubscriptions::has_left_region(const OwnObject& own, const Vec3& position) const {
  if (!grid_.cuts() || !own.published_position) return false;
  if (grid_.region_of(position) == grid_.region_of(*own.published_position)) return false;
  return grid_.outside_m(position, *own.published_position) > config_.regions.hysteresis.margin_m;
}

// The region is that of the position as it was rounded, so that receivers know it too.
void RegionSubscriptions::on_published(OwnObject& own, const UpdateRecord& update, bool receiver_may_hold_nothing) {
  if (!grid_.cuts()) return;
  const Vec3 position = replica_.position_of(update);
  const RegionId now = grid_.region_of(position);
  const RegionId before = own.published_position ? grid_.region_of(*own.published_position) : now;
  own.delivery.copy_until_received = before != now || receiver_may_hold_nothing;
  own.published_position = position;
  if (before == now) return;
  ++counters_.handovers;
  announce_handover(update, before, now);
}

// The handover goes to the region where the object was published before. Updates in its new region do not cancel the
// handover; only the object's return does. Regions that it left earlier are given its present region.
void RegionSubscriptions::announce_handover(const UpdateRecord& update, RegionId from, RegionId to) {
  assert(from != to);
  const Handover handover{update.object, update.sequence, to};
  std::erase_if(pending_handovers_, [&](const PendingHandover& p) {
    return p.handover.object == handover.object && (p.from == from || p.from == to);
  });
  for (PendingHandover& p : pending_handovers_) {
    if (p.handover.object == handover.object) p.handover = handover;
  }
  const std::uint32_t copies = copies_against(members_.worst_loss_to_peers(), kHandoverCopies);
  pending_handovers_.push_back({{copies, kHandoverRepeats}, handover, from});
}

void RegionSubscriptions::forget_handovers_of(ObjectId object) {
  std::erase_if(pending_handovers_, [&](const PendingHandover& p) { return p.handover.object == object; });
}

std::map<RegionId, std::vector<Handover>> RegionSubscriptions::take_handovers(const GoesAnyway& goes_anyway) {
  const SimTime t = ticks_.last_time();
  std::map<RegionId, std::vector<Handover>> due;
  const auto take = [&](PendingHandover& p) {
    p.note_sent(t);
    due[p.from].push_back(p.handover);
  };
  for (PendingHandover& p : pending_handovers_) {  // what must go
    if (p.is_due(t, config_.hello_period)) take(p);
  }
  for (PendingHandover& p : pending_handovers_) {  // and what may go with it
    if (p.is_due(t, kRepeatsApart) && (due.contains(p.from) || goes_anyway(p.from))) take(p);
  }
  std::erase_if(pending_handovers_, [](const PendingHandover& p) { return p.is_over(); });
  return due;
}

void RegionSubscriptions::on_subscriptions(PeerId sender, std::span<const Subscription> subscriptions,
                                           SimTime session_now) {
  if (!grid_.cuts()) return;
  std::map<RegionId, SimTime> since;  // the last time of each region
  for (const Subscription& e : subscriptions) {
    if (e.since < session_now - kSubscriptionAgeMax || e.since > session_now + kSubscriptionAheadMax) {
      drop(sender, "entered_time");
      continue;
    }
    SimTime& last = since.try_emplace(e.region, e.since).first->second;
    last = std::max(last, e.since);
  }
  if (since.empty()) return;
  for (auto& [object, own] : own_) {
    if (!own.published_position) continue;
    const auto there = since.find(grid_.region_of(*own.published_position));
    if (there == since.end() || (own.last_sent && *own.last_sent > there->second)) continue;
    own.resend = true;
    own_.check(object);
  }
}

}  // namespace peerd::replication
