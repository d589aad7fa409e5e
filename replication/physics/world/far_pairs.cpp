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
// A place reaches at least so many radii of its body to all sides. Else a body that hardly moves would leave its place
// at the end of each window.
constexpr double kPlaceRadii = 1.0;

// The end of the time that a bound is for. A body that stands does so until its law changes.
SimTime end_of(const SweptBound& bound, SimTime s) {
  const SimTime change = bound.next_change.value_or(SimTime::max());
  return bound.still ? change : std::min(change, floor_to(s, MovingObjects::kLookahead) + MovingObjects::kLookahead);
}

bool holds(const SweptRegion& place, const SweptRegion& bound) {
  return (place.low.array() <= bound.low.array()).all() && (bound.high.array() <= place.high.array()).all() &&
         bound.radius_m <= place.radius_m;
}

}  // namespace

FarPairs::FarPairs(const WorldModel& model, SimTime start, MovingObjects& objects)
    : model_(&model), places_(model.nodes.size()), checks_(model.nodes.size()) {
  const auto note_type = [&](CollisionType type) {
    if (type == CollisionType::kBox) reach_ = kBoxReach;
  };
  for (const PairGroup& group : model.groups) note_type(group.type());
  model.pairs.for_each_listed([&](std::uint32_t, const CollisionPair& pair) { note_type(pair.type); });
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    if (!is_single(i)) continue;
    places_[i] = first_place(i, start, objects);
    note_place(i);
  }
}

bool FarPairs::is_single(std::uint32_t object) const {
  return model_->carried_by[object].empty() && model_->nodes[object].carrier == ModelNode::kNone &&
         model_->all_pairs_move[object] && !model_->node_part_pairs.of(object).empty();
}

bool FarPairs::may_be_far(std::uint32_t pair) const {
  const auto has_place = [&](std::uint32_t part) {
    return part != ModelNode::kNone && !model_->is_flexible(part) && places_[part].exists;
  };
  const PartPair parts = model_->part_pairs[pair];
  if (!has_place(parts.a) || !has_place(parts.b)) return false;
  if (model_->part_pairs.locate(pair).group != nullptr) return true;
  if (model_->part_pairs_of_pair(parts.pair).count() != 1) return false;
  const CollisionPair& ends = model_->pairs[parts.pair];
  return model_->nodes[parts.a].object == ends.collider && model_->nodes[parts.b].object == ends.collidee &&
         collision::has_exact_answer(model_->bodies[parts.a], model_->bodies[parts.b]);
}

// ---- places ----

WorldBox FarPairs::box_of(const SweptRegion& region) const {
  const double farthest_m = region.low.cwiseAbs().cwiseMax(region.high.cwiseAbs()).maxCoeff() + region.radius_m;
  const Vec3 reach = Vec3::Constant(reach_ * region.radius_m + 0x1p-50 * farthest_m);  // with room for rounding
  return {region.low - reach, region.high + reach};
}

FarPairs::Place FarPairs::place_at(std::size_t object, SimTime s, MovingObjects& objects) {
  const SweptBound& bound = objects.bound_of(object, s);
  Place place;
  place.exists = true;
  place.region = {bound.low, bound.high, bound.radius_m};
  place.since = s;
  place.known_until = end_of(bound, s);
  if (bound.still) return place;
  const double way_m = (bound.high - bound.low).maxCoeff();
  const double wider_m = std::max(kPlaceWays * way_m, kPlaceRadii * bound.radius_m);
  place.region.low -= Vec3::Constant(wider_m);
  place.region.high += Vec3::Constant(wider_m);
  return place;
}

FarPairs::Place FarPairs::first_place(std::uint32_t object, SimTime start, MovingObjects& objects) const {
  if (!objects.has_never_moved(object)) return place_at(object, start, objects);
  Place place;
  place.exists = true;
  place.since = start;
  place.region = standing_region(model_->bodies[object], objects.first_position(object));
  place.known_until = SimTime::max();
  return place;
}

void FarPairs::note_place(std::uint32_t object) {
  const Place& place = places_[object];
  assert(place.exists && place.region.radius_m >= 0.0);
  const WorldBox box = box_of(place.region);
  index_.set(object, box.lo, box.hi);
  checks_.set(object, place.known_until);
}

void FarPairs::enter(std::uint32_t object, const Place& next, SimTime s) {
  Place& place = places_[object];
  assert(place.since <= s);
  if (place.since < s) {
    std::uint32_t slot = 0;
    if (free_past_.empty()) {
      slot = static_cast<std::uint32_t>(past_.size());
      past_.emplace_back();
    } else {
      slot = free_past_.back();
      free_past_.pop_back();
    }
    past_[slot] = {object, place.region, place.since, s};
    const WorldBox box = box_of(place.region);
    past_index_.set(slot, box.lo, box.hi);
    place.before.push_back(slot);
  }
  place.region = next.region;
  ++place.left;
  place.since = s;
  place.known_until = next.known_until;
  note_place(object);
}

void FarPairs::erase_past(std::uint32_t slot) {
  assert(slot < past_.size() && free_past_.size() < past_.size());
  past_index_.erase(slot);
  free_past_.push_back(slot);
}

void FarPairs::go_back(std::uint32_t object, SimTime t) {
  Place& place = places_[object];
  assert(place.exists && place.since > t);
  while (place.since > t && !place.before.empty()) {
    const std::uint32_t slot = place.before.back();
    place.before.pop_back();
    place.region = past_[slot].region;
    place.since = past_[slot].since;
    place.known_until = past_[slot].until;
    erase_past(slot);
  }
  note_place(object);
}

bool FarPairs::stays_until(std::size_t object, SimTime until, MovingObjects& objects) {
  Place& place = places_[object];
  while (place.known_until <= until) {
    const SweptBound& bound = objects.bound_of(object, place.known_until);
    if (!holds(place.region, bound)) return false;
    place.known_until = end_of(bound, place.known_until);
  }
  checks_.set(object, place.known_until);
  return true;
}

void FarPairs::forget_before(SimTime oldest, WatchedPairs& pairs) {
  for (Place& place : places_) {
    const auto first_kept =
        std::ranges::find_if(place.before, [&](std::uint32_t slot) { return past_[slot].until >= oldest; });
    std::for_each(place.before.begin(), first_kept, [&](std::uint32_t slot) { erase_past(slot); });
    place.before.erase(place.before.begin(), first_kept);
  }
  std::ranges::sort(remembering_);
  remembering_.erase(std::ranges::unique(remembering_).begin(), remembering_.end());
  std::erase_if(remembering_, [&](std::uint32_t i) {
    const WatchedPair* const pair = pairs.find(i);
    if (pair == nullptr || !pair->is_far) return true;
    if (pair->remembers_since(oldest - kSameContact)) return false;
    pairs.erase(i);
    return true;
  });
}

// ---- pairs ----

WatchedPair& FarPairs::known(std::uint32_t pair, SimTime apart_until, WatchedPairs& pairs) {
  if (WatchedPair* const there = pairs.find(pair)) return *there;
  assert(may_be_far(pair));
  const std::uint32_t number = model_->part_pairs[pair].pair;
  add_pairs(pairs, *model_, number, apart_until, is_watched(number));
  WatchedPair& made = pairs[pair];
  // An object that has just left its first place may begin in the other one; that is said (BodiesOverlap).
  made.searched = places_[made.collider].left > 1 || places_[made.collidee].left > 1;
  made.is_far = true;
  remembering_.push_back(pair);
  return made;
}

void FarPairs::begin(SimTime apart_until, WatchedPairs& pairs, std::vector<std::uint32_t>& opened) {
  for (std::uint32_t object = 0; object < places_.size(); ++object) {
    if (places_[object].exists) open_near(object, SimTime::max(), apart_until, pairs, opened);
  }
}

bool FarPairs::add(std::uint32_t pair, SimTime s, SimTime oldest, MovingObjects& objects, WatchedPairs& pairs) {
  WatchedPair& p = pairs[pair];
  assert(!p.is_far);
  if (!may_be_far(pair)) return false;
  assert(!p.contact && !p.bears && !p.inside);
  for (const std::uint32_t object : {p.collider, p.collidee}) {
    const Place& place = places_[object];
    if (place.since > s || (place.known_until <= s && !stays_until(object, s, objects))) return false;
  }
  if (!apart(places_[p.collider].region, places_[p.collidee].region, p.type)) return false;
  assert(places_[p.collider].since <= s && places_[p.collidee].since <= s);
  for (const std::uint32_t object : {p.collider, p.collidee}) {
    places_[object].last_added = std::max(places_[object].last_added, s);
  }
  p.clear_until = s;
  p.is_scheduled = false;
  // A contact of `oldest` looks back so far.
  if (p.remembers_since(std::min(s, oldest) - kSameContact)) {
    p.is_far = true;
    remembering_.push_back(pair);
  } else {
    pairs.erase(pair);
  }
  return true;
}

void FarPairs::open_pair(std::uint32_t pair, SimTime apart_until, WatchedPairs& pairs,
                         std::vector<std::uint32_t>& opened) {
  WatchedPair& p = known(pair, apart_until, pairs);
  assert(p.is_far);
  p.clear_until = apart_until;
  p.is_far = false;
  opened.push_back(pair);
}

void FarPairs::open(WatchedPairs& pairs, std::vector<std::uint32_t>& opened) {
  for (const std::uint32_t i : pairs.numbers()) {
    const WatchedPair& pair = pairs[i];
    if (!pair.is_far) continue;
    open_pair(i, std::min(places_[pair.collider].known_until, places_[pair.collidee].known_until), pairs, opened);
  }
}

void FarPairs::open_between(std::uint32_t object, std::uint32_t other, const SweptRegion& place_of_other,
                            SimTime apart_until, WatchedPairs& pairs, std::vector<std::uint32_t>& opened) {
  model_->for_each_part_pair_between(object, other, [&](std::uint32_t pair) {
    const WatchedPair* const there = pairs.find(pair);
    if (there != nullptr ? !there->is_far : !may_be_far(pair)) return;
    if (apart(places_[object].region, place_of_other, type_of(pair))) return;
    open_pair(pair, std::min(apart_until, places_[other].known_until), pairs, opened);
  });
}

void FarPairs::open_near(std::uint32_t object, SimTime from, SimTime apart_until, WatchedPairs& pairs,
                         std::vector<std::uint32_t>& opened) {
  const WorldBox box = box_of(places_[object].region);
  index_.for_each_near(box.lo, box.hi, [&](std::uint32_t other) {
    if (other != object) open_between(object, other, places_[other].region, apart_until, pairs, opened);
  });
  past_index_.for_each_near(box.lo, box.hi, [&](std::uint32_t slot) {
    const PastPlace& past = past_[slot];
    if (past.object == object || past.until <= from) return;
    open_between(object, past.object, past.region, apart_until, pairs, opened);
  });
}

void FarPairs::open_all(std::uint32_t object, SimTime apart_until, WatchedPairs& pairs,
                        std::vector<std::uint32_t>& opened) {
  for (const std::uint32_t pair : model_->part_pairs_moved_by(object)) {
    const WatchedPair* const there = pairs.find(pair);
    if (there != nullptr ? !there->is_far : !may_be_far(pair)) continue;
    const PartPair ends = model_->part_pairs[pair];
    const std::uint32_t other = ends.a == object ? ends.b : ends.a;
    open_pair(pair, std::min(apart_until, places_[other].known_until), pairs, opened);
  }
}

bool FarPairs::make_near(std::span<const std::uint32_t> objects, double within_m, SimTime apart_until,
                         WatchedPairs& pairs) {
  assert(within_m >= 0.0);
  bool has_made = false;
  for (const std::uint32_t object : objects) {
    if (object == ModelNode::kNone || !places_[object].exists) continue;
    const auto make_with = [&](std::uint32_t other) {
      if (other == object) return;
      model_->for_each_part_pair_between(object, other, [&](std::uint32_t pair) {
        if (pairs.contains(pair) || !may_be_far(pair)) return;
        known(pair, apart_until, pairs);
        has_made = true;
      });
    };
    const auto make_around = [&](const SweptRegion& place) {
      const WorldBox box = box_of(place);
      const Vec3 low = box.lo - Vec3::Constant(within_m), high = box.hi + Vec3::Constant(within_m);
      index_.for_each_near(low, high, make_with);
      past_index_.for_each_near(low, high, [&](std::uint32_t slot) { make_with(past_[slot].object); });
    };
    make_around(places_[object].region);  // the instant that is asked of may be in one of the places before
    for (const std::uint32_t slot : places_[object].before) make_around(past_[slot].region);
  }
  return has_made;
}

void FarPairs::erase_unwatched(std::uint32_t object, SimTime s, WatchedPairs& pairs) {
  assert(places_[object].since == s);
  std::vector<std::uint32_t> gone;
  for (const std::uint32_t i : pairs.of_end(object)) {
    const WatchedPair& pair = pairs[i];
    if (pair.watched || pair.is_far || pair.stopped || pair.bears || pair.inside || !may_be_far(i)) continue;
    if (pair.remembers_since(s - kWorldHistory - kSameContact)) continue;
    Place &a = places_[pair.collider], &b = places_[pair.collidee];
    if (!apart(a.region, b.region, pair.type)) continue;
    a.last_added = std::max({a.last_added, a.since, b.since});
    b.last_added = std::max({b.last_added, a.since, b.since});
    gone.push_back(i);
  }
  for (const std::uint32_t i : gone) pairs.erase(i);
}

// ---- motion ----

// An opened pair counts as apart until the old law would have left the place. Where the new law comes from before that,
// MotionWorld::reopen_pairs() says how far back its own search goes.
void FarPairs::moved(std::size_t index, SimTime t, SimTime until, MovingObjects& objects, WatchedPairs& pairs,
                     std::vector<std::uint32_t>& opened) {
  if (index >= places_.size() || !places_[index].exists) return;
  const auto object = static_cast<std::uint32_t>(index);
  Place& place = places_[object];
  SimTime apart_until = place.known_until;
  t = std::max(t, until - kWorldHistory);
  const bool was_later = place.since > t;
  if (was_later) go_back(object, t);
  if (place.since > t) {  // before the first places nobody knows who was where
    open_all(object, apart_until, pairs, opened);
    Place anew = place_at(object, place.since, objects);
    anew.left = place.left + 1;
    place = std::move(anew);
    note_place(object);
  } else {
    place.known_until = std::min(place.known_until, t);
    if (was_later || t < place.last_added) open_near(object, t, apart_until, pairs, opened);
  }
  assert(place.known_until >= place.since);
  const SimTime last = std::max(t, until);
  while (!stays_until(object, last, objects)) {
    const SimTime s = place.known_until;
    enter(object, place_at(object, s, objects), s);
    apart_until = std::max(apart_until, s);
    open_near(object, s, apart_until, pairs, opened);
    erase_unwatched(object, s, pairs);
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
    for (const std::uint32_t object : left) enter(object, place_at(object, s, objects), s);
    for (const std::uint32_t object : left) {
      open_near(object, s, s, pairs, opened);
      erase_unwatched(object, s, pairs);
      follow_one(object);
    }
  }
}

// ---- pairs that are followed one by one ----

void KnownPairs::begin(const WorldModel& model) {
  assert(!has_begun_ && pairs_.empty());
  has_begun_ = true;
  has_pair_.assign(model.part_pairs.size(), false);
  has_pairs_of_.assign(model.nodes.size(), false);
}

void KnownPairs::note(std::uint32_t part_pair) {
  if (!has_begun_ || has_pair_[part_pair]) return;
  has_pair_[part_pair] = true;
  pairs_.push_back(part_pair);
}

void KnownPairs::note_far_of(std::size_t object, const WorldModel& model, const FarPairs& far) {
  if (!has_begun_ || object >= has_pairs_of_.size() || has_pairs_of_[object]) return;
  has_pairs_of_[object] = true;
  for (const std::uint32_t i : model.part_pairs_moved_by(object)) {
    if (far.may_be_far(i) && far.is_watched(model.part_pairs[i].pair)) note(i);
  }
}

std::span<const std::uint32_t> KnownPairs::sorted() {
  assert(has_begun_);
  std::ranges::sort(pairs_);
  return pairs_;
}

}  // namespace peerd::replication
