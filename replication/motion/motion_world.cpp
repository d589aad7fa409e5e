#include "replication/motion/motion_world.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "replication/motion/response.hpp"

namespace peerd::replication {
namespace {

// A search goes no farther than to the next multiple of this. A longer time finds contacts that the next update makes
// void; a shorter one searches more often.
constexpr Duration kLookahead = std::chrono::milliseconds(250);
// While two objects are inside each other and move apart, the next check is after this long. The step is fixed and not
// the tick, so that peers with other tick rates find the same.
constexpr Duration kOverlapRetry = std::chrono::milliseconds(10);
// An object with this many contacts within this time bounces ever lower (its bounces are below a micrometre for any
// acceleration up to 1 km/s^2): it is put to rest, or it would bounce for ever.
constexpr std::size_t kBouncesMax = 8;
constexpr Duration kBouncesWithin = std::chrono::milliseconds(1);
// Objects that respond by impulse pass impulses on among many (a rack that is broken), so ever lower bounces are
// counted by pair there, and an object has no room left with this many contacts.
constexpr std::size_t kImpulsesMax = 64;
// A bound on the work of one advance(); reached only by objects squeezed between others.
constexpr std::size_t kContactsMax = 1024;
// Timelines keep this much of the past, for updates that arrive late.
constexpr Duration kHistory = std::chrono::seconds(4);
// Timelines keep what is older for this much longer at most, or for as long again where that is less: a driven object
// gets a segment at each tick, and to forget them one by one would cost more than everything else.
constexpr Duration kPruneWithin = std::chrono::seconds(2);
// The objects' turns to be pruned within that time, so that one tick does not prune all of them.
constexpr std::int64_t kPruningSlots = 128;

SimTime grid_floor(SimTime t) {
  const std::int64_t ns = t.time_since_epoch().count(), step = kLookahead.count();
  const SimTime floor{Duration{(ns >= 0 ? ns / step : -((-ns + step - 1) / step)) * step}};
  assert(floor <= t && t - floor < kLookahead);
  return floor;
}

// Adds t, and keeps only the contacts that count together with one at t.
void remember(std::vector<SimTime>& recent, SimTime t) {
  std::erase_if(recent, [&](SimTime r) { return r + kBouncesWithin < t || r > t; });
  recent.push_back(t);
}

// A caller that asks for all objects does so in order: a piece is fetched so far ahead, and the law where it is
// needed.
constexpr std::size_t kPieceAhead = 8, kLawAhead = 4;

bool same_motion(const KinematicState& a, const KinematicState& b) {
  return a.position == b.position && a.velocity == b.velocity && a.acceleration == b.acceleration &&
         a.angular_velocity_body == b.angular_velocity_body;
}

}  // namespace

MotionWorld::Counters& MotionWorld::Counters::operator+=(const Counters& other) {
  contact_searches += other.contact_searches;
  searches_far += other.searches_far;
  searches_skipped += other.searches_skipped;
  contacts += other.contacts;
  contacts_undone += other.contacts_undone;
  came_to_rest += other.came_to_rest;
  jammed += other.jammed;
  overlapped += other.overlapped;
  unsupported += other.unsupported;
  failed += other.failed;
  capped += other.capped;
  return *this;
}

MotionWorld::MotionWorld(const WorldModel& model, SimTime start)
    : model_(model),
      start_(start),
      advanced_(start),
      index_by_id_(model.scene->instances.size(), kNone),
      pair_checks_(model.pairs.size()),
      in_pair_checks_(model.pairs.size()) {
  for (const collision::Body& b : model.bodies) declare(b.object, Role::kScene);
  for (const CollisionPair& p : model.pairs) {
    const auto answers = [&](ObjectId id) { return model.scene->object(id).response.has_value(); };
    const std::size_t collider = index_of(p.collider), collidee = index_of(p.collidee);
    pairs_.push_back({.collider = static_cast<std::uint32_t>(collider),
                      .collidee = static_cast<std::uint32_t>(collidee),
                      .type = p.type,
                      .collider_responds = answers(p.collider),
                      .collidee_responds = p.mutual && answers(p.collidee),
                      .has_exact_search =
                          p.type == CollisionType::kBox || collision::has_exact_answer(body(collider), body(collidee)),
                      .clear_until = start,
                      .contact = {},
                      .free_at = {},
                      .recent = {}});
  }
  assert(objects_.size() == model.bodies.size() && pairs_.size() == model.pairs.size());
}

std::span<const std::uint32_t> MotionWorld::pairs_of(std::size_t object) const {
  if (object >= model_.pairs_of_body.size()) return {};
  return model_.pairs_of_body[object];
}

void MotionWorld::declare(ObjectId object, Role role) {
  assert(object.value < index_by_id_.size());
  if (find(object) == nullptr) {  // apart from bodies: no interest names the object, and it meets nothing
    const KinematicState initial = at_rest(model_.scene->rigid_pose(object));
    index_by_id_[object.value] = static_cast<std::uint32_t>(objects_.size());
    objects_.push_back({.id = object,
                        .role = role,
                        .timeline = Timeline(start_, initial),
                        .base_time = start_,
                        .recent = {},
                        .bound = {}});
    return;
  }
  const std::size_t index = index_of(object);
  objects_[index].role = role;
  for (const std::uint32_t i : pairs_of(index)) {
    pairs_[i].clear_until = std::max(pairs_[i].clear_until, advanced_);
    reschedule(i);
  }
}

void MotionWorld::watch(ObjectId a, ObjectId b, bool on) {
  const auto of_a = model_.pairs_of(a), of_b = model_.pairs_of(b);
  const bool a_has_fewer = of_a.size() < of_b.size();
  const ObjectId other = a_has_fewer ? b : a;
  for (const std::uint32_t i : a_has_fewer ? of_a : of_b) {
    if (objects_[pairs_[i].collider].id == other || objects_[pairs_[i].collidee].id == other) watch(i, on);
  }
}

void MotionWorld::watch(std::uint32_t number, bool on) {
  assert(number < pairs_.size());
  Pair& pair = pairs_[number];
  if (pair.watched == on) return;
  pair.watched = on;
  pair.contact.reset();
  pair.clear_until = std::max(pair.clear_until, advanced_);
  reschedule(number);
}

// Called after any change of whether the pair is watched, or of what is known of it.
void MotionWorld::reschedule(std::size_t i) {
  const Pair& pair = pairs_[i];
  const bool scene = objects_[pair.collider].role == Role::kScene && objects_[pair.collidee].role == Role::kScene;
  const bool scheduled = pair.watched && !pair.unsupported && !scene;
  if (scheduled != in_pair_checks_[i]) {
    in_pair_checks_[i] = scheduled;
    scheduled ? ++watched_ : --watched_;
  }
  assert(watched_ <= pairs_.size());
  pair_checks_.set(i, scheduled ? pair.contact.value_or(pair.clear_until) : SimTime::max());
}

Duration MotionWorld::history_of(const Object& o) const {
  return o.role == Role::kDriven ? driven_history_.value_or(kHistory) : kHistory;
}

void MotionWorld::note_change(std::size_t index) {
  if (std::exchange(objects_[index].changed, true)) return;
  changed_.push_back(static_cast<std::uint32_t>(index));
}

// Called after any change of the object's timeline.
void MotionWorld::timeline_changed(std::size_t index) {
  note_change(index);
  schedule_pruning(index);
}

void MotionWorld::schedule_pruning(std::size_t index) {
  Object& o = objects_[index];
  o.bound.until = SimTime::min();
  if (o.pruning_scheduled || o.timeline.segment_count() < 2) return;
  o.pruning_scheduled = true;
  const Duration history = history_of(o), within = std::min(kPruneWithin, history);
  const Duration turn = within / kPruningSlots * (static_cast<std::int64_t>(index) % kPruningSlots);
  const SimTime old = o.timeline.segment(1).from;
  const Duration wait = within - (old.time_since_epoch() + turn) % within;
  prunings_.push_back({old + wait + history, static_cast<std::uint32_t>(index)});
  std::ranges::push_heap(prunings_, std::greater{});
}

void MotionWorld::prune_timelines() {
  while (!prunings_.empty() && prunings_.front().at <= advanced_) {
    const Pruning due = prunings_.front();
    std::ranges::pop_heap(prunings_, std::greater{});
    prunings_.pop_back();
    Object& o = objects_[due.object];
    o.pruning_scheduled = false;
    o.timeline.forget_before(advanced_ - history_of(o));
    schedule_pruning(due.object);
  }
}

void MotionWorld::set_base(ObjectId object, SimTime t, const MotionModel& model) {
  const std::size_t index = index_of(object);
  Object& o = objects_[index];
  o.base_time = t;
  ++o.revision;
  if (pairs_of(index).empty()) {  // it meets nothing
    if (o.role == Role::kDriven && driven_history_) {
      o.timeline.restart(t, model);
      note_change(index);
    } else {
      o.timeline.replace_from(t, model, std::nullopt);
      timeline_changed(index);
    }
    return;
  }
  events_.push_back(ContactsRetracted{object, t - Duration{1}});
  retract(index, t);
  o.timeline.replace_from(t, model, std::nullopt);
  timeline_changed(index);
  clear_bounces(index, SimTime::min());
  reopen_pairs(index, t);
}

void MotionWorld::clear_bounces(std::size_t object, SimTime from) {
  const auto later = [&](SimTime t) { return t >= from; };
  std::erase_if(objects_[object].recent, later);
  for (const std::uint32_t i : pairs_of(object)) std::erase_if(pairs_[i].recent, later);
}

// Retracts what followed from a contact with `cause` at t or later. Responses of authoritative objects stand.
void MotionWorld::retract(std::size_t cause, SimTime t) {
  if (cause >= model_.partners_of_body.size()) return;  // it meets nothing
  for (const std::uint32_t i : model_.partners_of_body[cause]) {
    Object& o = objects_[i];
    if (o.role != Role::kPredicted) continue;
    std::size_t wrong = o.timeline.first_not_before(t);
    while (wrong < o.timeline.segment_count() && o.timeline.segment(wrong).cause != objects_[cause].id) ++wrong;
    if (wrong == 0 || wrong == o.timeline.segment_count()) continue;
    const SimTime from = o.timeline.segment(wrong).from;
    if (o.base_time >= from) continue;  // its owner has published since
    o.timeline.truncate_from(from);
    timeline_changed(i);
    clear_bounces(i, from);
    ++o.revision;
    events_.push_back(ContactsRetracted{o.id, from - Duration{1}});
    ++counters_.contacts_undone;
    reopen_pairs(i, from);
    retract(i, from);
  }
}

// The object's pieces changed from t on: what its pairs know of later contacts is void. Pairs with an authoritative or
// driven object are not searched again in the past because another object moved otherwise; its own change (a decision)
// makes them searched there.
void MotionWorld::reopen_pairs(std::size_t object, SimTime t) {
  for (const std::uint32_t i : pairs_of(object)) {
    Pair& pair = pairs_[i];
    const Role other = objects_[pair.collider == object ? pair.collidee : pair.collider].role;
    const bool lived = other == Role::kAuthoritative || other == Role::kDriven;
    const SimTime known = std::max(objects_[pair.collider].timeline.begin(), objects_[pair.collidee].timeline.begin());
    const SimTime from = std::max({t, known, advanced_ - (lived ? Duration{0} : kHistory)});
    if (pair.contact && *pair.contact >= from) pair.contact.reset();
    if (pair.free_at && *pair.free_at >= from) pair.free_at.reset();
    pair.clear_until = std::min(pair.clear_until, from);
    reschedule(i);
  }
}

// An update that its owner made after t already contains the outcome.
bool MotionWorld::will_respond(const Object& o, bool registered, SimTime t) {
  return registered && o.role >= Role::kAuthoritative && o.base_time <= t;
}

const SweptBound& MotionWorld::bound_of(std::size_t object, SimTime s) {
  Object& o = objects_[object];
  if (!o.bound.answers_for(s)) {
    o.bound = swept_bound(o.timeline, body(object), s, grid_floor(s), grid_floor(s) + kLookahead);
  }
  return o.bound;
}

void MotionWorld::search_window(Pair& pair) {
  const SimTime s = pair.clear_until;
  const SweptBound &bound_a = bound_of(pair.collider, s), &bound_b = bound_of(pair.collidee, s);
  SimTime end = grid_floor(s) + kLookahead;
  if (bound_a.next_change) end = std::min(end, *bound_a.next_change);
  if (bound_b.next_change) end = std::min(end, *bound_b.next_change);
  assert(end > s);

  if (bound_a.still && bound_b.still) {  // two objects that stand do not meet
    ++counters_.searches_skipped;
    pair.clear_until = bound_a.next_change || bound_b.next_change ? end : SimTime::max();
    return;
  }
  if (pair.has_exact_search && apart(bound_a, bound_b, pair.type)) {
    ++counters_.searches_far;
    pair.inside = false;
    pair.free_at = s;
    pair.clear_until = end;
    return;
  }
  // A search begins not where this peer happens to be, but at the last instant until s that the timelines alone
  // decide, so that equal timelines give equal contact times, to the last bit.
  SimTime begin = grid_floor(s);
  if (bound_a.last_change) begin = std::max(begin, *bound_a.last_change);
  if (bound_b.last_change) begin = std::max(begin, *bound_b.last_change);
  search_interval(pair, begin, end);
}

void MotionWorld::search_interval(Pair& pair, SimTime begin, SimTime end) {
  const Object &a = objects_[pair.collider], &b = objects_[pair.collidee];
  const SimTime s = pair.clear_until;
  assert(begin <= s && s < end);
  KinematicState state_a, state_b;
  const auto search_from = [&](SimTime from) {
    begin = from;
    state_a = a.timeline.at(begin);
    state_b = b.timeline.at(begin);
    ++counters_.contact_searches;
    return collision::first_contact({body(pair.collider), state_a}, {body(pair.collidee), state_b}, pair.type,
                                    to_seconds(end - begin));
  };
  const auto time_of = [&](const collision::Contact& found) {
    return begin + Duration{static_cast<std::int64_t>(std::floor(found.time_s * 1e9))};
  };
  collision::Contact c = search_from(begin);
  // Contacts before s have been dealt with.
  if (begin < s && c.state != collision::ContactState::kSeparated && time_of(c) < s) c = search_from(s);
  const auto contact_at = [&](SimTime t, bool overlapped) {
    assert(t >= s);
    pair.contact = t;
    pair.clear_until = t;
    pair.normal = c.normal_world;
    pair.overlapped = overlapped;
    pair.resting = c.resting;
  };
  switch (c.state) {
    case collision::ContactState::kSeparated:
      pair.inside = false;
      pair.free_at = s;
      pair.clear_until = end;
      return;
    case collision::ContactState::kContact: {
      const SimTime t = time_of(c);
      if (t > s) {
        pair.inside = false;
        pair.free_at = s;
      }
      if (pair.inside) {
        pair.clear_until = std::min(s + kOverlapRetry, end);
      } else if (t >= end) {
        pair.clear_until = end;  // the next pieces, or the next search, begin first
      } else {
        contact_at(t, false);
      }
      return;
    }
    case collision::ContactState::kOverlapped: {
      ++counters_.overlapped;
      const bool approaching = c.normal_world.dot(state_a.velocity - state_b.velocity) < 0.0;
      const bool answers = will_respond(a, pair.collider_responds, s) || will_respond(b, pair.collidee_responds, s);
      if (approaching && answers && !pair.inside) {
        contact_at(s, true);
      } else {
        pair.clear_until = std::min(s + kOverlapRetry, end);
      }
      return;
    }
    case collision::ContactState::kUnsupported:
      ++counters_.unsupported;
      pair.unsupported = true;
      return;
    case collision::ContactState::kFailed:
      ++counters_.failed;
      pair.clear_until = std::min(std::max(s + kOverlapRetry, begin + from_seconds(c.time_s)), end);
      return;
  }
}

void MotionWorld::search(Pair& pair, SimTime to) {
  if (pair.contact || pair.clear_until > to) {
    ++counters_.searches_skipped;
    return;
  }
  while (!pair.contact && !pair.unsupported && pair.clear_until <= to) search_window(pair);
}

MotionModel MotionWorld::motion_after_response(std::size_t object, const Pair& pair, const MotionModel& self,
                                               const KinematicState& other, bool other_responds, const Vec3& n) {
  Object& o = objects_[object];
  const CollisionResponse* const response = model_.response_of(o.id);
  assert(response != nullptr && pair.contact);
  const Object& met = objects_[pair.collider == object ? pair.collidee : pair.collider];
  const ContactSide side{*response, model_.response_of(met.id), other_responds, self.state, other, n};
  const SimTime t = *pair.contact;
  const bool impulse = response->type == ResponseType::kImpulse;
  remember(o.recent, t);
  const std::size_t bounces = impulse ? pair.recent.size() : o.recent.size();
  if (o.recent.size() >
      (impulse ? kImpulsesMax : 2 * kBouncesMax)) {  // the object is between two that leave it no room
    ++counters_.jammed;
    CollisionResponse stops = *response;
    stops.type = ResponseType::kZero;
    return respond({stops, side.other_response, other_responds, self.state, other, n});
  }
  if (pair.resting || bounces > kBouncesMax) {
    ++counters_.came_to_rest;
    const KinematicState after = come_to_rest_against(side, pair.resting);
    return impulse ? law_after(response, self, after) : MotionModel(after);
  }
  KinematicState after = respond(side);
  // At a contact time the object still stands where it did not collide; only an overlap leaves something to set back.
  if (pair.overlapped && response->set_back && pair.free_at) after.position = o.timeline.at(*pair.free_at).position;
  if (same_motion(after, self.state)) return self;
  if (impulse) return law_after(response, self, after);
  return after_contact(self, after, n, response->type == ResponseType::kInverse);
}

void MotionWorld::respond_to_contact(Pair& pair) {
  assert(pair.contact);
  const SimTime t = *pair.contact;
  Object &a = objects_[pair.collider], &b = objects_[pair.collidee];
  const MotionModel model_a = a.timeline.model_at(t), model_b = b.timeline.model_at(t);
  MotionModel after_a = model_a, after_b = model_b;
  const KinematicState &before_a = model_a.state, &before_b = model_b.state;
  const ContactAuthority authority = authority_of_ ? authority_of_(a.id, b.id, t) : ContactAuthority::kAsPublished;
  const auto answers = [&](const Object& o, bool registered) {
    const bool could_not_know = authority != ContactAuthority::kAsPublished && o.role == Role::kPredicted;
    return will_respond(o, registered, could_not_know ? SimTime::max() : t);
  };
  const bool a_responds = answers(a, pair.collider_responds), b_responds = answers(b, pair.collidee_responds);
  remember(pair.recent, t);
  if (a_responds) after_a = motion_after_response(pair.collider, pair, model_a, before_b, b_responds, pair.normal);
  if (b_responds) after_b = motion_after_response(pair.collidee, pair, model_b, before_a, a_responds, -pair.normal);
  // An object that slides by the world's friction is published with exactly the deceleration by which receivers
  // recognise it (law_of_outcome), also where it does not respond: that of its own law has been turned and rounded
  // since its base.
  const auto state_as_published = [&](ObjectId id, const MotionModel& after) {
    const bool slides = after.kind == MotionKind::kSliding;
    return slides ? law_after(model_.response_of(id), after, after.state).state : after.state;
  };
  ContactEvent event{t,
                     a.id,
                     b.id,
                     pair.normal,
                     before_a,
                     before_b,
                     state_as_published(a.id, after_a),
                     state_as_published(b.id, after_b)};
  pair.contact.reset();
  ++counters_.contacts;
  if (authority == ContactAuthority::kDeferred) {
    pair.inside = true;
    event.deferred = true;
    events_.push_back(event);
    return;
  }
  for (const auto& [changes, index] : {std::pair{a_responds, pair.collider}, std::pair{b_responds, pair.collidee}}) {
    if (!changes) continue;
    if (objects_[index].timeline.last_segment().from > t) events_.push_back(ContactsRetracted{objects_[index].id, t});
    retract(index, t);
    clear_bounces(index, t + Duration{1});
  }
  if (a_responds) a.timeline.replace_from(t, after_a, b.id);
  if (b_responds) b.timeline.replace_from(t, after_b, a.id);
  for (const auto& [changes, index] : {std::pair{a_responds, pair.collider}, std::pair{b_responds, pair.collidee}}) {
    if (!changes) continue;
    timeline_changed(index);
    reopen_pairs(index, t);
  }
  // A contact in which no response changes anything (nobody responds; an object that was stopped is run into) goes on.
  pair.inside = same_motion(before_a, after_a.state) && same_motion(before_b, after_b.state);
  events_.push_back(event);
}

void MotionWorld::advance(SimTime to) {
  for (std::size_t contacts = 0;; ++contacts) {
    std::optional<std::size_t> first;
    const std::size_t watched = watched_;
    std::size_t checked = 0;
    for (std::size_t i = pair_checks_.next_due(0, to); i != pairs_.size(); i = pair_checks_.next_due(i + 1, to)) {
      Pair& pair = pairs_[i];
      ++checked;
      search(pair, first ? *pairs_[*first].contact : to);
      reschedule(i);
      const bool due = pair.contact && *pair.contact <= to;
      if (due && (!first || *pair.contact < *pairs_[*first].contact)) first = i;
    }
    counters_.searches_skipped += watched - checked;
    if (!first) break;
    assert(*pairs_[*first].contact <= to);
    if (contacts == kContactsMax) {
      ++counters_.capped;
      for (std::size_t i = 0; i < pairs_.size(); ++i) {
        Pair& pair = pairs_[i];
        if (!pair.contact || *pair.contact > to) continue;
        pair.contact.reset();
        pair.clear_until = to + Duration{1};
        reschedule(i);
      }
      break;
    }
    respond_to_contact(pairs_[*first]);
    reschedule(*first);
  }
  advanced_ = std::max(advanced_, to);
  prune_timelines();
}

std::vector<ObjectId> MotionWorld::objects() const {
  std::vector<ObjectId> ids;
  for (const Object& o : objects_) ids.push_back(o.id);
  std::ranges::sort(ids);
  return ids;
}

KinematicState MotionWorld::at(ObjectId object, SimTime t) const {
  const std::size_t index = index_of(object);
  if (index + kPieceAhead < objects_.size()) {
    objects_[index + kPieceAhead].timeline.prefetch_piece();
    objects_[index + kLawAhead].timeline.prefetch_law(t);
  }
  return objects_[index].timeline.at(t);
}

bool MotionWorld::is_at_rest_from(ObjectId object, SimTime t) const {
  const Timeline& timeline = objects_[index_of(object)].timeline;
  return is_motionless(timeline.at(t)) && !timeline.next_change_after(t);
}

MotionModel MotionWorld::model_at(ObjectId object, SimTime t) const {
  return objects_[index_of(object)].timeline.model_at(t);
}

bool MotionWorld::has_history_at(ObjectId object, SimTime t) const {
  const Object* o = find(object);
  return o != nullptr && o->timeline.segment_at(advanced_ - history_of(*o)).from <= t;
}

SimTime MotionWorld::law_since(ObjectId object, SimTime t) const {
  return objects_[index_of(object)].timeline.segment_at(t).from;
}

SimTime MotionWorld::base_time(ObjectId object) const { return objects_[index_of(object)].base_time; }

std::uint64_t MotionWorld::revision(ObjectId object) const { return objects_[index_of(object)].revision; }

std::optional<MotionWorld::Event> MotionWorld::poll_event() {
  assert(polled_ <= events_.size());
  if (polled_ < events_.size()) return std::move(events_[polled_++]);
  events_.clear();
  polled_ = 0;
  return std::nullopt;
}

}  // namespace peerd::replication
