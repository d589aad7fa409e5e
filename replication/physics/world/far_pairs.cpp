#include "replication/physics/world/far_pairs.hpp"

#include <algorithm>
#include <cassert>
#include <functional>
#include <queue>
#include <utility>

#include "collision/contact/contact_time.hpp"
#include "replication/physics/laws/swept_bound.hpp"

namespace peerd::replication {
namespace {

// A place reaches so many times as far as the body goes until its bound ends, to all sides. With less it is left more
// often, with more fewer pairs are far.
constexpr double kPlaceWays = 2.0;

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
      places_(model.nodes.size(), false),
      checks_(model.nodes.size()),
      is_far_(model.part_pairs.size(), false),
      was_searched_(model.part_pairs.size(), false) {}

bool FarPairs::is_single(std::uint32_t object) const {
  return model_->carried_by[object].empty() && model_->nodes[object].carrier == ModelNode::kNone &&
         model_->all_pairs_move[object];
}

bool FarPairs::may_be_far(const WatchedPair& pair) const {
  return pair.is_plain && !pair.is_flexible && !pair.fixed && pair.has_exact_search && is_single(pair.collider) &&
         is_single(pair.collidee);
}

FarPairs::Place& FarPairs::place_of(std::uint32_t object) {
  Place* const known = places_.find(object);
  return known != nullptr ? *known : places_.add(object, {});
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

void FarPairs::enter(Place& place, const Place& next, SimTime s) {
  place.bound = next.bound;
  place.since = s;
  place.known_until = next.known_until;
  place.last_added = std::max(place.last_added, s);
}

void FarPairs::make_place(std::size_t object, SimTime s, MovingObjects& objects) {
  Place& place = places_[object];
  assert(place.far == 0);
  const Place made = place_at(object, s, objects);
  place.bound = made.bound;
  place.since = made.since;
  place.known_until = made.known_until;
}

bool FarPairs::add_by_places(std::uint32_t pair, const std::array<std::uint32_t, 2>& ends, SimTime s, SimTime until,
                             MovingObjects& objects) {
  bool are_held = true;
  for (const std::uint32_t object : ends) {
    Place& place = place_of(object);
    if (place.far == 0 && (place.since > s || place.known_until <= s)) make_place(object, s, objects);
    are_held = are_held && place.since <= s && (place.known_until > until || stays_until(object, until, objects));
    if (place.far == 0) checks_.set(object, SimTime::max());  // it is followed only once a pair of it is far
  }
  if (!are_held || !apart(places_[ends[0]].bound, places_[ends[1]].bound, type_of(pair))) return false;
  is_far_[pair] = true;
  for (const std::uint32_t object : ends) {
    Place& place = places_[object];
    place.last_added = std::max(place.last_added, s);
    if (++place.far == 1) checks_.set(object, place.known_until);
  }
  return true;
}

bool FarPairs::add(std::uint32_t pair, SimTime s, SimTime oldest, MovingObjects& objects, WatchedPairs& pairs) {
  WatchedPair& p = pairs[pair];
  if (is_far_[pair] || !may_be_far(p)) return false;
  assert(!p.contact && !p.bears && !p.inside);
  if (!add_by_places(pair, {p.collider, p.collidee}, s, s, objects)) return false;
  p.clear_until = s;
  const bool is_whole = model_->part_pairs_of_pair(p.number).count() == 1;
  // A contact of `oldest` looks back so far.
  if (is_whole && !p.remembers_since(std::min(s, oldest) - kSameContact)) {
    was_searched_[pair] = p.searched;
    pairs.erase(pair);
  }
  return true;
}

bool FarPairs::add_waiting(std::uint32_t pair, SimTime s, SimTime until, MovingObjects& objects) {
  const PartPair& parts = model_->part_pairs[pair];
  if (is_far_[pair] || !is_single(parts.a) || !is_single(parts.b)) return false;
  was_searched_[pair] = false;
  return add_by_places(pair, {parts.a, parts.b}, s, until, objects);
}

WatchedPair& FarPairs::known(std::uint32_t pair, SimTime apart_until, WatchedPairs& pairs) const {
  if (WatchedPair* const there = pairs.find(pair)) return *there;
  assert(is_far_[pair]);
  add_pairs(pairs, *model_, model_->part_pairs[pair].pair, apart_until, true);
  WatchedPair& made = pairs[pair];
  made.searched = was_searched_[pair];
  made.is_scheduled = true;
  return made;
}

bool FarPairs::make_all_of(std::span<const std::uint32_t> objects, SimTime apart_until, WatchedPairs& pairs) const {
  const std::size_t before = pairs.numbers().size();
  for (const std::uint32_t object : objects) {
    if (object == ModelNode::kNone) continue;
    for (const std::uint32_t i : model_->part_pairs_of(object)) {
      if (is_far_[i]) known(i, apart_until, pairs);
    }
  }
  return pairs.numbers().size() > before;
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

void FarPairs::open_pair(std::uint32_t number, SimTime apart_until, WatchedPairs& pairs,
                         std::vector<std::uint32_t>& opened) {
  WatchedPair& p = known(number, apart_until, pairs);
  p.clear_until = std::max(p.clear_until, apart_until);
  is_far_[number] = false;
  for (const std::uint32_t end : {p.collider, p.collidee}) {
    if (--places_[end].far == 0) checks_.set(end, SimTime::max());
  }
  opened.push_back(number);
}

template <class Stays>
void FarPairs::open_unless(std::size_t object, SimTime apart_until, Stays stays, WatchedPairs& pairs,
                           std::vector<std::uint32_t>& opened) {
  const PairNumbers moved = model_->part_pairs_moved_by(object);
  for (auto at = moved.begin(); at != moved.end(); ++at) {
    const std::uint32_t i = *at;
    if (!is_far_[i]) continue;
    std::uint32_t other = at.partner();
    if (other == kNoNode) {
      const PartPair ends = model_->part_pairs[i];
      other = ends.a == object ? ends.b : ends.a;
    }
    if (!stays(i, other)) open_pair(i, std::min(apart_until, places_[other].known_until), pairs, opened);
  }
}

void FarPairs::open_all(std::size_t object, WatchedPairs& pairs, std::vector<std::uint32_t>& opened) {
  const auto none = [](std::uint32_t, std::uint32_t) { return false; };
  Place& place = places_[object];
  open_unless(object, place.known_until, none, pairs, opened);
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
      if (!is_known || !apart(next.bound, b.bound, type_of(i))) return false;
      b.last_added = std::max(b.last_added, s);
      return true;
    };
    left = std::max(left, s);
    open_unless(object, left, stays_far, pairs, opened);
    enter(place, next, s);
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
      const WatchedPair* const pair = pairs.find(i);
      return places_[other].since <= t && (pair == nullptr || pair->clear_until <= t);
    };
    open_unless(object, place.known_until, since_before, pairs, opened);
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
  using Leaving = std::pair<SimTime, std::uint32_t>;
  std::priority_queue<Leaving, std::vector<Leaving>, std::greater<>> leaving;
  const auto follow_one = [&](std::uint32_t object) {
    if (!stays_until(object, until, objects)) leaving.emplace(places_[object].known_until, object);
  };
  for (std::size_t i = checks_.next_due(0, until); i != checks_.size(); i = checks_.next_due(i + 1, until)) {
    follow_one(static_cast<std::uint32_t>(i));
  }
  std::vector<std::uint32_t> left;
  while (!leaving.empty()) {
    const SimTime s = leaving.top().first;
    for (left.clear(); !leaving.empty() && leaving.top().first == s; leaving.pop()) {
      left.push_back(leaving.top().second);
    }
    for (const std::uint32_t object : left) enter(places_[object], place_at(object, s, objects), s);
    for (const std::uint32_t object : left) {
      Place& place = places_[object];
      const auto stays_far = [&](std::uint32_t i, std::uint32_t other) {
        Place& b = places_[other];
        if (b.since > s || b.known_until <= s || !apart(place.bound, b.bound, type_of(i))) return false;
        b.last_added = std::max(b.last_added, s);
        return true;
      };
      open_unless(object, s, stays_far, pairs, opened);
      if (place.far > 0) {
        follow_one(object);
      } else {
        place.since = SimTime::max();
      }
    }
  }
}

// ---- those that have never moved ----

bool WaitingPairs::may_wait(std::uint32_t number, const MovingObjects& objects) const {
  assert(number < waits_.size());
  const auto [first, end] = model_->part_pairs_of_pair(number);
  if (end != first + 1) return false;
  const CollisionPair& pair = model_->pairs[number];
  const PartPair& parts = model_->part_pairs[first];
  const auto stands_alone = [&](std::uint32_t part, ObjectId of) {
    return part != ModelNode::kNone && !model_->is_flexible(part) && model_->nodes[part].object == of &&
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
  const PartPair& parts = model_->part_pairs[model_->part_pairs_of_pair(number).first];
  assert(parts.a != parts.b && parts.a < of_node_.size() && parts.b < of_node_.size() && "one rigid body each");
  assert(waits || (count_ > 0 && of_node_[parts.a] > 0 && of_node_[parts.b] > 0));
  waits ? ++count_ : --count_;
  for (const std::uint32_t node : {parts.a, parts.b}) waits ? ++of_node_[node] : --of_node_[node];
}

std::vector<std::uint32_t> WaitingPairs::take_of(std::size_t node) {
  std::vector<std::uint32_t> taken;
  if (node >= of_node_.size() || of_node_[node] == 0) return taken;
  for (const std::uint32_t number : model_->pairs_of_node(node)) {
    if (!waits_[number]) continue;
    set(number, false);
    taken.push_back(number);
  }
  assert(of_node_[node] == 0);
  return taken;
}

}  // namespace peerd::replication
