// Peer: which regions it listens to, which its objects are told in, and what it no longer hears of.
#include <algorithm>
#include <map>
#include <set>

#include "replication/peer.hpp"

namespace peerd::replication {
namespace {

// Who asks for what was told longer ago, or will be, has a broken clock.
constexpr Duration kEnteredAgeMax = std::chrono::seconds(10), kEnteredAheadMax = std::chrono::seconds(1);
// That somebody has entered a region is told so often at most: enough for one datagram in five lost.
constexpr std::uint32_t kEnteredCopies = 4;
// .. and that an object has gone.
constexpr std::uint32_t kGoneCopies = 4;
// Then so many times more, on the best of links too: nothing else tells of a datagram that was lost. Each with a hello,
// with others of its kind or, that an object has gone, with whatever goes there, once that may be lost for another
// reason than the one before; at the latest in a hello's usual period.
constexpr std::uint32_t kEnteredRepeats = 2, kGoneRepeats = 1;
constexpr Duration kRepeatsApart = std::chrono::milliseconds(100);
// From a need to the states: a tick until this peer notices, one until the others answer, one to spare.
constexpr int kTicksToStates = 3;

double extent_m(const collision::Body& body) { return body.center.norm() + body.radius_m; }

// Of what is announced: whether it goes out at t, once, where repeats are so far apart.
template <class Announced>
bool is_time(const Announced& a, SimTime t, Duration apart) {
  return a.said != t && (a.copies > 0 || (a.repeats > 0 && t - *a.said >= apart));
}

template <class Announced>
void note_said(Announced& a, SimTime t) {
  --(a.copies > 0 ? a.copies : a.repeats);
  a.said = t;
}

}  // namespace

const UpdateRecord* Peer::last_told(ObjectId object) const {
  const auto at = told_.find(object);
  return at == told_.end() ? nullptr : &at->second;
}

// ---- what this peer listens to ----

// How long it takes from joining a region until the states of what is there have come: the word that this peer is
// there, and the answer.
Duration Peer::answer_takes() const {
  return 2 * longest_latency() + kTicksToStates * Duration{std::chrono::seconds(1)} / config_.tick_hz;
}

Duration Peer::lookahead() const { return config_.regions.lookahead.value_or(answer_takes()); }

// Farthest distances from own objects at which what others run may touch them.
void Peer::measure_meetings(std::span<const std::uint32_t> pairs) {
  if (!grid_.cuts()) return;
  for (const std::uint32_t number : pairs) {
    const CollisionPair& pair = model_.pairs[number];
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
  // What somebody runs is told where its origin is.
  const double radius_m = *config_.interest_radius_m + others_reach_m_, ahead_s = to_seconds(lookahead());
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
  if (config_.policy.predict_collisions) counters_.predictions_skipped += unheard_pairs_;
  const auto wanted = areas(t);
  for (const Interest::Change& change : wanted ? interest_.follow(t, *wanted) : interest_.follow_all(t)) {
    if (change.joined) {
      join(change.region);
    } else {
      leave_region(change.region, t);
    }
  }
  if (last_tick_ % config_.tick_hz == 0) forget_silent(t);
}

void Peer::join(RegionId region) {
  ++counters_.regions_joined;
  members_.count_anew(region);
  outputs_.push_back(Join{region});
  ask_what_is_in(region);
}

// Of everybody who has told of something there until now.
void Peer::ask_what_is_in(RegionId region) {
  const SimTime since = clock_.to_session(*called_at_);  // not the tick's own time, which may be long past
  entering_.push_back({{region, since}, copies_against(loss(), kEnteredCopies), kEnteredRepeats});
}

void Peer::leave_region(RegionId region, SimTime t) {
  ++counters_.regions_left;
  outputs_.push_back(Leave{region});
  std::erase_if(entering_, [&](const Entering& e) { return e.entered.region == region; });
  std::vector<ObjectId> gone;
  for (const auto& [object, heard] : heard_in_) {
    if (heard.in == region) gone.push_back(object);
  }
  for (const ObjectId object : gone) lose_sight(object, t);
}

// Of the regions that this peer has entered, at most so many, to say so. Where nothing goes anyway, none before it is
// time for one of them.
std::vector<Entered> Peer::take_entered(std::size_t most, bool goes_anyway) {
  const SimTime t = tick_time(last_tick_);
  const auto must_go = [&](const Entering& e) { return is_time(e, t, config_.hello_period); };
  std::vector<Entered> now;
  if (!goes_anyway && std::ranges::none_of(entering_, must_go)) return now;
  for (Entering& e : entering_) {
    if (now.size() == most) break;
    if (!is_time(e, t, kRepeatsApart)) continue;
    note_said(e, t);
    now.push_back(e.entered);
  }
  std::erase_if(entering_, [](const Entering& e) { return e.copies + e.repeats == 0; });
  return now;
}

// To everybody: who has objects in a region need not listen to it.
void Peer::announce_entered() {
  for (;;) {
    Message m = blank();
    m.entered = take_entered(kEnteredMax, false);
    if (m.entered.empty()) return;
    send(m);
  }
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
  heard_in_.insert_or_assign(update.object, Heard{grid_.region_of(position), session_now});
  // Watched before it is told where it is: what it has met since then counts.
  if (unheard_.erase(update.object) > 0) {
    unheard_pairs_ -= pairs_with_held(update.object);
    shown_.erase(update.object);  // what has been drawn since means nothing: it is shown at once where it is
    watch_decided_pairs(model_.pairs_of(update.object));
  }
  return true;
}

void Peer::unhear(ObjectId object) {
  if (unheard_.insert(object).second) unheard_pairs_ += pairs_with_held(object);
  heard_in_.erase(object);
  told_.erase(object);
}

std::size_t Peer::pairs_with_held(ObjectId object) const {
  return static_cast<std::size_t>(std::ranges::count_if(model_.pairs_of(object), [&](std::uint32_t number) {
    const CollisionPair& pair = model_.pairs[number];
    return holds(pair.collider == object ? pair.collidee : pair.collider);
  }));
}

void Peer::lose_sight(ObjectId object, SimTime t) {
  if (!holds(object)) return;
  ++counters_.sights_lost;
  unhear(object);
  colliding_.forget(object, t);
  watch_decided_pairs(model_.pairs_of(object));
}

// The word that an object has gone may be lost, all its copies. Every owner speaks once in the time threshold, if that
// is this peer's too and there are bytes for it: who is silent for longer is asked before it is forgotten.
void Peer::forget_silent(SimTime t) {
  const Duration half = config_.policy.time_threshold / 2, latency = longest_latency();
  const Duration answered = std::max(half + latency, answer_takes());
  std::set<RegionId> unsure;
  std::vector<ObjectId> silent;
  for (auto& [object, heard] : heard_in_) {
    if (heard.asked) {
      if (t - *heard.asked > answered) silent.push_back(object);
    } else if (t - heard.at > 3 * half + latency) {
      heard.asked = t;
      unsure.insert(heard.in);
    }
  }
  for (const RegionId region : unsure) ask_what_is_in(region);
  for (const ObjectId object : silent) lose_sight(object, t);
}

// ---- where own objects are told ----

RegionId Peer::home(ObjectId object) const {
  const auto own = own_.find(object);
  if (own != own_.end() && own->second.told_at) return grid_.region_of(*own->second.told_at);
  const auto heard = heard_in_.find(object);
  return heard == heard_in_.end() ? kWholeScene : heard->second.in;
}

// Whether it is farther from the cell that it was told in than others grow their areas for.
bool Peer::has_crossed(const Own& own, const Vec3& position) const {
  if (!grid_.cuts() || !own.told_at || grid_.region_of(position) == grid_.region_of(*own.told_at)) return false;
  return grid_.outside_m(position, *own.told_at) > config_.regions.hysteresis.margin_m;
}

// The region is that of the position as it was rounded, so that receivers know it too.
void Peer::note_told(Own& own, const UpdateRecord& update, bool somebody_knows_nothing) {
  if (!grid_.cuts()) return;
  const RegionId now = grid_.region_of(update.model.state.position);
  const RegionId before = own.told_at ? grid_.region_of(*own.told_at) : now;
  own.must_arrive = before != now || somebody_knows_nothing;
  own.told_at = update.model.state.position;
  if (before == now) return;
  ++counters_.handovers;
  announce_gone(update, before, now);
}

// Where the object was told before, that it is gone. What is told next in its new region takes none of that back; only
// its return does. Regions that it left earlier hear where it is now.
void Peer::announce_gone(const UpdateRecord& update, RegionId from, RegionId to) {
  const Gone gone{update.object, update.sequence, to};
  std::erase_if(departures_,
                [&](const Departure& d) { return d.gone.object == gone.object && (d.from == from || d.from == to); });
  for (Departure& d : departures_) {
    if (d.gone.object == gone.object) d.gone = gone;
  }
  departures_.push_back({gone, from, copies_against(loss(), kGoneCopies), kGoneRepeats});
}

// Copies go out a tick apart.
void Peer::sort_gone(std::map<RegionId, Batch>& due) {
  const SimTime t = tick_time(last_tick_);
  for (const Duration apart : {config_.hello_period, kRepeatsApart}) {  // first what must go, then what may with it
    for (Departure& d : departures_) {
      if (!is_time(d, t, apart) || (apart == kRepeatsApart && !due.contains(d.from))) continue;
      note_said(d, t);
      due[d.from].gone.push_back(d.gone);
    }
  }
  std::erase_if(departures_, [](const Departure& d) { return d.copies + d.repeats == 0; });
}

void Peer::on_gone(PeerId sender, std::span<const Gone> gone, SimTime session_now) {
  for (const Gone& g : gone) {
    if (owner(g.object) != sender) {
      drop(sender, "not_owner");
      continue;
    }
    std::uint32_t& last = members_.find(sender)->last_sequence[g.object];
    if (g.sequence < last) continue;  // it has come back, or farther, since
    if (interest_.joined(g.to)) {     // its update is on the way; if this peer leaves before it comes, it is gone
      if (const auto heard = heard_in_.find(g.object); heard != heard_in_.end()) {
        heard->second.in = g.to;
        heard->second.asked.reset();
      }
      continue;
    }
    last = g.sequence;
    lose_sight(g.object, session_now);
  }
}

// Somebody listens to those regions who may know nothing of what is there.
void Peer::on_entered(PeerId sender, std::span<const Entered> entered, SimTime session_now) {
  if (!grid_.cuts()) return;
  std::map<RegionId, SimTime> since;  // the last of each
  for (const Entered& e : entered) {
    if (e.since < session_now - kEnteredAgeMax || e.since > session_now + kEnteredAheadMax) {
      drop(sender, "entered_time");
      continue;
    }
    SimTime& last = since.try_emplace(e.region, e.since).first->second;
    last = std::max(last, e.since);
  }
  if (since.empty()) return;
  for (auto& [object, own] : own_) {
    if (!own.told_at) continue;
    const auto there = since.find(grid_.region_of(*own.told_at));
    if (there == since.end() || (own.last_sent && *own.last_sent > there->second)) continue;
    own.resend = true;
    look_at(object);
  }
}

// Two own objects, or an own and another's, that are told in different regions have met, as all predict who hear of
// both. Who hears of one of them must be told what became of it.
void Peer::retell_across(const ContactEvent& contact) {
  if (!grid_.cuts() || owner(contact.collider) == kNobody || owner(contact.collidee) == kNobody) return;
  if (home(contact.collider) == home(contact.collidee)) return;
  for (const ObjectId object : {contact.collider, contact.collidee}) retell(object);
}

}  // namespace peerd::replication
