#include "replication/motion_world.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <tuple>

#include "core/predefined_motion.hpp"
#include "replication/response.hpp"

namespace peerd::replication {
namespace {

// A search looks no farther than to the next multiple of this. Longer finds contacts that the next update makes void;
// shorter searches more often.
constexpr Duration kLookahead = std::chrono::milliseconds(250);
// While two objects are inside each other and move apart, look again after this long. A fixed step, not the tick, so
// that peers with other tick rates see the same.
constexpr Duration kOverlapRetry = std::chrono::milliseconds(10);
// An object with this many contacts within this time bounces ever lower (its bounces are below a micrometre for any
// acceleration up to 1 km/s^2): it is put to rest instead of bounced on for ever.
constexpr std::size_t kBouncesMax = 8;
constexpr Duration kBouncesWithin = std::chrono::milliseconds(1);
// Those that answer by impulse are handed on among many (a rack that is broken), so what bounces ever lower is counted
// by pair there, and one that has no room left by this many contacts.
constexpr std::size_t kImpulsesMax = 64;
// A bound on the work of one advance(); reached only by objects squeezed between others.
constexpr std::size_t kContactsMax = 1024;
// Timelines keep this much past, for updates that arrive late.
constexpr Duration kHistory = std::chrono::seconds(4);

bool is_inside(const Scene& scene, ObjectId inner, ObjectId outer) {
  return inner.value >= outer.value && inner.value < scene.at(outer).subtree_end;
}

bool is_still(const KinematicState& s) {
  return s.velocity.isZero(0.0) && s.acceleration.isZero(0.0) && s.angular_velocity_body.isZero(0.0);
}

SimTime grid_floor(SimTime t) {
  const std::int64_t ns = t.time_since_epoch().count(), step = kLookahead.count();
  return SimTime{Duration{(ns >= 0 ? ns / step : -((-ns + step - 1) / step)) * step}};
}

// Leaves those that count for one at t, which is added.
void remember(std::vector<SimTime>& recent, SimTime t) {
  std::erase_if(recent, [&](SimTime r) { return r + kBouncesWithin < t || r > t; });
  recent.push_back(t);
}

bool same_motion(const KinematicState& a, const KinematicState& b) {
  return a.position == b.position && a.velocity == b.velocity && a.acceleration == b.acceleration &&
         a.angular_velocity_body == b.angular_velocity_body;
}

// By type and the lower and the higher of the two: which of the model's pairs that is.
using KnownPairs = std::map<std::tuple<CollisionType, ObjectId, ObjectId>, std::size_t>;

void add_pair(WorldModel& model, KnownPairs& known, const CollisionPair& pair) {
  const auto [lower, higher] = std::minmax(pair.collider, pair.collidee);
  const auto [it, is_new] = known.try_emplace({pair.type, lower, higher}, model.pairs.size());
  if (is_new) {
    model.pairs.push_back(pair);
  } else if (model.pairs[it->second].collider != pair.collider) {
    model.pairs[it->second].mutual = true;
  }
}

}  // namespace

MotionWorld::Counters& MotionWorld::Counters::operator+=(const Counters& other) {
  contact_searches += other.contact_searches;
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

const collision::Body* WorldModel::body(ObjectId id) const {
  const auto at = std::ranges::lower_bound(bodies, id, {}, &collision::Body::object);
  return at != bodies.end() && at->object == id ? &*at : nullptr;
}

const CollisionResponse* WorldModel::response_of(ObjectId id) const {
  const auto& response = scene->object(id).response;
  return response ? &*response : nullptr;
}

std::unique_ptr<const WorldModel> make_world_model(const Scene& scene) {
  auto model = std::make_unique<WorldModel>();
  model->scene = &scene;
  std::vector<ObjectId> named;
  KnownPairs known;
  for (const CollisionInterest& interest : scene.interests) {
    for (ObjectId collidee : interest.collidees) {
      if (is_inside(scene, interest.collider, collidee) || is_inside(scene, collidee, interest.collider)) {
        model->unsupported.push_back(scene.path_of(interest.collider) + " against " + scene.path_of(collidee) +
                                     ": one contains the other; collisions within an object are not answered yet");
        continue;
      }
      add_pair(*model, known, {interest.collider, collidee, interest.type, false});
      named.push_back(interest.collider);
      named.push_back(collidee);
    }
  }
  std::ranges::sort(named);
  named.erase(std::ranges::unique(named).begin(), named.end());
  if (named.empty()) return model;
  const PredefinedMotion predefined(scene);
  for (ObjectId id : named) {
    model->bodies.push_back(collision::make_body(scene, id));
    if (predefined.moves(id)) model->moving.push_back(id);
    if (!predefined.stays_rigid(id)) {
      model->bodies.back().unsupported = scene.path_of(id) + ": the file changes its shape as it moves";
    }
    if (!model->bodies.back().unsupported.empty()) model->unsupported.push_back(model->bodies.back().unsupported);
  }
  for (const CollisionPair& pair : model->pairs) {
    const collision::Body &a = *model->body(pair.collider), &b = *model->body(pair.collidee);
    const bool said = !a.unsupported.empty() || !b.unsupported.empty();
    if (pair.type == CollisionType::kBox || said || collision::answerable(a, b)) continue;
    model->unsupported.push_back(scene.path_of(pair.collider) + " against " + scene.path_of(pair.collidee) +
                                 ": one is not convex, and one is larger than 2^58 m");
  }
  return model;
}

MotionWorld::MotionWorld(const WorldModel& model, SimTime start) : model_(model), start_(start), advanced_(start) {
  for (const collision::Body& body : model.bodies) {
    const KinematicState initial = at_rest(model.scene->rigid_pose(body.object));
    objects_.push_back({body.object, Role::kScene, Timeline(start, initial), start, {}});
  }
  for (const CollisionPair& p : model.pairs) {
    const auto answers = [&](ObjectId id) { return model.scene->object(id).response.has_value(); };
    pairs_.push_back({.collider = index_of(p.collider),
                      .collidee = index_of(p.collidee),
                      .collider_body = model.body(p.collider),
                      .collidee_body = model.body(p.collidee),
                      .type = p.type,
                      .collider_answers = answers(p.collider),
                      .collidee_answers = p.mutual && answers(p.collidee),
                      .clear_until = start,
                      .contact = {},
                      .free_at = {},
                      .recent = {}});
  }
}

const MotionWorld::Object* MotionWorld::find(ObjectId id) const {
  const auto at = std::ranges::lower_bound(objects_, id, {}, &Object::id);
  return at != objects_.end() && at->id == id ? &*at : nullptr;
}

std::size_t MotionWorld::index_of(ObjectId id) const {
  const Object* object = find(id);
  assert(object != nullptr);
  return static_cast<std::size_t>(object - objects_.data());
}

void MotionWorld::declare(ObjectId object, Role role) {
  if (find(object) == nullptr) {  // no interest names it: it moves and meets nothing
    const auto at = std::ranges::lower_bound(objects_, object, {}, &Object::id);
    const std::size_t index = static_cast<std::size_t>(at - objects_.begin());
    const KinematicState initial = at_rest(model_.scene->rigid_pose(object));
    objects_.insert(at, {object, role, Timeline(start_, initial), start_, {}});
    for (Pair& pair : pairs_) {
      pair.collider += pair.collider >= index;
      pair.collidee += pair.collidee >= index;
    }
    return;
  }
  const std::size_t index = index_of(object);
  objects_[index].role = role;
  for (Pair& pair : pairs_) {
    if (pair.collider == index || pair.collidee == index) pair.clear_until = std::max(pair.clear_until, advanced_);
  }
}

void MotionWorld::watch(ObjectId a, ObjectId b, bool on) {
  for (Pair& pair : pairs_) {
    const ObjectId collider = objects_[pair.collider].id, collidee = objects_[pair.collidee].id;
    if (!((collider == a && collidee == b) || (collider == b && collidee == a)) || pair.watched == on) continue;
    pair.watched = on;
    pair.contact.reset();
    pair.clear_until = std::max(pair.clear_until, advanced_);
  }
}

void MotionWorld::set_base(ObjectId object, SimTime t, const MotionModel& model) {
  const std::size_t index = index_of(object);
  Object& o = objects_[index];
  events_.push_back(TakenBack{object, t - Duration{1}});
  take_back(index, t);
  o.timeline.replace_from(t, model, std::nullopt);
  o.base_time = t;
  ++o.revision;
  forget_bounces(index, SimTime::min());
  reopen(index, t);
}

void MotionWorld::forget_bounces(std::size_t object, SimTime from) {
  const auto later = [&](SimTime t) { return t >= from; };
  std::erase_if(objects_[object].recent, later);
  for (Pair& pair : pairs_) {
    if (pair.collider == object || pair.collidee == object) std::erase_if(pair.recent, later);
  }
}

// What followed from a contact with `cause` at t or later is believed no more. Firm answers stand.
void MotionWorld::take_back(std::size_t cause, SimTime t) {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Object& o = objects_[i];
    if (i == cause || o.role != Role::kBelief) continue;
    const auto& segments = o.timeline.segments();
    const auto wrong = std::ranges::find_if(
        segments, [&](const Timeline::Segment& s) { return s.from >= t && s.cause == objects_[cause].id; });
    if (wrong == segments.end() || wrong == segments.begin()) continue;
    const SimTime from = wrong->from;
    if (o.base_time >= from) continue;  // its owner has spoken since
    o.timeline.truncate_from(from);
    forget_bounces(i, from);
    ++o.revision;
    events_.push_back(TakenBack{o.id, from - Duration{1}});
    ++counters_.contacts_undone;
    reopen(i, from);
    take_back(i, from);
  }
}

// The object's pieces changed from t on: what its pairs know of later contacts is void. What stands firm is not
// searched in the past that this peer has already lived because another moved otherwise; its own change (a decision)
// is.
void MotionWorld::reopen(std::size_t object, SimTime t) {
  for (Pair& pair : pairs_) {
    if (pair.collider != object && pair.collidee != object) continue;
    const Role other = objects_[pair.collider == object ? pair.collidee : pair.collider].role;
    const bool lived = other == Role::kFirm || other == Role::kDriven;
    const SimTime from = std::max(t, advanced_ - (lived ? Duration{0} : kHistory));
    if (pair.contact && *pair.contact >= from) pair.contact.reset();
    if (pair.free_at && *pair.free_at >= from) pair.free_at.reset();
    pair.clear_until = std::min(pair.clear_until, from);
  }
}

// An update that its owner made after t already holds the outcome.
bool MotionWorld::will_answer(const Object& o, bool registered, SimTime t) {
  return registered && o.role >= Role::kFirm && o.base_time <= t;
}

// Where a search begins: not where this peer happens to have got to, but the last instant until s that the timelines
// alone decide, so that where they are equal contact times are, to the last bit.
SimTime MotionWorld::search_begin(const Pair& pair, SimTime s) const {
  SimTime begin = grid_floor(s);
  for (const std::size_t index : {pair.collider, pair.collidee}) {
    if (const auto change = objects_[index].timeline.last_change_until(s)) begin = std::max(begin, *change);
  }
  return begin;
}

// One search over the time in which both objects keep their pieces, or until the next multiple of kLookahead.
void MotionWorld::search_window(Pair& pair) {
  const Object &a = objects_[pair.collider], &b = objects_[pair.collidee];
  const SimTime s = pair.clear_until;
  const SimTime grid_end = grid_floor(s) + kLookahead;
  SimTime end = grid_end;
  const auto change_a = a.timeline.next_change_after(s), change_b = b.timeline.next_change_after(s);
  if (change_a) end = std::min(end, *change_a);
  if (change_b) end = std::min(end, *change_b);

  if (is_still(a.timeline.at(s)) && is_still(b.timeline.at(s))) {  // nothing that stands meets anything
    ++counters_.searches_skipped;
    pair.clear_until = change_a || change_b ? end : SimTime::max();
    return;
  }
  SimTime begin = search_begin(pair, s);
  KinematicState state_a, state_b;
  const auto search_from = [&](SimTime from) {
    begin = from;
    state_a = a.timeline.at(begin);
    state_b = b.timeline.at(begin);
    ++counters_.contact_searches;
    return collision::first_contact({*pair.collider_body, state_a}, {*pair.collidee_body, state_b}, pair.type,
                                    to_seconds(end - begin));
  };
  const auto time_of = [&](const collision::Contact& found) {
    return begin + Duration{static_cast<std::int64_t>(std::floor(found.time_s * 1e9))};
  };
  collision::Contact c = search_from(begin);
  // What came before s has been dealt with.
  if (begin < s && c.state != collision::ContactState::kSeparated && time_of(c) < s) c = search_from(s);
  const auto contact_at = [&](SimTime t, bool overlapped) {
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
      const bool answers = will_answer(a, pair.collider_answers, s) || will_answer(b, pair.collidee_answers, s);
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

MotionModel MotionWorld::answered(std::size_t object, const Pair& pair, const MotionModel& self,
                                  const KinematicState& other, bool other_answers, const Vec3& n) {
  Object& o = objects_[object];
  const CollisionResponse* const response = model_.response_of(o.id);
  const Object& met = objects_[pair.collider == object ? pair.collidee : pair.collider];
  const Meeting meeting{*response, model_.response_of(met.id), other_answers, self.state, other, n};
  const SimTime t = *pair.contact;
  const bool impulse = response->type == ResponseType::kImpulse;
  remember(o.recent, t);
  const std::size_t bounces = impulse ? pair.recent.size() : o.recent.size();
  if (o.recent.size() > (impulse ? kImpulsesMax : 2 * kBouncesMax)) {  // between two that leave it no room
    ++counters_.jammed;
    CollisionResponse stops = *response;
    stops.type = ResponseType::kZero;
    return respond({stops, meeting.other_response, other_answers, self.state, other, n});
  }
  if (pair.resting || bounces > kBouncesMax) {
    ++counters_.came_to_rest;
    const KinematicState after = rest_against(meeting, pair.resting);
    return impulse ? law_after(response, self, after) : MotionModel(after);
  }
  KinematicState after = respond(meeting);
  // At a contact time the object still stands where it did not collide; only an overlap leaves something to set back.
  if (pair.overlapped && response->set_back && pair.free_at) after.position = o.timeline.at(*pair.free_at).position;
  if (same_motion(after, self.state)) return self;
  if (impulse) return law_after(response, self, after);
  return after_contact(self, after, n, response->type == ResponseType::kInverse);
}

void MotionWorld::answer(Pair& pair) {
  const SimTime t = *pair.contact;
  Object &a = objects_[pair.collider], &b = objects_[pair.collidee];
  const MotionModel model_a = a.timeline.model_at(t), model_b = b.timeline.model_at(t);
  MotionModel after_a = model_a, after_b = model_b;
  const KinematicState &before_a = model_a.state, &before_b = model_b.state;
  const bool a_answers = will_answer(a, pair.collider_answers, t), b_answers = will_answer(b, pair.collidee_answers, t);
  remember(pair.recent, t);
  if (a_answers) after_a = answered(pair.collider, pair, model_a, before_b, b_answers, pair.normal);
  if (b_answers) after_b = answered(pair.collidee, pair, model_b, before_a, a_answers, -pair.normal);
  // What slides by the world's friction is told with just the deceleration that whoever hears of it knows it by
  // (law_of_outcome), also where it does not answer: its own law's has been turned and rounded since its base.
  const auto told = [&](ObjectId id, const MotionModel& after) {
    const bool slides = after.kind == MotionKind::kSliding;
    return slides ? law_after(model_.response_of(id), after, after.state).state : after.state;
  };
  ContactEvent event{t, a.id, b.id, pair.normal, before_a, before_b, told(a.id, after_a), told(b.id, after_b)};
  pair.contact.reset();
  ++counters_.contacts;
  if (answers_ && !answers_(a.id, b.id, t)) {
    pair.inside = true;
    event.held = true;
    events_.push_back(event);
    return;
  }
  for (const auto& [answers, index] : {std::pair{a_answers, pair.collider}, std::pair{b_answers, pair.collidee}}) {
    if (!answers) continue;
    if (objects_[index].timeline.segments().back().from > t) events_.push_back(TakenBack{objects_[index].id, t});
    take_back(index, t);
    forget_bounces(index, t + Duration{1});
  }
  if (a_answers) a.timeline.replace_from(t, after_a, b.id);
  if (b_answers) b.timeline.replace_from(t, after_b, a.id);
  if (a_answers) reopen(pair.collider, t);
  if (b_answers) reopen(pair.collidee, t);
  // Where no answer changes anything (nobody answers; an object that was stopped is run into) the contact goes on.
  pair.inside = same_motion(before_a, after_a.state) && same_motion(before_b, after_b.state);
  events_.push_back(event);
}

void MotionWorld::advance(SimTime to) {
  for (std::size_t contacts = 0;; ++contacts) {
    Pair* first = nullptr;
    for (Pair& pair : pairs_) {
      if (!pair.watched || pair.unsupported) continue;
      if (objects_[pair.collider].role == Role::kScene && objects_[pair.collidee].role == Role::kScene) continue;
      search(pair, first == nullptr ? to : *first->contact);
      if (pair.contact && *pair.contact <= to && (first == nullptr || *pair.contact < *first->contact)) first = &pair;
    }
    if (first == nullptr) break;
    if (contacts == kContactsMax) {
      ++counters_.capped;
      for (Pair& pair : pairs_) {
        if (!pair.contact || *pair.contact > to) continue;
        pair.contact.reset();
        pair.clear_until = to + Duration{1};
      }
      break;
    }
    answer(*first);
  }
  advanced_ = std::max(advanced_, to);
  for (Object& o : objects_) o.timeline.forget_before(advanced_ - kHistory);
}

bool MotionWorld::has(ObjectId object) const { return find(object) != nullptr; }

std::vector<ObjectId> MotionWorld::objects() const {
  std::vector<ObjectId> ids;
  for (const Object& o : objects_) ids.push_back(o.id);
  return ids;
}

KinematicState MotionWorld::at(ObjectId object, SimTime t) const { return objects_[index_of(object)].timeline.at(t); }

MotionModel MotionWorld::model_at(ObjectId object, SimTime t) const {
  return objects_[index_of(object)].timeline.model_at(t);
}

bool MotionWorld::knows(ObjectId object, SimTime t) const {
  const Object* o = find(object);
  return o != nullptr && o->timeline.begin() <= t;
}

SimTime MotionWorld::law_since(ObjectId object, SimTime t) const {
  return objects_[index_of(object)].timeline.segment_at(t).from;
}

SimTime MotionWorld::base_time(ObjectId object) const { return objects_[index_of(object)].base_time; }

std::uint64_t MotionWorld::revision(ObjectId object) const { return objects_[index_of(object)].revision; }

std::optional<MotionWorld::Event> MotionWorld::poll_event() {
  if (events_.empty()) return std::nullopt;
  Event event = events_.front();
  events_.pop_front();
  return event;
}

}  // namespace peerd::replication
