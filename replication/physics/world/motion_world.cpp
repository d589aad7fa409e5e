#include "replication/physics/world/motion_world.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <set>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "collision/contact/contact_time.hpp"
#include "replication/physics/laws/response.hpp"

namespace peerd::replication {
namespace {

// After so many contacts of a pair in turn all that touch are answered at once; after as many of those again the two
// stop, and after as many again no answer is sought.
constexpr std::uint32_t kAnswersMax = 32, kGivenUp = 2 * kAnswersMax;
// A bound on the work of one advance(): after so many contacts what meets anything stops.
constexpr std::size_t kContactsMax = std::size_t{1} << 17;
// A caller that asks for all objects does so in order: a piece is fetched so far ahead, and the law where it is
// needed.
constexpr std::size_t kPieceAhead = 8, kLawAhead = 4;

// Returns the part about the normal of a contact of a spin that is not about it [rad/s, of the body]; nothing where the
// spin is about it, or the body a Sphere: neither presses corners into what it touches.
std::optional<Vec3> rolling_off(const collision::Body& body, const KinematicState& state, const Vec3& normal) {
  const Vec3& all = state.angular_velocity_body;
  if (all.isZero(0.0) || (body.sphere && body.sphere->center.isZero(0.0))) return std::nullopt;
  const Vec3 n = state.orientation.conjugate() * normal;
  Vec3 spin = n.dot(all) * n;
  if ((spin - all).norm() <= kRounding * spin.norm()) return std::nullopt;
  return spin;
}

// Whether the pair of that number in the model may be far as a whole; whether its WatchedPairs are there.
bool may_be_far(std::uint32_t number, const WorldModel& model, const FarPairs& far) {
  const auto [first, end] = model.part_pairs_of_pair(number);
  return end == first + 1 && far.may_be_far(first);
}
bool has_pairs_of(std::uint32_t number, const WorldModel& model, const WatchedPairs& pairs) {
  const auto [first, end] = model.part_pairs_of_pair(number);
  return first == end || pairs.contains(first);
}

// The highest speed at t of what may be far from others.
double fastest_m_s(const FarPairs& far, const MovingObjects& objects, SimTime t) {
  double fastest = 0.0;
  far.for_each_placed([&](std::uint32_t i) {
    if (objects.peek(i) != nullptr) fastest = std::max(fastest, objects.world_at(i, t).velocity.norm());
  });
  return fastest;
}

// Whether the object, or what it carries, may meet anything. The others are most.
bool may_meet(std::size_t index, const WorldModel& model, const MovingObjects& objects) {
  return index < model.nodes.size() &&
         (!model.part_pairs_moved_by(index).empty() || !objects.carried_by(index).empty());
}

// The pair has not stopped any more.
void unstop(WatchedPair& pair, std::uint32_t number, std::set<std::uint32_t>& stopped) {
  if (std::exchange(pair.stopped, false)) stopped.erase(number);
}

// Both are moved by physics in the truth of this peer, which answers for both.
bool are_both_own(const MovingObjects& objects, std::size_t a, std::size_t b) {
  return objects[a].role == Role::kAuthoritative && objects[b].role == Role::kAuthoritative;
}

// Whether the object, which moves one side of the pair, moves that of the collider.
bool is_of_collider(const MovingObjects& objects, const WatchedPair& pair, std::size_t object) {
  return pair.is_plain ? pair.collider == object : objects.is_in_side(object, pair.collider, pair.part_a);
}

// Whether the other object of the pair is moved here at t and gives way to this one: it has met what it has met.
bool is_partner_lived(const MovingObjects& objects, const WatchedPair& pair, std::size_t object, SimTime t) {
  const bool of_collider = is_of_collider(objects, pair, object);
  const std::uint32_t other = of_collider ? pair.collidee : pair.collider;
  const bool other_responds = of_collider ? pair.collidee_responds : pair.collider_responds;
  const bool responds = of_collider ? pair.collider_responds : pair.collidee_responds;
  const bool stands =
      (objects[other].role == Role::kAuthoritative || responds) && !objects[other].will_respond(other_responds, t);
  return objects.is_lived(other) && !stands && !are_both_own(objects, object, other);
}

// Whether answering the two alone would not end the contacts around them.
bool is_squeezed(const WorldModel& model, const MovingObjects& objects, const WatchedPairs& pairs,
                 const WatchedPair& pair, SimTime t) {
  if (pair.at_once > kAnswersMax) return true;
  if (pair.in_burst <= kAnswersMax) return false;
  const std::array around = {pair.collider, pair.collidee};
  return is_driven(island_of(model, objects, pairs, around, t, Touching::kAny, Quantity::kVelocity)) ||
         is_trapped(objects, pairs, pair, t);
}

}  // namespace

MotionCounters& MotionCounters::operator+=(const MotionCounters& other) {
  contact_searches += other.contact_searches;
  searches_far += other.searches_far;
  searches_skipped += other.searches_skipped;
  searches_put_off += other.searches_put_off;
  contacts += other.contacts;
  contacts_undone += other.contacts_undone;
  came_to_rest += other.came_to_rest;
  jammed += other.jammed;
  overlapped += other.overlapped;
  unsupported += other.unsupported;
  failed += other.failed;
  capped += other.capped;
  islands += other.islands;
  largest_island = std::max(largest_island, other.largest_island);
  rest_energy_j += other.rest_energy_j;
  return *this;
}

MotionWorld::MotionWorld(const WorldModel& model, SimTime start, Watched first)
    : model_(&model),
      start_(start),
      advanced_(start),
      objects_(model, start),
      pairs_(model),
      far_(model, start, objects_),
      answers_to_(model.nodes.size()) {
  if (first == Watched::kNone) far_.set_rule([](const CollisionPair&) { return false; });
  far_.begin(start_, pairs_, opened_);
  for (const std::uint32_t i : opened_) reschedule(i);
  opened_.clear();
  watch_anew();
}

template <class ChangeObjects>
void MotionWorld::replace_model(const WorldModel& next, SimTime t, ChangeObjects change_objects) {
  assert(stopped_.empty());
  far_.open(pairs_, opened_);
  reschedule_opened();
  for (const std::uint32_t i : pairs_.numbers()) {
    WatchedPair& pair = pairs_[i];
    assert(!pair.put_off);
    if (pair.fixed && !pair.is_answered() && !pair.unsupported)  // it is not searched, but may be from now on
      pair.inside = search().fixed_parts_touch(pair, advanced_);
  }
  WatchedPairs pairs(next);
  const std::vector<std::uint32_t> added = carry_over(*model_, std::move(pairs_), next, start_, far_.rule(), pairs);
  change_objects();
  model_ = &next;
  pairs_ = std::move(pairs);
  courses_.pairs.clear();
  for (const std::uint32_t i : pairs_.numbers()) {
    if (!pairs_[i].past.empty()) courses_.pairs.insert(i);
  }
  IsWatched rule = far_.rule();
  far_ = FarPairs(next, advanced_, objects_);
  far_.set_rule(std::move(rule));
  note_answers();
  for (const std::uint32_t i : added) {
    WatchedPair& pair = pairs_[i];
    pair.clear_until = t;
    if (!pair.inside) continue;  // else the contact of the whole goes on in one of its parts
    pair.searched = true;
    pair.inside = search().touch_at(pair, t);
  }
  pair_checks_ = {};
  watched_ = 0;
  searched_again_.clear();
  known_ = {};
  for (const std::uint32_t i : pairs_.numbers()) reschedule(i);
  far_.begin(advanced_, pairs_, opened_);
  reschedule_opened();
  watch_anew();
}

void MotionWorld::change_model(const WorldModel& next) {
  replace_model(next, advanced_, [&] { objects_.change_model(next, advanced_); });
  for (const std::uint32_t i : objects_.asked_for()) {  // what bore an object may be another part now
    if (objects_[i].borne) settling_.objects.push_back({i, i});
  }
  settle(advanced_);
}

std::vector<MovingObjects::Placed> MotionWorld::change_scene(const WorldModel& next, const SceneChange& change) {
  const SimTime t = std::max(change.at, start_);
  std::vector<ObjectId> answer_otherwise;
  for (std::size_t i = 0; i < model_->nodes.size(); ++i) {
    const ObjectId id = model_->nodes[i].object;
    const ModelNode* const node = next.scene->contains(id) ? next.node(id) : nullptr;
    const bool same_body = node != nullptr && next.body(id)->surface == model_->bodies[i].surface;
    const CollisionResponse* const before = model_->response_of(id);
    const CollisionResponse* const after = node != nullptr ? next.response_of(id) : nullptr;
    const bool same_answer = before != nullptr && after != nullptr ? *before == *after : before == after;
    if (same_body && same_answer) continue;
    events_.push_back(ContactsRetracted{id, t - Duration{1}});
    retract(i, t);
    retract_answers(i, std::nullopt, t);
    forget_bursts(i, t);
    retract_contacts_of_carried(i, t);
    if (node != nullptr && !same_answer) answer_otherwise.push_back(id);
  }
  std::vector<MovingObjects::Placed> placed;
  replace_model(next, t, [&] { placed = objects_.change_scene(next, {t, change.is_moved, change.role_of}); });
  if (objects_.flexible() != nullptr) reopen_flexible(t);
  for (const auto& [object, law] : placed) set_base(object, t, law);
  for (const ObjectId id : answer_otherwise) reopen_pairs(objects_.index_of(id), t, true);
  for (const std::uint32_t i : objects_.asked_for()) {  // what bore an object may be gone
    if (objects_[i].borne) settling_.objects.push_back({i, i});
  }
  settle(std::max(t, advanced_));
  return placed;
}

void MotionWorld::declare(ObjectId object, Role role) {
  if (!objects_.contains(object)) objects_.add(object);  // the model does not need it: it meets nothing
  const std::size_t index = objects_.index_of(object);
  objects_.set_role(index, role);
  for (const std::uint32_t i : far_.near(index, pairs_)) {
    WatchedPair* const pair = pairs_.find(i);
    if (pair == nullptr) continue;
    pair->clear_until = std::max(pair->clear_until, advanced_);
    reschedule(i);
  }
}

void MotionWorld::watch_by(IsWatched is_watched) {
  far_.set_rule(std::move(is_watched));
  watch_anew();
}

void MotionWorld::watch_anew(std::optional<ObjectId> object) {
  if (object && model_->node(*object) == nullptr) return;
  const std::span<const std::uint32_t> of = object ? pairs_.of_end(objects_.index_of(*object)) : pairs_.numbers();
  const std::vector<std::uint32_t> near(of.begin(), of.end());
  for (const std::uint32_t i : near) watch_pair(i);
  // A far pair of which an end has moved may be watched by now, and then belongs to the known ones.
  const auto note_known_of = [&](std::size_t index) {
    for (const std::uint32_t k : model_->part_pairs_moved_by(index)) {
      if (!far_.may_be_far(k) || !far_.is_watched(model_->part_pairs[k].pair)) continue;
      const PartPair parts = model_->part_pairs[k];
      if (!objects_.has_never_moved(parts.a) || !objects_.has_never_moved(parts.b)) known_.note(k);
    }
  };
  if (known_.has_begun() && object) note_known_of(objects_.index_of(*object));
  if (known_.has_begun() && !object) {
    for (std::size_t i = 0; i < model_->nodes.size(); ++i) note_known_of(i);
  }
  const auto watch_listed = [&](std::uint32_t number) {  // what may not be far is there from the begin on
    if (has_pairs_of(number, *model_, pairs_) || may_be_far(number, *model_, far_) || !far_.is_watched(number)) return;
    need_pairs_of(number);
    const auto [first, end] = model_->part_pairs_of_pair(number);
    for (std::uint32_t i = first; i < end; ++i) watch_pair(i);
  };
  if (object) {
    std::ranges::for_each(model_->node_pairs.listed_of(objects_.index_of(*object)), watch_listed);
  } else {
    model_->pairs.for_each_listed([&](std::uint32_t number, const CollisionPair&) { watch_listed(number); });
  }
}

void MotionWorld::watch_pair(std::uint32_t i) {
  WatchedPair& pair = pairs_[i];
  const bool on = far_.is_watched(pair.number);
  if (std::exchange(pair.watched, on) == on) return;
  unstop(pair, i, stopped_);
  pair.contact.reset();
  if (pair.bears) lift(pair, advanced_);
  pair.clear_until = std::max(pair.clear_until, advanced_);
  reschedule(i);
}

void MotionWorld::need_pairs_of(std::uint32_t number) {
  if (has_pairs_of(number, *model_, pairs_)) return;
  add_pairs(pairs_, *model_, number, start_, false);
  const auto [first, end] = model_->part_pairs_of_pair(number);
  for (std::uint32_t i = first; i < end; ++i) known_.note(i);
}

std::span<const std::uint32_t> MotionWorld::known_pairs() {
  if (known_.has_begun()) return known_.pairs();
  known_.begin(*model_);
  for (const std::uint32_t i : pairs_.numbers()) known_.note(i);
  const bool are_all = far_.rule() == nullptr;
  for (std::uint32_t i = 0; i < model_->nodes.size(); ++i) {
    if (are_all || !objects_.has_never_moved(i)) known_.note_far_of(i, *model_, far_);
  }
  return known_.sorted();
}

void MotionWorld::put_off(std::uint32_t i, bool on, bool from_now) {
  assert(i < pairs_.size());
  WatchedPair& pair = far_.known(i, start_, pairs_);
  known_.note(i);
  pair.put_off = on;
  if (on || !pair.stopped) return;
  SimTime from = advanced_;
  for (const auto& [index, registered] :
       {std::pair{pair.collider, pair.collider_responds}, std::pair{pair.collidee, pair.collidee_responds}}) {
    const MovingObject& o = objects_[index];
    if (!from_now && registered && o.is_answering()) from = std::min(from, base_time(o.id));
  }
  const SimTime known = std::max(objects_.known_since(pair.collider), objects_.known_since(pair.collidee));
  pair.clear_until = std::max({pair.clear_until, from, known, advanced_ - kHistory});
  unstop(pairs_[i], i, stopped_);
  reschedule(i);
}

// Called after any change of whether the pair is watched, or of what is known of it.
void MotionWorld::reschedule(std::size_t i) {
  WatchedPair& pair = pairs_[i];
  const bool is_known = !pair.is_flexible || objects_.flexible() != nullptr;
  const bool scheduled = pair.watched && !pair.is_far && !pair.stopped && !pair.unsupported && !pair.fixed && is_known;
  if (std::exchange(pair.is_scheduled, scheduled) != scheduled) scheduled ? ++watched_ : --watched_;
  assert(watched_ <= pairs_.size());
  if (pair_checks_.size() < pairs_.slots()) pair_checks_.grow(pairs_.slots());
  pair_checks_.set(pairs_.slot_of(i), scheduled ? pair.contact.value_or(pair.clear_until) : SimTime::max());
}

void MotionWorld::set_flexible(FlexibleParts& flexible) {
  objects_.set_flexible(flexible);
  for (const std::uint32_t i : pairs_.numbers()) reschedule(i);
}

void MotionWorld::reopen_flexible(SimTime t) {
  assert(objects_.flexible() != nullptr);
  for (const std::uint32_t i : pairs_.numbers()) {
    WatchedPair& pair = pairs_[i];
    if (!pair.is_flexible) continue;
    pair.contact.reset();
    pair.clear_until = std::min(pair.clear_until, std::max(t, start_));
    reschedule(i);
  }
}

void MotionWorld::set_base(ObjectId object, SimTime t, const std::optional<MotionModel>& model,
                           const std::optional<Rest>& rest, const std::optional<Vec3>& free) {
  assert((model || free) && (!free || free->allFinite()));
  const std::size_t index = objects_.index_of(object);
  MovingObject& o = objects_[index];
  if (!model && !may_meet(index, *model_, objects_)) return;
  const Base base{t, model, rest, free};
  if (replays_bases_ && may_meet(index, *model_, objects_)) {
    forget_kept(o.bases, t, advanced_);
    o.bases.push_back(base);
  } else if (model) {
    o.base_time = o.given_time = t;
  }
  lay_base(index, base);
}

void MotionWorld::restate(ObjectId object, SimTime t, const MotionModel& model) {
  assert(!replays_bases_);
  const std::size_t index = objects_.index_of(object);
  objects_[index].base_time = t;
  lay_base(index, {t, model, {}, {}});
}

namespace {

// How a motion goes on from one law to the next: accelerations between those of the two explain how they differ, or a
// kick in between does, or nothing.
enum class GoesOn : std::uint8_t { kSmoothly, kKicked, kElsewhere };

GoesOn goes_on(const KinematicState& before, const KinematicState& now, Duration since) {
  if (before.orientation.coeffs() != now.orientation.coeffs()) return GoesOn::kElsewhere;
  const double s = to_seconds(since), most = before.acceleration.norm() + now.acceleration.norm();
  const double rounding = kSolverRounding * (now.position.norm() + s * now.velocity.norm());
  const double way = (now.position - before.position).norm(), faster = (now.velocity - before.velocity).norm();
  const double smooth = 0.5 * s * s * most + rounding;
  if (way <= smooth && faster <= s * most + rounding) return GoesOn::kSmoothly;
  return way <= smooth + s * faster ? GoesOn::kKicked : GoesOn::kElsewhere;
}

}  // namespace

void MotionWorld::lay_base(std::size_t index, const Base& given) {
  MovingObject& o = objects_[index];
  const SimTime t = given.at;
  ++o.revision;
  if (!may_meet(index, *model_, objects_)) {
    const MotionModel& model = *given.model;
    if (o.role == Role::kDriven && objects_.driven_history()) {
      o.timeline.restart(t, model);
      objects_.note_change(index);
    } else {
      o.timeline.replace_from(t, model, std::nullopt);
      objects_.timeline_changed(index);
    }
    return;
  }
  retract_all(index, t);
  // A base that is laid again starts from the law before it, as it did the first time, or it would take nothing along.
  if (replays_bases_ && !o.is_answering()) o.timeline.truncate_from(t);
  const MotionModel model = given.model ? *given.model : o.timeline.model_at(t);
  const KinematicState before = o.timeline.at(t);
  const MotionModel world_before = objects_.world_law(index, t);
  const Duration since = t - o.timeline.segment_at(t).from;
  // Nothing bore it at t when its owner said so, and what it has begun to rest against at t comes after that.
  const SimTime after = given.rest || given.free ? t + Duration{1} : t;
  // A peer that found a contact in another nanosecond has its objects a little elsewhere: what rests goes on.
  const bool stays =
      is_at_same_place(before, model.state) && std::ranges::none_of(pairs_.of_end(index), [&](std::uint32_t i) {
        return pairs_[i].bears && pairs_[i].touched >= after;
      });
  MotionModel base = model;
  if (!stays) o.borne = false;
  o.borne_unseen = false;
  const bool weightless_slide = base.kind == MotionKind::kSliding && o.free.isZero(0.0);
  if (o.free_is_given && !o.borne && !weightless_slide && !given.rest && !given.free) {
    base.kind = MotionKind::kSecond;
    base.state.acceleration = objects_.in_frame_of_carrier(index, t, o.free);
  }
  o.timeline.replace_from(t, base, std::nullopt);
  objects_.timeline_changed(index);
  const bool carries = carry_along(index, t, world_before.state, since);
  reopen_pairs(index, t, !stays && !carries);
  if (carries) {
    settle(t, true);
    return;
  }
  if (given.rest || (given.free && (given.model || presses_another(o.id, t)))) {
    begin_rest(index, given);
  } else if (stays && presses_another(o.id, t)) {
    settling_.objects.push_back({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index)});
  }
  if (!settling_.objects.empty()) settle(t, true);  // this object, and those that carry_along() has pushed
}

bool MotionWorld::presses_another(ObjectId object, SimTime t) const {
  return std::ranges::any_of(far_.near(objects_.index_of(object), pairs_),
                             [&](std::uint32_t i) { return pairs_.contains(i) && pairs_[i].bears_at(t); });
}

// Takes along all that rests on a driven object, from one of its laws to the next, and pushes out what it has run into.
// After a kick it leaves what it has gone away from.
bool MotionWorld::carry_along(std::size_t index, SimTime t, const KinematicState& before, Duration since) {
  const KinematicState now = objects_.world_law(index, t).state;
  const GoesOn how = goes_on(before, now, since);
  if (how == GoesOn::kElsewhere) return false;
  const auto driver = static_cast<std::uint32_t>(index);
  DrivenJump jump(*model_, objects_, pairs_, far_, {driver, t, start_, how == GoesOn::kSmoothly, replays_bases_});
  std::vector<std::uint32_t> moved;
  for (const std::uint32_t i : far_.near(index, pairs_)) {
    if (!pairs_.contains(i) || !pairs_[i].bears_at(t)) continue;
    const WatchedPair& pair = pairs_[i];
    const bool is_collider = pair.collider == index;
    if (gives_way(index, is_collider ? pair.collider_responds : pair.collidee_responds, t)) return false;
    const std::uint32_t other = is_collider ? pair.collidee : pair.collider;
    if (jump.is_given(other)) continue;
    if (gives_way(other, is_collider ? pair.collidee_responds : pair.collider_responds, t)) moved.push_back(other);
  }
  const bool bears = !moved.empty();
  const Vec3 way = now.position - before.position;
  if (!objects_[index].is_answering() && !way.isZero(0.0)) jump.find_run_into(driver, before.pose(), way);
  if (!bears && jump.met().empty()) return false;
  const ContactIsland places = jump.places(moved, way);
  const ContactIsland speeds = jump.speeds(moved, now.velocity - before.velocity);
  if (!places.is_solved || !speeds.is_solved) return false;
  // The speeds have grown by the accelerations since then, and have their rounding.
  settling_.fastest = std::max(settling_.fastest, now.velocity.norm() + to_seconds(since) * now.acceleration.norm());
  for (std::size_t i = 0; i < speeds.objects.size(); ++i) {
    if (places.objects[i] == kNone || jump.is_given(places.objects[i])) continue;
    assert(places.objects[i] == speeds.objects[i]);
    if (!bears && places.bodies[i].value.isZero(0.0)) continue;  // the driver stops before it reaches this one
    MotionModel law = objects_.world_law(places.objects[i], t);
    law.state.position += places.bodies[i].value;
    law.state.velocity += speeds.bodies[i].value;
    const std::uint32_t from = places.reached_from[i];
    change_motion(places.objects[i], t, law, objects_[from != kNone ? from : index].id);
  }
  return bears;
}

void MotionWorld::retract_all(std::size_t index, SimTime t) {
  events_.push_back(ContactsRetracted{objects_[index].id, t - Duration{1}});
  retract(index, t);
  forget_bursts(index, t);
  retract_contacts_of_carried(index, t);
}

void MotionWorld::forget_bases(ObjectId object, SimTime t) {
  assert(replays_bases_);
  const std::size_t index = objects_.index_of(object);
  MovingObject& o = objects_[index];
  if (!may_meet(index, *model_, objects_) || o.timeline.begin() >= t)
    return;  // its bases are not kept, or there is none before
  std::erase_if(o.bases, [&](const Base& base) { return base.at >= t; });
  if (o.timeline.last_segment().from < t) return;
  ++o.revision;
  retract_all(index, t);
  o.timeline.truncate_from(t);
  objects_.timeline_changed(index);
  reopen_pairs(index, t, true);
}

// A base of a decision lets the object rest against its partner, whose own base may be laid later, or have been
// replaced since; a partner that answers no contact gets none. A base of an update lets it rest against all that it
// touches and would run into with its free acceleration. The owner has published the acceleration that its supports
// leave of the free one, by the laws of those supports that it knew. This peer solves it again by the laws that it
// knows itself. It keeps the published one where a support has had no base yet, for then the free acceleration of the
// support is not known.
void MotionWorld::begin_rest(std::size_t index, const Base& base) {
  MovingObject& o = objects_[index];
  const SimTime t = base.at;
  std::vector<std::pair<std::uint32_t, Vec3>> begins;  // pairs, and the normals along which they bear
  bool goes_on = false, all_known = true;
  if (base.rest) {
    const Rest& rest = *base.rest;
    if (!objects_.contains(rest.partner)) return;
    const std::size_t partner = objects_.index_of(rest.partner);
    const Timeline::Segment& law = objects_[partner].timeline.segment_at(t);
    const bool has_base = law.from == t && !law.cause;
    if (!has_base && objects_[partner].is_answering()) return;
    for (const std::uint32_t i : pairs_.of_end(index)) {
      const WatchedPair* const pair = &pairs_[i];
      if (!pair->watched || !pair->is_answered()) continue;
      const bool is_collider = pair->collider == index;
      if ((is_collider ? pair->collidee : pair->collider) != partner || !search().touch_at(*pair, t)) continue;
      begins.emplace_back(i, is_collider ? rest.normal : Vec3(-rest.normal));
    }
    if (begins.empty()) return;
  } else {
    if (!o.is_answering()) return;
    const MotionModel as_published = o.timeline.model_at(t);
    MotionModel unborne = as_published;
    unborne.kind = MotionKind::kSecond;
    unborne.state.acceleration = objects_.in_frame_of_carrier(index, t, *base.free);
    o.timeline.replace_from(t, unborne, std::nullopt);
    for (const std::uint32_t i : pairs_.of_end(index)) {
      const WatchedPair* const pair = &pairs_[i];
      if (!pair->watched || !pair->is_answered()) continue;
      if (pair->bears_at(t) && !pair->lifts) {
        goes_on = true;
      } else if (const auto normal = search().normal_of_meeting(*pair, t, kShortestFlight)) {
        begins.emplace_back(i, *normal);
        const MovingObject& partner = objects_[pair->collider == index ? pair->collidee : pair->collider];
        const bool has_base = partner.base_time != start_ || !partner.bases.empty();
        all_known = all_known && (partner.role != Role::kPredicted || has_base);
      }
    }
    o.timeline.replace_from(t, as_published, std::nullopt);
  }
  for (const auto& [i, normal] : begins) {
    WatchedPair& pair = pairs_[i];
    remember_course(i, t);
    pair.normal = normal;
    search().note_touch(pair, t);
    pair.contact.reset();
    pair.lifts = pair.inside = false;
    set_bearing(pair, t, true);
    reschedule(i);
  }
  const auto drive = [](MovingObject& each, const Vec3& free) {
    if (!each.is_answering()) return;
    each.free = each.free_is_given ? each.free : free;
    each.borne = true;
  };
  drive(o, base.rest ? base.rest->free : *base.free);
  o.borne_unseen = o.borne && !goes_on && begins.empty();
  if (base.rest) drive(objects_[objects_.index_of(base.rest->partner)], base.rest->partner_free);
  if (all_known && (goes_on || !begins.empty())) {
    settling_.objects.push_back({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index)});
    settle(t, true);
  } else {
    settling_ = {};
  }
}

void MotionWorld::retract_bases(const MovingObject& o, SimTime t) {
  for (auto base = o.bases.rbegin(); base != o.bases.rend() && base->at >= t; ++base) {
    retracted_bases_.emplace(base->at, o.id);
  }
}

// The laws that the object had before are void from there on, those of its later bases included. A base may have been
// replaced since it was retracted, and an edit may have removed its object.
void MotionWorld::lay_next_base() {
  assert(!retracted_bases_.empty());
  const auto [t, id] = *retracted_bases_.begin();
  retracted_bases_.erase(retracted_bases_.begin());
  if (!objects_.contains(id)) return;
  const std::size_t index = objects_.index_of(id);
  const std::vector<Base>& bases = objects_[index].bases;
  const auto base = std::ranges::lower_bound(bases, t, {}, &Base::at);
  if (base == bases.end() || base->at != t) return;
  lay_base(index, Base(*base));
  retract_bases(objects_[index], t + Duration{1});
  retracted_bases_.erase({t, id});  // answers of the object itself may just have been retracted
}

void MotionWorld::set_free_acceleration(ObjectId object, const Vec3& acceleration) {
  assert(acceleration.allFinite());
  MovingObject& o = objects_[objects_.index_of(object)];
  const CollisionResponse* const response = model_->response_of(object);
  if (response != nullptr && response->type == ResponseType::kZero) return;  // what has stopped it holds it
  o.free = acceleration;
  o.free_is_given = true;
}

std::optional<Vec3> MotionWorld::free_acceleration(ObjectId object) const {
  const MovingObject& o = objects_[objects_.index_of(object)];
  return o.free_is_given ? std::optional(o.free) : std::nullopt;
}

// Contacts that what the object carries has had outside of it may not be; those within it hold.
void MotionWorld::retract_contacts_of_carried(std::size_t object, SimTime t) {
  if (objects_.carried_by(object).empty()) return;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> met;  // what is carried, and what it may have met
  for (const std::uint32_t i : model_->part_pairs_moved_by(object)) {
    if (!pairs_.contains(i)) continue;
    const std::uint32_t collider = pairs_[i].collider, collidee = pairs_[i].collidee;
    if (collider == object || collidee == object) continue;  // retracted with all of its own
    const bool has_collider = objects_.is_in_side(object, collider, pairs_[i].part_a);
    met.emplace_back(has_collider ? collider : collidee, has_collider ? collidee : collider);
  }
  std::ranges::sort(met);
  met.erase(std::ranges::unique(met).begin(), met.end());
  for (std::size_t k = 0; k < met.size(); ++k) {
    const auto [carried, other] = met[k];
    events_.push_back(ContactsRetracted{objects_[carried].id, t - Duration{1}, objects_[other].id});
    retract_answers(carried, objects_[other].id, t);
    if (k > 0 && met[k - 1].first == carried) continue;
    retract(carried, t);
    forget_bursts(carried, t);
  }
}

// Retracts what followed from a contact with `cause` at t or later. An authoritative object keeps its answers to what
// others own.
void MotionWorld::retract(std::size_t cause, SimTime t) {
  if (cause >= answers_to_.size()) return;  // it meets nothing
  for (const Answer& answer : answers_to_[cause]) {
    if (answer.last >= t) retract_answers(answer.object, objects_[cause].id, t);
  }
}

void MotionWorld::note_answer(std::size_t object, std::size_t cause, SimTime t) {
  const auto index = static_cast<std::uint32_t>(object);
  if (cause >= answers_to_.size() || index >= model_->nodes.size()) return;
  if (!model_->are_paired(model_->nodes[cause].object, model_->nodes[index].object)) return;
  std::vector<Answer>& answers = answers_to_[cause];
  const auto at = std::ranges::lower_bound(answers, index, {}, &Answer::object);
  if (at != answers.end() && at->object == index) {
    at->last = std::max(at->last, t);
    return;
  }
  answers.insert(at, {index, t});
  // What is as old is in no timeline any more but as its first law, which nothing retracts.
  std::erase_if(answers, [&](const Answer& answer) { return answer.last < advanced_ - 2 * kHistory; });
}

void MotionWorld::note_answers() {
  answers_to_.assign(model_->nodes.size(), {});
  for (const std::uint32_t i : objects_.asked_for()) {
    if (i >= model_->nodes.size()) break;
    const Timeline& timeline = objects_[i].timeline;
    for (std::size_t k = 0; k < timeline.segment_count(); ++k) {
      const Timeline::Segment& law = timeline.segment(k);
      if (!law.cause || !objects_.contains(*law.cause)) continue;  // it may be gone
      note_answer(i, objects_.index_of(*law.cause), law.from);
    }
  }
}

void MotionWorld::reschedule_opened(const std::optional<NewLaw>& law) {
  for (const std::uint32_t i : opened_) {
    if (!pairs_.contains(i)) continue;  // it is far again, and nobody watches it
    known_.note(i);
    const SimTime reopened =
        law ? reopened_from(i, is_partner_lived(objects_, pairs_[i], law->object, law->from), law->from)
            : SimTime::max();
    search().note_was_far(pairs_[i], law, reopened);
    reschedule(i);
  }
  opened_.clear();
}

void MotionWorld::retract_answers(std::size_t index, std::optional<ObjectId> cause, SimTime t) {
  assert(objects_[index].id != cause);
  MovingObject& o = objects_[index];
  const bool is_own = cause && are_both_own(objects_, index, objects_.index_of(*cause));
  if (o.role != Role::kPredicted && !is_own) return;
  std::size_t wrong = o.timeline.first_not_before(t);
  const auto is_answer = [&](const Timeline::Segment& law) {
    return cause ? law.cause == cause : law.cause.has_value();
  };
  while (wrong < o.timeline.segment_count() && !is_answer(o.timeline.segment(wrong))) ++wrong;
  if (wrong == 0 || wrong == o.timeline.segment_count()) return;
  const SimTime from = o.timeline.segment(wrong).from;
  if ((is_own ? o.given_time : o.base_time) >= from) return;  // its owner has published since
  o.timeline.truncate_from(from);
  o.base_time = std::min(o.base_time, std::max(o.given_time, from));  // its updates since then were of that answer
  retract_bases(o, from);
  objects_.timeline_changed(index);
  ++o.revision;
  events_.push_back(ContactsRetracted{o.id, from - Duration{1}});
  ++counters_.contacts_undone;
  forget_bursts(index, from);
  reopen_pairs(index, from, true);
  retract(index, from);
}

void MotionWorld::forget_bursts(std::size_t object, SimTime t) {
  for (const std::uint32_t i : pairs_.of_end(object)) {
    WatchedPair& pair = pairs_[i];
    if (replays_bases_) {
      pair.rewind_course(t);
    } else if (pair.touched >= t) {
      pair.at_once = pair.in_burst = pair.squeezed = 0;
    }
  }
}

void MotionWorld::remember_course(std::uint32_t i, SimTime t) {
  assert(pairs_.contains(i));
  if (!replays_bases_) return;
  pairs_[i].remember_course(t);
  courses_.pairs.insert(i);
}

SimTime MotionWorld::reopened_from(std::uint32_t i, bool lived, SimTime t) const {
  const WatchedPair& pair = pairs_[i];
  const SimTime known = std::max(objects_.known_since(pair.collider), objects_.known_since(pair.collidee));
  const auto again = searched_again_.find(i);
  const SimTime lived_until = again == searched_again_.end() ? advanced_ : again->second;
  return std::max({t, known, lived ? lived_until : advanced_ - kHistory});
}

// The pairs of the object know nothing of contacts since then any more. Pairs of which the other object would answer
// here, or is driven here and gets no answer, are not searched again in the past because this one moved otherwise; its
// own change (a decision) makes them searched there. A pair of two own objects is. So is one that is being searched in
// the past anyway: a contact that it has found there may not be.
void MotionWorld::reopen_pairs(std::size_t object, SimTime t, bool elsewhere) {
  far_.moved(object, t, advanced_, objects_, pairs_, opened_);
  known_.note_far_of(object, *model_, far_);
  reschedule_opened(NewLaw{object, t});
  for (const std::uint32_t i : far_.near(object, pairs_)) {
    if (!pairs_.contains(i) || pairs_[i].is_far) continue;
    WatchedPair& pair = pairs_[i];
    const std::uint32_t other = is_of_collider(objects_, pair, object) ? pair.collidee : pair.collider;
    if (are_both_own(objects_, object, other)) {  // its updates after t were made without this law
      MovingObject& o = objects_[other];
      o.base_time = std::min(o.base_time, std::max(o.given_time, t));
    }
    const SimTime from = reopened_from(i, is_partner_lived(objects_, pair, object, t), t);
    if (from < advanced_) {
      SimTime& again = searched_again_.try_emplace(i, from).first->second;
      again = std::min(again, from);
    }
    if (pair.contact && *pair.contact >= from) {
      pair.contact.reset();
      pair.lifts = false;
    }
    // The later bases of a driven partner are laid again: they take this object along, or push it, from its new place.
    if (replays_bases_ && pair.is_answered() && !objects_[other].is_answering()) {
      retract_bases(objects_[other], t + Duration{1});
    }
    if (pair.solved >= t) pair.solved = SimTime::min();
    pair.forget_free_since(from);
    if (from < pair.clear_until) unstop(pairs_[i], i, stopped_);
    pair.clear_until = std::min(pair.clear_until, from);
    const bool given_up = pair.squeezed >= kGivenUp && met_lately(pair.touched, from, kShortestFlight);
    if (!given_up && (gives_way(pair.collider, pair.collider_responds, from) ||
                      gives_way(pair.collidee, pair.collidee_responds, from))) {
      pair.inside = false;
    }
    if (!pair.is_answered() && pair.touched >= from) pair.inside = false;         // that contact may not be
    if (!pair.is_answered() && pair.parted >= from && pair.parted_from < from) {  // that one may go on
      pair.inside = true;
      pair.touched = pair.parted_from;
    }
    if (pair.bears && (elsewhere || pair.bore_since > from)) {
      pair.contact = pair.clear_until;
      pair.lifts = true;
    }
    reschedule(i);
  }
}

bool MotionWorld::ends_touch(ObjectId a, ObjectId b, SimTime t) {
  return std::ranges::any_of(model_->pairs_between(a, b), [&](std::uint32_t number) {
    if (!may_be_far(number, *model_, far_)) need_pairs_of(number);
    const auto [first, end] = model_->part_pairs_of_pair(number);
    for (std::uint32_t i = first; i < end; ++i) {
      WatchedPair* const known = pairs_.find(i);
      if (known == nullptr || known->is_far || known->unsupported) continue;
      WatchedPair& pair = *known;
      // A contact that nobody answers is followed while it lasts.
      const bool followed = !pair.is_answered() && pair.is_scheduled && pair.searched;
      if (pair.fixed ? search().fixed_parts_touch(pair, t) : followed ? pair.inside : search().touch_at(pair, t)) {
        return true;
      }
    }
    return false;
  });
}

// ---- answers to a contact ----

namespace {

// Keeps the pairs whose outcome this peer decides. Returns false where another peer decides one of the pairs left out.
bool leave_to_others(std::vector<StruckPair>& struck, const MovingObjects& objects, const WatchedPairs& pairs,
                     const MotionWorld::AuthorityOf& authority_of, SimTime t) {
  bool all_are_told = true;
  std::erase_if(struck, [&](const StruckPair& each) {
    const WatchedPair& pair = pairs[each.pair];
    const ContactAuthority whose = authority_of(objects[pair.collider].id, objects[pair.collidee].id, t);
    if (whose == ContactAuthority::kDeferred) all_are_told = false;
    return whose != ContactAuthority::kLocal;
  });
  return all_are_told;
}

}  // namespace

void MotionWorld::respond_to_contact(WatchedPair& pair) {
  assert(pair.contact);
  const SimTime t = *pair.contact;
  if (pair.lifts) {
    lift(pair, t);
    return;
  }
  search().note_touch(pair, t);
  const ObjectId collider = objects_[pair.collider].id, collidee = objects_[pair.collidee].id;
  const ContactAuthority authority =
      authority_.of ? authority_.of(collider, collidee, t) : ContactAuthority::kAsPublished;
  ContactAnswer answer = answer_to(*model_, objects_, pair, authority);
  // No peer decides a resting contact: all solve it alike, by the laws that are published.
  const bool lasts = authority == ContactAuthority::kDeferred && lasts_at(*model_, objects_, pair);
  if (lasts) answer = answer_to(*model_, objects_, pair, ContactAuthority::kAsPublished);
  const Vec3 approach = answer.before_a.state.velocity - answer.before_b.state.velocity;
  const bool resumes = authority == ContactAuthority::kAsPublished && met_lately(pair.bore_until, t, kSameContact) &&
                       -pair.normal.dot(approach) <= kRestSpeed_m_s;
  pair.both_changed = !moves_alike(answer.before_a.state, answer.after_a.state) &&
                      !moves_alike(answer.before_b.state, answer.after_b.state);
  const std::size_t a = pair.collider, b = pair.collidee;
  if (pair.squeezed >= kGivenUp && stands_firm(objects_, pair, t)) {
    hold_against_wall(pair, t);
    return;
  }
  if (answer.authority == ContactAuthority::kDeferred || (!answer.a_responds && !answer.b_responds) ||
      pair.squeezed >= kGivenUp) {
    const bool goes_on = !pair.is_answered() && search().ends_touch_elsewhere(pair, t);
    pair.inside = true;
    if (!goes_on && !lasts) report(pair, t, answer);
    pair.contact.reset();
    return;
  }
  std::vector<StruckPair> struck;
  bool is_shared = false;  // the blow is solved at once for all that it reaches, and all of it is told
  const auto share = [&] {
    if (authority == ContactAuthority::kLocal) struck = struck_with(*model_, objects_, pairs_, pair, t);
    is_shared = leave_to_others(struck, objects_, pairs_, authority_.of, t);
  };
  if (is_squeezed(*model_, objects_, pairs_, pair, t)) {
    answer_squeezed(pair, t);
  } else if (comes_to_rest_at(*model_, objects_, pair, answer)) {
    counters_.rest_energy_j += own_energy_of_parting_j(*model_, objects_, pair, answer);
    if (!pair.overlapped && bears_another(objects_, pairs_, pair, t)) share();
    come_to_rest(pair, t);
  } else if (!pair.overlapped && exchanges_momentum(*model_, objects_, pair, answer) &&
             bears_another(objects_, pairs_, pair, t)) {
    share();
    answer_in_heap(pair, t, answer);
  } else {
    if (!pair.overlapped && !answer.changes_motion()) answer = answer_to_closing(*model_, objects_, pair, answer);
    if (answer.a_responds) change_motion(a, t, answer.after_a, objects_[b].id);
    if (answer.b_responds) change_motion(b, t, answer.after_b, objects_[a].id);
  }
  // A shared blow may give the two more energy than they had, from the others that it reached: that is no gain.
  const bool is_decided = answer.authority != ContactAuthority::kAsPublished;
  if (!is_shared && (is_decided || !pair.bears_at(t))) remove_gain(pair, t, answer);
  settle(t);
  pair.contact.reset();
  answer.after_a = objects_.world_law(a, t);
  answer.after_b = objects_.world_law(b, t);
  const bool changed = answer.changes_motion();
  if (!changed && pair.bears) {  // they rest as before
    pair.clear_until = t + kOverlapRetry;
    return;
  }
  // A contact in which no response changes anything (an object that was stopped is run into) goes on.
  pair.inside = !changed;
  if (!lasts && !resumes) report(pair, t, answer);
  // The blow has been solved for all whom it reached, so all of it is reported: a peer that hears of the first pair
  // alone would pass the blow on from pair to pair, with another result.
  for (StruckPair& each : struck) {
    const WatchedPair& other = pairs_[each.pair];
    each.answer.after_a = objects_.world_law(other.collider, t);
    each.answer.after_b = objects_.world_law(other.collidee, t);
    if (each.answer.changes_motion()) report(other, t, each.answer);
  }
}

// Others that touch the two may have made them faster. Where both answer contacts neither is a racket, so they go as
// they would, only slower.
void MotionWorld::remove_gain(const WatchedPair& pair, SimTime t, const ContactAnswer& answer) {
  const std::size_t a = pair.collider, b = pair.collidee;
  if (!objects_[a].is_answering() || !objects_[b].is_answering()) return;
  const bool in_update = (!answer.a_responds && is_in_later_update(objects_[a], pair)) ||
                         (!answer.b_responds && is_in_later_update(objects_[b], pair));
  if (in_update) return;
  const auto energy = [&](std::size_t object, bool responds, const KinematicState& s) {
    return responds ? model_->response_of(objects_[object].id)->mass_kg * s.velocity.squaredNorm() : 0.0;
  };
  const Vec3 velocity_a = objects_.world_law(a, t).state.velocity, velocity_b = objects_.world_law(b, t).state.velocity;
  const double before = energy(a, answer.a_responds, answer.before_a.state) +
                        energy(b, answer.b_responds, answer.before_b.state),
               after = energy(a, answer.a_responds, objects_.world_law(a, t).state) +
                       energy(b, answer.b_responds, objects_.world_law(b, t).state);
  if (after <= before * (1.0 + kRounding)) return;
  const double slower = std::sqrt(before / after);
  if (answer.a_responds) change_velocity(a, t, slower * velocity_a, b);
  if (answer.b_responds) change_velocity(b, t, slower * velocity_b, a);
}

void MotionWorld::report(const WatchedPair& pair, SimTime t, const ContactAnswer& answer) {
  // An object that slides by the world's friction is published with exactly the deceleration by which receivers
  // recognise it (law_of_outcome), also where it does not respond: that of its own law has been turned and rounded
  // since its base.
  const auto state_as_published = [&](ObjectId id, const MotionModel& after) {
    const bool slides = after.kind == MotionKind::kSliding;
    return slides ? law_after(model_->response_of(id), after, after.state).state : after.state;
  };
  const ObjectId a = objects_[pair.collider].id, b = objects_[pair.collidee].id;
  ++counters_.contacts;
  ContactEvent event{t,
                     a,
                     b,
                     pair.normal,
                     answer.before_a.state,
                     answer.before_b.state,
                     state_as_published(a, answer.after_a),
                     state_as_published(b, answer.after_b),
                     pair.type};
  event.deferred = answer.authority == ContactAuthority::kDeferred;
  event.rests = pair.bears_at(t) || (event.deferred && comes_to_rest_at(*model_, objects_, pair, answer));
  if (event.rests) {
    event.collider_free = objects_.free_acceleration_of(pair.collider, t);
    event.collidee_free = objects_.free_acceleration_of(pair.collidee, t);
  }
  events_.push_back(std::move(event));
}

void MotionWorld::change_motion(std::size_t index, SimTime t, const MotionModel& after_in_world, ObjectId cause,
                                bool in_base) {
  MovingObject& o = objects_[index];
  const Timeline::Segment& law = o.timeline.segment_at(t);
  const bool is_base = in_base && law.from == t && !law.cause;
  MotionModel after = after_in_world;
  if (o.carrier != kNone) after = MotionModel(relative_to(objects_.carrier_at(index, t), after_in_world.state));
  if (o.timeline.last_segment().from > t) events_.push_back(ContactsRetracted{o.id, t});
  // Other contacts of the same instant were answered before, and stand.
  retract(index, t + Duration{1});
  if (replays_bases_) forget_bursts(index, t + Duration{1});
  o.timeline.replace_from(t, after, is_base ? std::nullopt : std::optional(cause));
  retract_bases(o, t + Duration{1});
  if (!is_base) note_answer(index, objects_.index_of(cause), t);
  // A later update is gone from here: it was of another way than the one that is decided here.
  o.base_time = std::min(o.base_time, t);
  o.given_time = std::min(o.given_time, t);
  objects_.timeline_changed(index);
  reopen_pairs(index, t, false);
  settling_.objects.push_back(
      {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(objects_.index_of(cause))});
}

// ---- what bears what ----

void MotionWorld::come_to_rest(WatchedPair& pair, SimTime t) {
  ++counters_.came_to_rest;
  // A turning body that is pressed hard would be lifted by its edges and meet again without end.
  if (met_lately(pair.lifted, t, kShortestFlight)) pair.held_until = t + kShortestFlight;
  set_bearing(pair, t, true);
  const std::size_t a = pair.collider, b = pair.collidee;
  if (objects_[a].will_respond(pair.collider_responds, t)) end_rolling(a, t, pair.normal, b);
  if (objects_[b].will_respond(pair.collidee_responds, t)) end_rolling(b, t, pair.normal, a);
  // The two are pressed together and stay, although their centres part. The speed of a turning body's centre is not
  // that of the contact.
  const MotionModel law_a = objects_.world_law(a, t), law_b = objects_.world_law(b, t);
  const double speed = pair.normal.dot(law_a.state.velocity - law_b.state.velocity);
  const bool rolls = rolling_off(objects_.body(a), law_a.state, pair.normal) ||
                     rolling_off(objects_.body(b), law_b.state, pair.normal);
  const bool driven = (!gives_way(a, pair.collider_responds, t) && !is_motionless(law_a.state)) ||
                      (!gives_way(b, pair.collidee_responds, t) && !is_motionless(law_b.state));
  if (speed > 0.0 && !rolls && !driven) {  // to keep up with what moves away would take energy
    const auto gives = [&](std::size_t object, bool registered) {
      const CollisionResponse* const response = model_->response_of(objects_[object].id);
      return objects_[object].will_respond(registered, t) ? 1.0 / response->mass_kg : 0.0;
    };
    const double of_a = gives(a, pair.collider_responds), of_b = gives(b, pair.collidee_responds);
    if (of_a > 0.0) change_velocity(a, t, law_a.state.velocity - (speed * of_a / (of_a + of_b)) * pair.normal, b);
    if (of_b > 0.0) change_velocity(b, t, law_b.state.velocity + (speed * of_b / (of_a + of_b)) * pair.normal, a);
  }
  settle_velocities(pair, t, Touching::kBearing);
}

void MotionWorld::answer_in_heap(WatchedPair& pair, SimTime t, const ContactAnswer& answer) {
  const double came = -pair.normal.dot(answer.before_a.state.velocity - answer.before_b.state.velocity);
  const double parts = pair.normal.dot(answer.after_a.state.velocity - answer.after_b.state.velocity);
  const std::array around{pair.collider, pair.collidee};
  const bool is_slow = came <= kRestSpeed_m_s;
  if (is_slow || (came <= kCrowdRestSpeed_m_s &&
                  is_crowd(island_of(*model_, objects_, pairs_, around, t, Touching::kBearing, Quantity::kVelocity)))) {
    counters_.rest_energy_j += own_energy_of_parting_j(*model_, objects_, pair, answer);
    return come_to_rest(pair, t);
  }
  set_bearing(pair, t, true);
  settle_velocities(pair, t, Touching::kBearing, std::clamp(parts / came, 0.0, 1.0));
}

void MotionWorld::end_rolling(std::size_t index, SimTime t, const Vec3& normal, std::size_t cause) {
  MotionModel law = objects_.world_law(index, t);
  const std::optional<Vec3> spin = rolling_off(objects_.body(index), law.state, normal);
  if (!spin) return;
  law.state.angular_velocity_body = *spin;
  law.angular_acceleration_body.setZero();
  change_motion(index, t, law, objects_[cause].id);
}

void MotionWorld::change_velocity(std::size_t index, SimTime t, const Vec3& velocity, std::size_t cause) {
  const MotionModel law = objects_.world_law(index, t);
  if (law.state.velocity == velocity) return;
  KinematicState after = law.state;
  after.velocity = velocity;
  const CollisionResponse* const response = model_->response_of(objects_[index].id);
  const bool impulse = response->type == ResponseType::kImpulse;
  change_motion(index, t, impulse ? law_after(response, law, after) : MotionModel(after), objects_[cause].id);
}

void MotionWorld::settle_velocities(WatchedPair& pair, SimTime t, Touching which, double restitution) {
  const std::array around{pair.collider, pair.collidee};
  ContactIsland island = island_of(*model_, objects_, pairs_, around, t, which, Quantity::kVelocity);
  if (which == Touching::kBearing && is_crowd(island)) {
    const AnsweredAlone alone = authority_.alone ? authority_.alone : [](ObjectId, ObjectId) { return true; };
    const double within_m = kForeseen_s * std::max(2.0 * fastest_m_s(far_, objects_, t), kRestSpeed_m_s);
    do {  // what is foreseen may be one more of the island, and foresee more
      island = island_of(*model_, objects_, pairs_, around, t, which, Quantity::kVelocity, alone);
    } while (far_.make_near(island.objects, within_m, start_, pairs_));
  }
  for (std::size_t i = 0; i < island.objects.size(); ++i) {
    if (island.reached_from[i] != kNone) continue;
    island.reached_from[i] = island.objects[i] == around[0] ? around[1] : around[0];
  }
  give_velocities(std::move(island), t, restitution);
}

void MotionWorld::give_velocities(ContactIsland island, SimTime t, double restitution) {
  for (const ConstrainedBody& body : island.bodies) settling_.fastest = std::max(settling_.fastest, body.value.norm());
  const std::vector<ConstrainedBody> before = island.bodies;
  counters_.note_island(island.giving_way());
  const std::vector<std::uint32_t> through = solve(island);
  if (!island.is_solved) {
    ++counters_.jammed;
    restitution = 0.0;
  }
  for (std::size_t i = 0; i < before.size(); ++i) {  // Newton's law for all that are struck at once
    island.bodies[i].value += restitution * (island.bodies[i].value - before[i].value);
  }
  for (const std::uint32_t i : through) {
    remember_course(i, t);
    set_bearing(pairs_[i], t, false);
    pairs_[i].squeezed = kGivenUp;
  }
  for (std::size_t i = 0; i < island.objects.size(); ++i) {
    const std::uint32_t index = island.objects[i];
    if (index == kNone) continue;
    Vec3& velocity = island.bodies[i].value;
    const double came = objects_.world_law(index, t).state.velocity.norm();
    const double flight = kShortestFlight_s * objects_.free_acceleration_of(index, t).norm();
    if (velocity.norm() <= kRounding * (came + flight)) velocity.setZero();  // nothing of it is left but rounding
    const Vec3 had = objects_.world_law(index, t).state.velocity;
    const bool is_rounding = !velocity.isZero(0.0) && (velocity - had).norm() <= kRounding * settling_.fastest;
    if (is_rounding) continue;
    const auto touches = [&](const OneSided& c) { return c.a == i || c.b == i; };
    std::uint32_t cause = island.reached_from[i];
    if (cause == kNone) {
      const auto c = std::ranges::find_if(island.constraints, touches);
      if (c == island.constraints.end()) continue;
      const WatchedPair& pair = pairs_[island.pairs[static_cast<std::size_t>(c - island.constraints.begin())]];
      cause = pair.collider == index ? pair.collidee : pair.collider;
    }
    change_velocity(index, t, velocity, cause);
  }
  for (const std::uint32_t i : through) let_through(i, t);
}

// The search of a pair may be ahead of t: in a world that goes through the past again it has met others at t, but
// neither of the two has got another way from then on. Then the two are apart where the search is. The last contact of
// two that bear each other since before t may be later than t.
void MotionWorld::let_through(std::uint32_t i, SimTime t) {
  WatchedPair& pair = pairs_[i];
  assert(pair.is_answered() && std::min(pair.touched, pair.bore_since) <= t);
  const bool lived = objects_.is_lived(pair.collider) || objects_.is_lived(pair.collidee);
  const bool is_ahead = pair.is_far || (!pair.contact && pair.clear_until > reopened_from(i, lived, t));
  if (is_ahead) return;
  remember_course(i, t);
  pair.inside = true;
}

void MotionWorld::answer_squeezed(WatchedPair& pair, SimTime t) {
  ++counters_.jammed;
  const std::size_t a = pair.collider, b = pair.collidee;
  const KinematicState before_a = objects_.world_law(a, t).state, before_b = objects_.world_law(b, t).state;
  if (++pair.squeezed <= kAnswersMax) settle_velocities(pair, t, Touching::kAny);
  const bool changed =
      !moves_alike(before_a, objects_.world_law(a, t).state) || !moves_alike(before_b, objects_.world_law(b, t).state);
  if (pair.squeezed > kAnswersMax || !changed) stop(pair, t);
}

// The two stand from t on, as far as they respond: there is no room left for any other answer.
void MotionWorld::stop(WatchedPair& pair, SimTime t) {
  const std::size_t a = pair.collider, b = pair.collidee;
  for (const auto& [index, registered, cause] :
       {std::tuple{a, pair.collider_responds, b}, std::tuple{b, pair.collidee_responds, a}}) {
    MovingObject& o = objects_[index];
    if (!o.will_respond(registered, t)) continue;
    if (!o.borne) o.free = objects_.free_acceleration_of(index, t);
    const KinematicState stands = at_rest(objects_.world_at(index, t).pose());
    const bool stood = is_motionless(objects_.world_law(index, t).state);
    o.borne = true;
    if (!stood) change_motion(index, t, stands, objects_[cause].id);
  }
  set_bearing(pair, t, true);
}

void MotionWorld::hold_against_wall(WatchedPair& wall, SimTime t) {
  const std::size_t held = gives_way(wall.collider, wall.collider_responds, t) ? wall.collider : wall.collidee;
  const bool stood = is_motionless(objects_.world_law(held, t).state);
  std::vector<std::uint32_t> through;
  for (const std::uint32_t i : pairs_.of_end(held)) {
    WatchedPair& pair = pairs_[i];
    if (!pair.is_answered()) continue;  // it presses nothing
    if (!met_lately(pair.touched, t, kShortestFlight) || stands_firm(objects_, pair, t)) continue;
    remember_course(i, t);
    set_bearing(pair, t, false);
    pair.lifts = false;
    pair.squeezed = kGivenUp;
    through.push_back(i);
  }
  wall.contact.reset();
  wall.inside = stood;  // it does not even move
  stop(wall, t);
  settle(t);
  for (const std::uint32_t i : through) {
    let_through(i, t);
    pairs_[i].contact.reset();
    reschedule(i);
  }
}

void MotionWorld::set_bearing(WatchedPair& pair, SimTime t, bool bears) {
  if (bears) {
    pair.begin_to_bear(t);
  } else if (!std::exchange(pair.bears, false)) {
    return;
  } else {
    pair.bore_until = t;
  }
  settling_.objects.push_back({pair.collider, pair.collidee});
  settling_.objects.push_back({pair.collidee, pair.collider});
}

void MotionWorld::unsettle_borne_by(std::size_t object, SimTime t) {
  for (const std::uint32_t i : pairs_.of_end(object)) {
    if (!pairs_[i].bears_at(t)) continue;
    WatchedPair& pair = pairs_[i];
    if (pair.normals.empty()) {
      remember_course(i, t);
      set_bearing(pair, t, false);
      continue;
    }
    const bool is_collider = pair.collider == object;
    const bool gives = gives_way(object, is_collider ? pair.collider_responds : pair.collidee_responds, t);
    if (!gives) {
      settling_.objects.push_back({is_collider ? pair.collidee : pair.collider, static_cast<std::uint32_t>(object)});
    }
  }
}

void MotionWorld::settle(SimTime t, bool in_bases) {
  std::unordered_set<std::uint32_t> known, settled;
  for (std::size_t k = 0; k < settling_.objects.size(); ++k) {  // it grows
    const std::uint32_t object = settling_.objects[k].object;
    if (known.insert(object).second) unsettle_borne_by(object, t);
  }
  for (std::size_t k = 0; k < settling_.objects.size(); ++k) {  // it grows
    const Settling::Object first = settling_.objects[k];
    if (settled.contains(first.object)) continue;
    const ContactIsland island = settle_island(first.object, t, in_bases);
    for (std::size_t i = 0; i < island.objects.size(); ++i) {
      if (island.objects[i] == kNone) continue;
      settled.insert(island.objects[i]);
      const std::uint32_t from = island.reached_from[i];
      set_borne_acceleration(island.objects[i], t, island.bodies[i].value, from != kNone ? from : first.cause,
                             in_bases);
    }
    note_solved(island, objects_, pairs_, t);
  }
  settling_ = {};
}

ContactIsland MotionWorld::settle_island(std::uint32_t object, SimTime t, bool in_bases) {
  for (;;) {
    ContactIsland island =
        island_of(*model_, objects_, pairs_, {&object, 1}, t, Touching::kBearing, Quantity::kAcceleration);
    counters_.note_island(island.giving_way());
    static_cast<void>(solve(island));  // what cannot be held is squeezed, and answered as that
    if (!island.is_solved) {           // what stands does not go on at the speed it had
      ++counters_.jammed;
      ContactIsland velocities =
          island_of(*model_, objects_, pairs_, {&object, 1}, t, Touching::kBearing, Quantity::kVelocity);
      for (std::size_t i = 0; i < velocities.bodies.size(); ++i) {
        if (velocities.objects[i] != kNone) velocities.bodies[i].value.setZero();
      }
      give_velocities(std::move(velocities), t, 0.0);
      return island;
    }
    bool released = false;  // others bear what it bore
    for (std::size_t held = 0; !released;) {
      const IslandParting parting =
          parting_of(island, objects_, pairs_, t, kSolverRounding * settling_.fastest, in_bases);
      released = !parting.released.empty();
      for (const std::uint32_t c : parting.released) {
        WatchedPair& pair = pairs_[island.pairs[c]];
        remember_course(island.pairs[c], t);
        std::erase(pair.normals, island.constraints[c].normal);
        if (pair.normals.empty()) set_bearing(pair, t, false);
      }
      if (released) break;
      if (!parting.pressed_part || parting.pressed.size() <= held) return island;
      held = parting.pressed.size();
      ContactIsland velocities =
          island_of(*model_, objects_, pairs_, {&object, 1}, t, Touching::kBearing, Quantity::kVelocity);
      hold_together(velocities, island, parting.pressed);
      give_velocities(std::move(velocities), t, 0.0);
    }
  }
}

void MotionWorld::set_borne_acceleration(std::size_t index, SimTime t, Vec3 acceleration, std::size_t cause,
                                         bool in_base) {
  MovingObject& o = objects_[index];
  const bool borne = std::ranges::any_of(pairs_.of_end(index), [&](std::uint32_t i) { return pairs_[i].bears; });
  if (!borne && (!o.borne || o.borne_unseen)) return;
  if (!o.borne) o.free = objects_.free_acceleration_of(index, t);
  o.borne = borne;
  o.borne_unseen = false;
  const MotionModel law = objects_.world_law(index, t);
  const bool slides = law.kind == MotionKind::kSliding;
  if (acceleration.norm() <= kRounding * o.free.norm()) acceleration.setZero();  // all of it is borne
  const Vec3 has = slides ? Vec3(Vec3::Zero()) : law.state.acceleration;
  if (acceleration == has) return;
  if (!acceleration.isZero(0.0) && (acceleration - has).norm() <= kRounding * o.free.norm()) return;
  KinematicState after = law.state;
  after.acceleration = acceleration;
  const CollisionResponse* const response = model_->response_of(o.id);
  const bool impulse = response->type == ResponseType::kImpulse;
  const bool lies = acceleration.isZero(0.0);
  change_motion(index, t, impulse ? law_after(response, lies ? law : MotionModel{}, after) : MotionModel(after),
                objects_[cause].id, in_base);
}

void MotionWorld::lift(WatchedPair& pair, SimTime t) {
  pair.contact.reset();
  pair.lifts = false;
  set_bearing(pair, t, false);
  pair.lifted = t;
  pair.normals.clear();
  settle(t);
}

// ---- advancing ----

std::optional<std::size_t> MotionWorld::first_contact_until(SimTime to) {
  std::optional<std::size_t> first;
  const std::size_t watched = watched_;
  std::size_t checked = 0;
  far_.follow(to, objects_, pairs_, opened_);
  reschedule_opened();
  // Searches due after a contact that is known are left for the next call: where many meet in one tick, each contact
  // would cost a visit of all that a multiple of kLookahead makes due.
  SimTime until = to;
  for (std::size_t slot = pair_checks_.next_due(0, to); slot < pair_checks_.size();  // which may grow
       slot = pair_checks_.next_due(slot + 1, until)) {
    const std::uint32_t i = pairs_.number_in(slot);
    WatchedPair& pair = pairs_[i];
    ++checked;
    const auto apart_at = search().search(pair, until);
    if (apart_at && far_.add(i, *apart_at, advanced_ - kHistory, objects_, pairs_)) {
      --watched_;
      pair_checks_.set(slot, SimTime::max());
      continue;
    }
    if (pair.stopped) stopped_.insert(i);
    reschedule(i);
    if (!pair.contact || *pair.contact > until || (first && *pair.contact == until && *first < i)) continue;
    first = i;
    until = *pair.contact;
  }
  assert(far_.is_known_at(until));
  counters_.searches_skipped += watched - std::min(watched, checked);
  return first;
}

void MotionWorld::advance(SimTime to) {
  assert(settling_.objects.empty());
  std::size_t contacts = 0;
  for (;;) {
    const bool lays = !retracted_bases_.empty() && retracted_bases_.begin()->first <= to;
    const SimTime until = lays ? retracted_bases_.begin()->first : to;
    const auto first = first_contact_until(until);
    if (lays && (!first || *pairs_[*first].contact == until)) {
      lay_next_base();
      continue;
    }
    if (!first) break;
    WatchedPair& pair = pairs_[*first];
    assert(*pair.contact <= until);
    remember_course(static_cast<std::uint32_t>(*first), *pair.contact);
    if (++contacts <= kContactsMax) {
      respond_to_contact(pair);
    } else {
      if (contacts == kContactsMax + 1) ++counters_.capped;
      const SimTime t = *pair.contact;
      pair.contact.reset();
      if (pair.lifts) {
        pair.lifts = false;
        set_bearing(pair, t, false);
      } else {
        stop(pair, t);
        pair.inside = true;
      }
      settle(t);
      pair.clear_until = t + kOverlapRetry;
    }
    reschedule(*first);
  }
  while (!retracted_bases_.empty()) lay_next_base();  // of the time that is still to come
  advanced_ = std::max(advanced_, to);
  searched_again_.clear();
  objects_.prune_timelines(advanced_);
  if (advanced_ >= courses_.forgotten + kHistory) {
    courses_.forgotten = advanced_;
    far_.forget_before(advanced_ - kHistory, pairs_);
    std::erase_if(courses_.pairs, [&](std::uint32_t i) {
      if (!pairs_.contains(i)) return true;
      pairs_[i].forget_course_before(advanced_ - kHistory);
      return pairs_[i].past.empty();
    });
  }
}

std::vector<ObjectId> MotionWorld::objects() const {
  std::vector<ObjectId> ids;
  for (const std::uint32_t i : objects_.asked_for()) ids.push_back(objects_.id_of(i));
  std::ranges::sort(ids);
  return ids;
}

KinematicState MotionWorld::at(ObjectId object, SimTime t) const {
  const std::size_t index = objects_.index_of(object);
  if (index + kPieceAhead < objects_.size()) {
    if (const MovingObject* const ahead = objects_.peek(index + kPieceAhead)) ahead->timeline.prefetch_piece();
    if (const MovingObject* const ahead = objects_.peek(index + kLawAhead)) ahead->timeline.prefetch_law(t);
  }
  return objects_.world_at(index, t);
}

KinematicState MotionWorld::relative_at(ObjectId object, SimTime t) const {
  return objects_[objects_.index_of(object)].timeline.at(t);
}

KinematicState MotionWorld::in_carrier(ObjectId object, SimTime t, const KinematicState& world) const {
  const std::size_t index = objects_.index_of(object);
  return objects_[index].carrier == kNone ? world : relative_to(objects_.carrier_at(index, t), world);
}

Vec3 MotionWorld::vector_in_carrier(ObjectId object, SimTime t, const Vec3& world) const {
  return objects_.in_frame_of_carrier(objects_.index_of(object), t, world);
}

Vec3 MotionWorld::vector_in_world(ObjectId object, SimTime t, const Vec3& relative) const {
  const std::size_t index = objects_.index_of(object);
  return objects_[index].carrier == kNone ? relative : Vec3(objects_.carrier_at(index, t).orientation * relative);
}

bool MotionWorld::is_at_rest_from(ObjectId object, SimTime t) const {
  for (std::uint32_t i = static_cast<std::uint32_t>(objects_.index_of(object)); i != kNone; i = objects_[i].carrier) {
    const Timeline& timeline = objects_[i].timeline;
    if (!is_motionless(timeline.at(t)) || timeline.next_change_after(t)) return false;
  }
  return true;
}

bool MotionWorld::stands_in_carrier_from(ObjectId object, SimTime t) const {
  const Timeline& timeline = objects_[objects_.index_of(object)].timeline;
  return is_motionless(timeline.at(t)) && !timeline.next_change_after(t);
}

MotionModel MotionWorld::model_at(ObjectId object, SimTime t) const {
  return objects_[objects_.index_of(object)].timeline.model_at(t);
}

bool MotionWorld::has_history_at(ObjectId object, SimTime t) const {
  if (!objects_.contains(object)) return false;
  const MovingObject& o = objects_[objects_.index_of(object)];
  return o.timeline.segment_at(advanced_ - objects_.history_of(o)).from <= t;
}

SimTime MotionWorld::law_since(ObjectId object, SimTime t) const {
  return objects_[objects_.index_of(object)].timeline.segment_at(t).from;
}

SimTime MotionWorld::base_time(ObjectId object) const {
  const MovingObject& o = objects_[objects_.index_of(object)];
  return o.bases.empty() ? o.base_time : o.bases.back().at;
}

std::uint64_t MotionWorld::revision(ObjectId object) const { return objects_[objects_.index_of(object)].revision; }

std::optional<MotionEvent> MotionWorld::poll_event() {
  assert(polled_ <= events_.size());
  if (polled_ < events_.size()) return std::move(events_[polled_++]);
  events_.clear();
  polled_ = 0;
  return std::nullopt;
}

}  // namespace peerd::replication
