#include "replication/physics/world/far_pairs.hpp"

#include <algorithm>
#include <cassert>

#include "collision/contact/contact_time.hpp"
#include "replication/physics/laws/swept_bound.hpp"

namespace peerd::replication {
namespace {

// A place reaches so many times as far as the body goes until its bound ends, to all sides. With less it is left more
// often, with more fewer pairs are far.
constexpr double kPlaceWays = 4.0;

// The end of the time that a bound is for. A body that stands does so until its law changes.
SimTime end_of(const SweptBound& bound, SimTime s) {
  const SimTime change = bound.next_change.value_or(SimTime::max());
  return bound.still ? change : std::min(change, floor_to(s, MovingObjects::kLookahead) + MovingObjects::kLookahead);
}

bool holds(const SweptBound& place, const SweptBound& bound) {
  return (place.low.array() <= bound.low.array()).all() && (bound.high.array() <= place.high.array()).all() &&
         bound.radius_m <= place.radius_m;
}

}  // namespace

FarPairs::FarPairs(const WorldModel& model)
    : model_(&model),
      places_(model.nodes.size()),
      checks_(model.nodes.size()),
      is_far_(model.part_pairs.size(), false),
      near_index_(model.part_pairs.size()) {}

bool FarPairs::is_collider(std::uint32_t object, std::uint32_t pair) const {
  return model_->pairs[model_->part_pairs[pair].pair].collider == model_->nodes[object].object;
}

bool FarPairs::may_be_far(const WatchedPair& pair) const {
  const auto is_single = [&](std::uint32_t i) {
    return model_->carried_by[i].empty() && model_->nodes[i].carrier == ModelNode::kNone && model_->all_pairs_move[i];
  };
  return pair.is_plain && !pair.is_flexible && !pair.fixed && pair.has_exact_search && is_single(pair.collider) &&
         is_single(pair.collidee);
}

FarPairs::Place& FarPairs::place_of(std::uint32_t object) {
  assert(model_->all_pairs_move[object]);
  if (Place* const known = places_.find(object)) return *known;
  const auto moved = model_->part_pairs_moved_by(object);
  for (std::uint32_t k = 0; k < moved.size(); ++k) {
    near_index_[moved[k]][is_collider(object, moved[k]) ? 0 : 1] = k;
  }
  return places_.add(object, {.bound = {}, .near{moved.begin(), moved.end()}});
}

std::span<const std::uint32_t> FarPairs::near(std::size_t object) const {
  if (object >= places_.size()) return {};
  const Place* const place = places_.find(object);
  return place == nullptr ? model_->part_pairs_moved_by(object) : place->near;
}

bool FarPairs::near_since(std::size_t object, SimTime t) const {
  if (object >= places_.size() || !model_->all_pairs_move[object]) return false;
  const Place* const place = places_.find(object);
  return place == nullptr || t >= place->last_added;
}

void FarPairs::push_near(std::uint32_t pair, std::size_t side, std::uint32_t object) {
  near_index_[pair][side] = static_cast<std::uint32_t>(places_[object].near.size());
  places_[object].near.push_back(pair);
}

void FarPairs::erase_near(std::uint32_t pair, std::size_t side, std::uint32_t object) {
  std::vector<std::uint32_t>& near = places_[object].near;
  const std::uint32_t at = near_index_[pair][side], last = near.back();
  assert(near[at] == pair);
  near[at] = last;
  near_index_[last][is_collider(object, last) ? 0 : 1] = at;
  near.pop_back();
}

FarPairs::Place FarPairs::place_at(std::size_t object, SimTime s, MovingObjects& objects) {
  Place place;
  place.bound = objects.bound_of(object, s);
  place.since = place.bound.still ? place.bound.last_change.value_or(SimTime::min()) : s;
  place.known_until = end_of(place.bound, s);
  if (place.bound.still) return place;
  const double way_m = (place.bound.high - place.bound.low).maxCoeff();
  const double wider_m = std::max(kPlaceWays * way_m, place.bound.radius_m);
  place.bound.low -= Vec3::Constant(wider_m);
  place.bound.high += Vec3::Constant(wider_m);
  return place;
}

void FarPairs::make_place(std::size_t object, SimTime s, MovingObjects& objects) {
  Place& place = places_[object];
  assert(place.far == 0);
  const Place made = place_at(object, s, objects);
  place.bound = made.bound;
  place.since = made.since;
  place.known_until = made.known_until;
}

bool FarPairs::add(std::size_t pair, SimTime s, MovingObjects& objects, WatchedPairs& pairs) {
  WatchedPair& p = pairs[pair];
  if (is_far_[pair] || !may_be_far(p)) return false;
  assert(!p.contact && !p.bears && !p.inside);
  for (const std::uint32_t object : {p.collider, p.collidee}) {
    Place& place = place_of(object);
    if (place.far == 0 && (place.since > s || place.known_until <= s)) make_place(object, s, objects);
    if (place.since > s || place.known_until <= s) return false;
  }
  Place &a = places_[p.collider], &b = places_[p.collidee];
  if (!apart(a.bound, b.bound, p.type)) return false;
  is_far_[pair] = true;
  p.clear_until = s;
  const auto number = static_cast<std::uint32_t>(pair);
  erase_near(number, 0, p.collider);
  erase_near(number, 1, p.collidee);
  for (const std::uint32_t object : {p.collider, p.collidee}) {
    Place& place = places_[object];
    place.last_added = std::max(place.last_added, s);
    if (++place.far == 1) checks_.set(object, place.known_until);
  }
  return true;
}

bool FarPairs::stays_until(std::size_t object, SimTime until, MovingObjects& objects) {
  Place& place = places_[object];
  while (place.known_until <= until) {
    const SweptBound& bound = objects.bound_of(object, place.known_until);
    if (!holds(place.bound, bound)) return false;
    place.known_until = end_of(bound, place.known_until);
  }
  checks_.set(object, place.known_until);
  return true;
}

void FarPairs::open_pair(std::uint32_t number, WatchedPairs& pairs, std::vector<std::uint32_t>& opened) {
  WatchedPair& p = pairs[number];
  p.clear_until = std::max(p.clear_until, std::min(places_[p.collider].known_until, places_[p.collidee].known_until));
  is_far_[number] = false;
  push_near(number, 0, p.collider);
  push_near(number, 1, p.collidee);
  for (const std::uint32_t end : {p.collider, p.collidee}) {
    if (--places_[end].far == 0) checks_.set(end, SimTime::max());
  }
  opened.push_back(number);
}

template <class Stays>
void FarPairs::open_unless(std::size_t object, Stays stays, WatchedPairs& pairs, std::vector<std::uint32_t>& opened) {
  for (const std::uint32_t i : model_->part_pairs_moved_by(object)) {
    if (!is_far_[i]) continue;
    const PartPair& ends = model_->part_pairs[i];
    if (!stays(i, ends.a == object ? ends.b : ends.a)) open_pair(i, pairs, opened);
  }
}

void FarPairs::open_all(std::size_t object, WatchedPairs& pairs, std::vector<std::uint32_t>& opened) {
  const auto none = [](std::uint32_t, std::uint32_t) { return false; };
  open_unless(object, none, pairs, opened);
  Place& place = places_[object];
  assert(place.far == 0);
  place.since = SimTime::max();
  place.last_added = SimTime::min();
}

// An opened pair counts as apart until the old law would have left the place. Where the new law comes from before that,
// MotionWorld::reopen_pairs() says how far back its own search goes.
void FarPairs::leave_place(std::size_t object, SimTime t, SimTime until, MovingObjects& objects, WatchedPairs& pairs,
                           std::vector<std::uint32_t>& opened) {
  Place& place = places_[object];
  SimTime left = place.known_until;
  place.known_until = std::min(left, t);
  while (!stays_until(object, until, objects)) {
    const SimTime s = place.known_until;
    const Place next = place_at(object, s, objects);
    const auto stays_far = [&](std::uint32_t i, std::uint32_t other) {
      Place& b = places_[other];
      const bool is_known = b.since <= std::min(s, t) && (b.known_until > s || stays_until(other, s, objects));
      if (!is_known || !apart(next.bound, b.bound, pairs[i].type)) return false;
      b.last_added = std::max(b.last_added, s);
      return true;
    };
    left = std::max(left, s);
    place.known_until = left;
    open_unless(object, stays_far, pairs, opened);
    place.bound = next.bound;
    place.since = s;
    place.known_until = next.known_until;
    place.last_added = std::max(place.last_added, s);
    if (place.far == 0) {
      place.since = SimTime::max();
      return;
    }
  }
}

void FarPairs::moved(std::size_t object, SimTime t, SimTime until, MovingObjects& objects, WatchedPairs& pairs,
                     std::vector<std::uint32_t>& opened) {
  Place* const at = object < places_.size() ? places_.find(object) : nullptr;
  if (at == nullptr) return;
  Place& place = *at;
  if (place.far > 0 && t < place.since) return open_all(object, pairs, opened);
  if (place.far > 0 && t < place.last_added) {  // what was found to be apart after t is searched again
    const auto since_before = [&](std::uint32_t i, std::uint32_t other) {
      return places_[other].since <= t && pairs[i].clear_until <= t;
    };
    open_unless(object, since_before, pairs, opened);
  }
  if (place.far == 0) {
    place.since = SimTime::max();
    return;
  }
  leave_place(object, t, std::max(t, until), objects, pairs, opened);
}

void FarPairs::open(WatchedPairs& pairs, std::vector<std::uint32_t>& opened) {
  for (const std::uint32_t i : places_.numbers()) {
    if (places_[i].far > 0) open_all(i, pairs, opened);
  }
}

void FarPairs::follow(SimTime until, MovingObjects& objects, WatchedPairs& pairs, std::vector<std::uint32_t>& opened) {
  for (std::size_t i = checks_.next_due(0, until); i != checks_.size(); i = checks_.next_due(i + 1, until)) {
    leave_place(i, SimTime::max(), until, objects, pairs, opened);
  }
}

// ---- those that have never moved ----

bool WaitingPairs::may_wait(std::uint32_t number, const MovingObjects& objects) const {
  assert(number < waits_.size());
  const std::uint32_t first = model_->first_part_pair[number];
  if (model_->first_part_pair[number + 1] != first + 1) return false;
  const CollisionPair& pair = model_->pairs[number];
  const PartPair& parts = model_->part_pairs[first];
  const auto stands_alone = [&](std::uint32_t part, ObjectId end) {
    return part != ModelNode::kNone && !model_->is_flexible(part) && model_->nodes[part].object == end &&
           model_->nodes[part].carrier == ModelNode::kNone && model_->carried_by[part].empty() &&
           model_->bodies[part].unsupported.empty() && objects.has_never_moved(part);
  };
  if (parts.fixed || !stands_alone(parts.a, pair.collider) || !stands_alone(parts.b, pair.collidee)) return false;
  const collision::Body &a = model_->bodies[parts.a], &b = model_->bodies[parts.b];
  if (pair.type != CollisionType::kBox && !collision::has_exact_answer(a, b)) return false;
  return always_apart(a, objects.first_position(parts.a), b, objects.first_position(parts.b));
}

void WaitingPairs::set(std::uint32_t number, bool waits) {
  if (waits_[number] == waits) return;
  waits_[number] = waits;
  const PartPair& parts = model_->part_pairs[model_->first_part_pair[number]];
  assert(parts.a != parts.b && parts.a < of_node_.size() && parts.b < of_node_.size() && "one rigid body each");
  assert(waits || (count_ > 0 && of_node_[parts.a] > 0 && of_node_[parts.b] > 0));
  waits ? ++count_ : --count_;
  for (const std::uint32_t node : {parts.a, parts.b}) waits ? ++of_node_[node] : --of_node_[node];
}

std::vector<std::uint32_t> WaitingPairs::take_of(std::size_t node) {
  std::vector<std::uint32_t> taken;
  if (node >= of_node_.size() || of_node_[node] == 0) return taken;
  for (const std::uint32_t number : model_->pairs_of_node[node]) {
    if (!waits_[number]) continue;
    set(number, false);
    taken.push_back(number);
  }
  assert(of_node_[node] == 0);
  return taken;
}

std::set<InterestKey> WaitingPairs::interests() const {
  std::set<InterestKey> interests;
  for (std::uint32_t number = 0; number < waits_.size(); ++number) {
    if (waits_[number]) interests.insert(key_of(model_->pairs[number]));
  }
  return interests;
}

}  // namespace peerd::replication
