// Peer: which regions it listens to, which its objects are told in, and what it no longer hears of.
#include <algorithm>
#include <cassert>

#include "replication/peer.hpp"

namespace peerd::replication {
namespace {

// Who asks for what was told longer ago, or will be, has a broken clock.
constexpr Duration kEnteredAgeMax = std::chrono::seconds(10), kEnteredAheadMax = std::chrono::seconds(1);
// That somebody has entered a region is told so often at most: enough for one datagram in five lost.
constexpr std::uint32_t kEnteredCopies = 4;
// From a need to the states: a tick until this peer notices, one until the others answer, one to spare.
constexpr int kTicksToStates = 3;

double extent_m(const collision::Body& body) { return body.center.norm() + body.radius_m; }

}  // namespace

const UpdateRecord* Peer::last_told(ObjectId object) const {
  const auto at = told_.find(object);
  return at == told_.end() ? nullptr : &at->second;
}

// ---- what this peer listens to ----

// How long it takes from joining a region until the states of what is there have come: the word that this peer is
// there, and the answer.
Duration Peer::lookahead() const {
  if (config_.regions.lookahead) return *config_.regions.lookahead;
  return 2 * longest_latency() + kTicksToStates * Duration{std::chrono::seconds(1)} / config_.tick_hz;
}

// Farthest distances from own objects at which what others run may touch them.
void Peer::measure_meetings() {
  if (!grid_.cuts()) return;
  for (auto& [object, own] : own_) own.meets_within_m = 0.0;
  for (const CollisionPair& pair : model_.pairs) {
    if (!is_shared(pair.collider, pair.collidee)) continue;
    const double within_m = extent_m(*model_.body(pair.collider)) + extent_m(*model_.body(pair.collidee));
    for (const ObjectId object : {pair.collider, pair.collidee}) {
      const auto own = own_.find(object);
      if (own != own_.end()) own->second.meets_within_m = std::max(own->second.meets_within_m, within_m);
    }
  }
}

// What matters to this peer, as far as its own movement can take it until the states of a region that is joined now
// have come. None: everything.
std::optional<std::vector<Area>> Peer::areas(SimTime t) const {
  if (!config_.interest_radius_m || serves()) return std::nullopt;
  const double radius_m = *config_.interest_radius_m, ahead_s = to_seconds(lookahead());
  std::vector<Area> areas;
  const std::optional<Viewpoint>& view = config_.decisions.viewpoint;
  if (view && !view->object) {
    areas.push_back({view->pose.position, radius_m});
  } else if (view) {
    const ObjectId carrier = *view->object;
    if (!holds(carrier)) return std::nullopt;  // it may be anywhere
    const KinematicState state = own_.contains(carrier) ? truth(carrier, t) : ghost(carrier, t);
    const Vec3 arm = view->pose.position;
    const double speed_m_s = state.velocity.norm() + state.angular_velocity_body.norm() * arm.norm();
    areas.push_back({state.pose() * arm, radius_m + speed_m_s * ahead_s});
  }
  // Close proximity is looked for so long ahead, on top.
  const double near_s = config_.policy.track_proximity ? config_.policy.close_proximity_s : 0.0;
  for (const auto& [object, own] : own_) {
    const KinematicState state = truth(object, t);
    const double speed_m_s = state.velocity.norm();
    if (!view) areas.push_back({state.position, radius_m + speed_m_s * ahead_s});
    if (own.meets_within_m == 0.0) continue;
    areas.push_back(
        {state.position, own.meets_within_m + (speed_m_s + config_.regions.fastest_m_s) * (ahead_s + near_s)});
  }
  return areas;
}

void Peer::follow_interest(SimTime t) {
  if (!grid_.cuts()) return;
  const auto wanted = areas(t);
  for (const Interest::Change& change : wanted ? interest_.follow(t, *wanted) : interest_.follow_all(t)) {
    if (change.joined) {
      join(change.region, t);
    } else {
      leave_region(change.region, t);
    }
  }
  if (last_tick_ % config_.tick_hz == 0) forget_silent(t);
}

void Peer::join(RegionId region, SimTime t) {
  ++counters_.regions_joined;
  members_.count_anew(region);
  outputs_.push_back(Join{region});
  entering_.push_back({{region, t}, copies_against(loss(), kEnteredCopies)});
}

void Peer::leave_region(RegionId region, SimTime t) {
  ++counters_.regions_left;
  outputs_.push_back(Leave{region});
  std::erase_if(entering_, [&](const Entering& e) { return e.entered.region == region; });
  std::vector<ObjectId> gone;
  for (const auto& [object, heard_in] : heard_in_) {
    if (heard_in == region) gone.push_back(object);
  }
  for (const ObjectId object : gone) lose_sight(object, t);
}

// To everybody: who has objects in a region need not listen to it.
void Peer::announce_entered() {
  Message m = blank();
  for (Entering& e : entering_) {
    if (m.entered.size() == kEnteredMax) {
      send(m);
      m = blank();
    }
    m.entered.push_back(e.entered);
    --e.copies;
  }
  if (!m.entered.empty()) send(m);
  std::erase_if(entering_, [](const Entering& e) { return e.copies == 0; });
}

// ---- what this peer hears of ----

// False for what has gone where this peer does not listen: the update says where it is, and that this was the last.
bool Peer::hear(const UpdateRecord& update, SimTime session_now) {
  if (!grid_.cuts()) return true;
  const Vec3& position = update.model.state.position;
  if (!interest_.hears(position)) {
    lose_sight(update.object, session_now);
    return false;
  }
  heard_in_.insert_or_assign(update.object, grid_.region_of(position));
  // Watched before it is told where it is: what it has met since then counts.
  if (unheard_.erase(update.object) > 0) {
    shown_.erase(update.object);  // what has been drawn since means nothing: it is shown at once where it is
    watch_decided_pairs(update.object);
  }
  return true;
}

void Peer::lose_sight(ObjectId object, SimTime t) {
  if (!unheard_.insert(object).second) return;
  ++counters_.sights_lost;
  heard_in_.erase(object);
  told_.erase(object);
  colliding_.forget(object, t);
  watch_decided_pairs(object);
}

// The word that an object has gone may be lost, all its copies. Every owner speaks once in the time threshold.
void Peer::forget_silent(SimTime t) {
  const Duration patience = 2 * config_.policy.time_threshold + longest_latency();
  std::vector<ObjectId> silent;
  for (const auto& [object, update] : told_) {
    if (t - update.at > patience && heard_in_.contains(object) && owner(object) != kNobody) silent.push_back(object);
  }
  for (const ObjectId object : silent) lose_sight(object, t);
}

// ---- where own objects are told ----

RegionId Peer::home(ObjectId object) const {
  const auto own = own_.find(object);
  if (own != own_.end() && own->second.told_at) return grid_.region_of(*own->second.told_at);
  const auto heard = heard_in_.find(object);
  return heard == heard_in_.end() ? kWholeScene : heard->second;
}

// Whether it is farther from the cell that it was told in than others grow their areas for.
bool Peer::has_crossed(const Own& own, const Vec3& position) const {
  if (!grid_.cuts() || !own.told_at || grid_.region_of(position) == grid_.region_of(*own.told_at)) return false;
  return grid_.outside_m(position, *own.told_at) > config_.regions.hysteresis.margin_m;
}

// The region is that of the position as it was rounded, so that receivers know it too.
void Peer::note_told(Own& own, const UpdateRecord& update, PublishReason reason) {
  if (!grid_.cuts()) return;
  const RegionId now = grid_.region_of(update.model.state.position);
  const RegionId before = own.told_at ? grid_.region_of(*own.told_at) : now;
  own.came_from = before == now ? std::nullopt : std::optional(before);
  own.must_arrive = own.came_from || reason == PublishReason::kJoiner || reason == PublishReason::kFirst;
  own.told_at = update.model.state.position;
  if (own.came_from) ++counters_.handovers;
}

// An update goes to its region; where the object was told before, that it is gone.
void Peer::sort_by_region(const UpdateRecord& update, std::map<RegionId, Due>& due) const {
  const RegionId region = grid_.region_of(update.model.state.position);
  due[region].updates.push_back(update);
  const auto own = own_.find(update.object);
  if (own == own_.end() || !own->second.came_from || *own->second.came_from == region) return;
  due[*own->second.came_from].gone.push_back({update.object, update.sequence, region});
}

void Peer::on_gone(PeerId sender, std::span<const Gone> gone, SimTime session_now) {
  for (const Gone& g : gone) {
    if (owner(g.object) != sender) {
      drop("not_owner");
      continue;
    }
    std::uint32_t& last = members_.find(sender)->last_sequence[g.object];
    if (g.sequence < last) continue;  // it has come back, or farther, since
    if (interest_.joined(g.to)) {     // its update is on the way; if this peer leaves before it comes, it is gone
      if (holds(g.object)) heard_in_.insert_or_assign(g.object, g.to);
      continue;
    }
    last = g.sequence;
    lose_sight(g.object, session_now);
  }
}

// Somebody listens to those regions who may know nothing of what is there.
void Peer::on_entered(std::span<const Entered> entered, SimTime session_now) {
  if (!grid_.cuts()) return;
  for (const Entered& e : entered) {
    if (e.since < session_now - kEnteredAgeMax || e.since > session_now + kEnteredAheadMax) {
      drop("entered_time");
      continue;
    }
    for (auto& [object, own] : own_) {
      const bool there = own.told_at && (grid_.region_of(*own.told_at) == e.region || own.came_from == e.region);
      if (there && (!own.last_sent || *own.last_sent <= e.since)) own.resend = true;
    }
  }
}

// Two own objects, or an own and another's, that are told in different regions have met, as all predict who hear of
// both. Who hears of one of them must be told what became of it.
void Peer::retell_across(const ContactEvent& contact) {
  if (!grid_.cuts() || owner(contact.collider) == kNobody || owner(contact.collidee) == kNobody) return;
  if (home(contact.collider) == home(contact.collidee)) return;
  for (const ObjectId object : {contact.collider, contact.collidee}) {
    if (const auto own = own_.find(object); own != own_.end()) own->second.retell = true;
  }
}

}  // namespace peerd::replication
