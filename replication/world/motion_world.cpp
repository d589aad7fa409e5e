#include "replication/world/motion_world.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "collision/contact/mesh_contact.hpp"
#include "replication/world/response.hpp"

namespace peerd::replication {
namespace {

// A search goes no farther than to the next multiple of this. A longer time finds contacts that the next update makes
// void; a shorter one searches more often.
constexpr Duration kLookahead = std::chrono::milliseconds(250);
// While two objects are inside each other and move apart, the next check is after this long. The step is fixed and not
// the tick, so that peers with other tick rates find the same.
constexpr Duration kOverlapRetry = std::chrono::milliseconds(10);
// While two bear each other and one of them moves, whether they still touch is checked at the multiples of this.
constexpr Duration kBearingCheck{std::int64_t{1} << 24};
// Contacts as near as this are of one instant: contact times are rounded down to a nanosecond.
constexpr Duration kInstant = std::chrono::nanoseconds(2);
// Contacts that begin and end by one jump of a law are found within this time: world times are rounded to nanoseconds.
constexpr Duration kSameJump = std::chrono::microseconds(1);
// Two that part for a shorter time stay together (comes_to_rest).
constexpr Duration kShortestFlight{static_cast<std::int64_t>(kShortestFlight_s * 1e9)};
// After so many contacts of a pair in turn all that touch are answered at once; after as many of those again the two
// stop, and after as many again no answer is sought.
constexpr std::uint32_t kAnswersMax = 32, kGivenUp = 2 * kAnswersMax;
// A bound on the work of one advance(): after so many contacts what meets anything stops.
constexpr std::size_t kContactsMax = std::size_t{1} << 17;
// Normals of one pair at one instant that are told apart; more than the faces that meet in any corner of a box.
constexpr std::size_t kNormalsMax = 8;
// Normals with a cosine above this are of one face but for rounding.
constexpr double kSameNormal = 1.0 - 0x1p-40;
// A bound of the rounding of a speed or an acceleration along a normal, in parts of its size.
constexpr double kRounding = 0x1p-46;
// Timelines keep what is older for this much longer at most, or for as long again where that is less: a driven object
// gets a segment at each tick, and to forget them one by one would cost more than everything else.
constexpr Duration kPruneWithin = std::chrono::seconds(2);
// The objects' turns to be pruned within that time, so that one tick does not prune all of them.
constexpr std::int64_t kPruningSlots = 128;

SimTime grid_floor(SimTime t) { return floor_to(t, kLookahead); }

// A caller that asks for all objects does so in order: a piece is fetched so far ahead, and the law where it is
// needed.
constexpr std::size_t kPieceAhead = 8, kLawAhead = 4;

bool met_lately(SimTime met, SimTime t, Duration within) { return met <= t && t <= met + within; }

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
      pair_checks_(model.part_pairs.size()),
      in_pair_checks_(model.part_pairs.size()) {
  for (const ModelNode& node : model.nodes) add_object(node);
  for (const PartPair& parts : model.part_pairs) {
    const CollisionPair& p = model.pairs[parts.pair];
    const auto answers = [&](ObjectId id) { return model.scene->object(id).response.has_value(); };
    const std::size_t collider = index_of(p.collider), collidee = index_of(p.collidee);
    const bool box = p.type == CollisionType::kBox;
    const auto flexes = [&](std::uint32_t part) { return model.is_flexible(part); };
    const bool flexible = parts.a != kNone ? flexes(parts.a) || flexes(parts.b)
                                           : std::ranges::any_of(model.parts_of_node[collider], flexes) ||
                                                 std::ranges::any_of(model.parts_of_node[collidee], flexes);
    pairs_.push_back({.collider = static_cast<std::uint32_t>(collider),
                      .collidee = static_cast<std::uint32_t>(collidee),
                      .part_a = parts.a,
                      .part_b = parts.b,
                      .common = parts.common,
                      .number = parts.pair,
                      .type = p.type,
                      .fixed = parts.fixed,
                      .is_plain = parts.a == collider && parts.b == collidee && objects_[collider].carrier == kNone &&
                                  objects_[collidee].carrier == kNone,
                      .is_flexible = flexible,
                      .collider_responds = answers(p.collider),
                      .collidee_responds = p.mutual && answers(p.collidee),
                      .has_exact_search = box || flexible || collision::has_exact_answer(body(parts.a), body(parts.b)),
                      .clear_until = start,
                      .contact = {},
                      .free_at = {},
                      .normals = {}});
    objects_[collider].answers |= pairs_.back().collider_responds;
    objects_[collidee].answers |= pairs_.back().collidee_responds;
  }
  for (std::size_t i = 0; i < pairs_.size(); ++i) reschedule(i);
  assert(objects_.size() == model.nodes.size() && pairs_.size() == model.part_pairs.size());
}

std::span<const std::uint32_t> MotionWorld::pairs_of(std::size_t object) const {
  if (object >= model_.part_pairs_of_node.size()) return {};
  return model_.part_pairs_of_node[object];
}

std::span<const std::uint32_t> MotionWorld::pairs_moved_by(std::size_t object) const {
  if (object >= model_.moved_part_pairs.size()) return {};
  return model_.moved_part_pairs[object];
}

std::span<const std::uint32_t> MotionWorld::carried_by(std::size_t object) const {
  if (object >= model_.carried_by.size()) return {};
  return model_.carried_by[object];
}

void MotionWorld::add_object(const ModelNode& node) {
  KinematicState initial = at_rest(model_.scene->rigid_pose(node.object));
  if (node.carrier != kNone) {
    const KinematicState carrier = at_rest(model_.scene->rigid_pose(model_.nodes[node.carrier].object));
    initial = relative_to(carrier, initial);
  }
  index_by_id_[node.object.value] = static_cast<std::uint32_t>(objects_.size());
  objects_.push_back({.id = node.object,
                      .role = Role::kScene,
                      .timeline = Timeline(start_, initial),
                      .base_time = start_,
                      .carrier = node.carrier,
                      .bound = {}});
}

void MotionWorld::declare(ObjectId object, Role role) {
  assert(object.value < index_by_id_.size());
  if (find(object) == nullptr) add_object({object});  // the model does not need it: it meets nothing
  const std::size_t index = index_of(object);
  objects_[index].role = role;
  for (const std::uint32_t i : pairs_moved_by(index)) {
    pairs_[i].clear_until = std::max(pairs_[i].clear_until, advanced_);
    reschedule(i);
  }
}

void MotionWorld::watch(ObjectId a, ObjectId b, bool on) {
  if (model_.pairs_of(b).size() < model_.pairs_of(a).size()) std::swap(a, b);
  for (const std::uint32_t number : model_.pairs_of(a)) {
    const CollisionPair& pair = model_.pairs[number];
    if (pair.collider == b || pair.collidee == b) watch(number, on);
  }
}

void MotionWorld::watch(std::uint32_t number, bool on) {
  assert(number < model_.pairs.size());
  for (std::uint32_t i = model_.first_part_pair[number]; i < model_.first_part_pair[number + 1]; ++i) {
    Pair& pair = pairs_[i];
    if (pair.watched == on) continue;
    pair.watched = on;
    pair.contact.reset();
    if (pair.bears) lift(pair, advanced_);
    pair.clear_until = std::max(pair.clear_until, advanced_);
    reschedule(i);
  }
}

// Called after any change of whether the pair is watched, or of what is known of it.
void MotionWorld::reschedule(std::size_t i) {
  const Pair& pair = pairs_[i];
  const bool is_known = !pair.is_flexible || flexible_ != nullptr;
  const bool scheduled = pair.watched && !pair.unsupported && !pair.fixed && is_known;
  if (scheduled != in_pair_checks_[i]) {
    in_pair_checks_[i] = scheduled;
    scheduled ? ++watched_ : --watched_;
  }
  assert(watched_ <= pairs_.size());
  pair_checks_.set(i, scheduled ? pair.contact.value_or(pair.clear_until) : SimTime::max());
}

void MotionWorld::set_flexible(FlexibleParts& flexible) {
  flexible_ = &flexible;
  for (std::size_t i = 0; i < pairs_.size(); ++i) reschedule(i);
}

void MotionWorld::reopen_flexible(SimTime t) {
  assert(flexible_ != nullptr);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    Pair& pair = pairs_[i];
    if (!pair.is_flexible) continue;
    pair.contact.reset();
    pair.clear_until = std::min(pair.clear_until, std::max(t, start_));
    reschedule(i);
  }
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
  for (const std::uint32_t carried : carried_by(index)) {
    note_change(carried);
    objects_[carried].bound.until = SimTime::min();
  }
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
  if (pairs_moved_by(index).empty() && carried_by(index).empty()) {  // it meets nothing
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
  forget_bursts(index, t);
  retract_contacts_of_carried(index, t);
  const KinematicState before = o.timeline.at(t);
  const bool stays =
      before.position == model.state.position && before.orientation.coeffs() == model.state.orientation.coeffs() &&
      std::ranges::none_of(pairs_of(index), [&](std::uint32_t i) { return pairs_[i].bears && pairs_[i].touched > t; });
  MotionModel base = model;
  if (!stays) o.borne = false;
  const bool weightless_slide = base.kind == MotionKind::kSliding && o.free.isZero(0.0);
  if (o.free_is_given && !o.borne && !weightless_slide) {
    base.kind = MotionKind::kSecond;
    base.state.acceleration = in_frame_of_carrier(index, t, o.free);
  }
  o.timeline.replace_from(t, base, std::nullopt);
  timeline_changed(index);
  reopen_pairs(index, t, !stays);
  if (stays && o.borne) settle(index, index, t);
}

void MotionWorld::set_free_acceleration(ObjectId object, const Vec3& acceleration) {
  assert(acceleration.allFinite());
  Object& o = objects_[index_of(object)];
  const CollisionResponse* const response = model_.response_of(object);
  if (response != nullptr && response->type == ResponseType::kZero) return;  // what has stopped it holds it
  o.free = acceleration;
  o.free_is_given = true;
}

std::optional<Vec3> MotionWorld::free_acceleration(ObjectId object) const {
  const Object& o = objects_[index_of(object)];
  return o.free_is_given ? std::optional(o.free) : std::nullopt;
}

// Contacts that what the object carries has had outside of it may not be; those within it hold.
void MotionWorld::retract_contacts_of_carried(std::size_t object, SimTime t) {
  if (carried_by(object).empty()) return;
  for (const std::uint32_t i : pairs_moved_by(object)) {
    const std::uint32_t collider = pairs_[i].collider, collidee = pairs_[i].collidee;
    if (collider == object || collidee == object) continue;  // retracted with all of its own
    const bool has_collider = is_in_side(object, collider, pairs_[i].part_a);
    const std::uint32_t carried = has_collider ? collider : collidee, other = has_collider ? collidee : collider;
    events_.push_back(ContactsRetracted{objects_[carried].id, t - Duration{1}, objects_[other].id});
    retract(carried, t);
    forget_bursts(carried, t);
  }
}

// Retracts what followed from a contact with `cause` at t or later. Responses of authoritative objects stand.
void MotionWorld::retract(std::size_t cause, SimTime t) {
  if (cause >= model_.partners_of_node.size()) return;  // it meets nothing
  for (const std::uint32_t i : model_.partners_of_node[cause]) {
    Object& o = objects_[i];
    if (o.role != Role::kPredicted) continue;
    std::size_t wrong = o.timeline.first_not_before(t);
    while (wrong < o.timeline.segment_count() && o.timeline.segment(wrong).cause != objects_[cause].id) ++wrong;
    if (wrong == 0 || wrong == o.timeline.segment_count()) continue;
    const SimTime from = o.timeline.segment(wrong).from;
    if (o.base_time >= from) continue;  // its owner has published since
    o.timeline.truncate_from(from);
    timeline_changed(i);
    ++o.revision;
    events_.push_back(ContactsRetracted{o.id, from - Duration{1}});
    ++counters_.contacts_undone;
    forget_bursts(i, from);
    reopen_pairs(i, from, true);
    retract(i, from);
  }
}

void MotionWorld::forget_bursts(std::size_t object, SimTime t) {
  for (const std::uint32_t i : pairs_of(object)) {
    Pair& pair = pairs_[i];
    if (pair.touched >= t) pair.at_once = pair.in_burst = pair.squeezed = 0;
  }
}

// What the pairs of the object know of contacts since then is void. Pairs with an authoritative or driven object are
// not searched again in the past because another object moved otherwise; its own change (a decision) makes them
// searched there.
void MotionWorld::reopen_pairs(std::size_t object, SimTime t, bool elsewhere) {
  for (const std::uint32_t i : pairs_moved_by(object)) {
    Pair& pair = pairs_[i];
    const bool of_collider = pair.is_plain ? pair.collider == object : is_in_side(object, pair.collider, pair.part_a);
    const bool lived = is_lived(of_collider ? pair.collidee : pair.collider);
    const SimTime known = std::max(known_since(pair.collider), known_since(pair.collidee));
    const SimTime from = std::max({t, known, advanced_ - (lived ? Duration{0} : kHistory)});
    if (pair.contact && *pair.contact >= from) {
      pair.contact.reset();
      pair.lifts = false;
    }
    if (pair.free_at && *pair.free_at >= from) pair.free_at.reset();
    pair.clear_until = std::min(pair.clear_until, from);
    const bool given_up = pair.squeezed >= kGivenUp && met_lately(pair.touched, from, kShortestFlight);
    if (!given_up && (gives_way(pair.collider, pair.collider_responds, from) ||
                      gives_way(pair.collidee, pair.collidee_responds, from))) {
      pair.inside = false;
    }
    if (!is_answered(pair) && pair.touched >= from) pair.inside = false;  // that contact may not be
    if (pair.bears && elsewhere) {
      pair.contact = pair.clear_until;
      pair.lifts = true;
    }
    reschedule(i);
  }
}

// An update that its owner made after t already contains the outcome.
bool MotionWorld::will_respond(const Object& o, bool registered, SimTime t) {
  return registered && o.role >= Role::kAuthoritative && o.base_time <= t;
}

// ---- frames ----

MotionWorld::OwnChain MotionWorld::chain_of(std::uint32_t object, std::uint32_t common) const {
  OwnChain chain;
  for (std::uint32_t i = object; i != kNone && i != common; i = objects_[i].carrier) {
    chain.insert(chain.begin(), &objects_[i].timeline);
  }
  return chain;
}

KinematicState MotionWorld::world_at(std::size_t object, SimTime t) const {
  const Object& o = objects_[object];
  if (o.carrier == kNone) return o.timeline.at(t);
  const OwnChain chain = chain_of(static_cast<std::uint32_t>(object));
  return composed_at({chain.data(), chain.size()}, t);
}

KinematicState MotionWorld::carrier_at(std::size_t object, SimTime t) const {
  assert(objects_[object].carrier != kNone);
  return world_at(objects_[object].carrier, t);
}

Vec3 MotionWorld::in_frame_of_carrier(std::size_t object, SimTime t, const Vec3& world) const {
  if (objects_[object].carrier == kNone) return world;
  return carrier_at(object, t).orientation.conjugate() * world;
}

MotionModel MotionWorld::world_law(std::size_t object, SimTime t) const {
  const Object& o = objects_[object];
  return o.carrier == kNone ? o.timeline.model_at(t) : MotionModel(world_at(object, t));
}

bool MotionWorld::is_in_side(std::size_t object, std::size_t end, std::uint32_t part) const {
  assert(end < model_.nodes.size());
  if (object == end) return true;
  if (part != kNone) part = model_.frame_of(part);
  if (part != kNone && object == part) return true;
  const auto carries = carried_by(object);
  const auto is_carried = [&](std::size_t node) {
    return std::ranges::binary_search(carries, static_cast<std::uint32_t>(node));
  };
  if (part != kNone) return is_carried(part);
  return is_carried(end) || std::ranges::binary_search(carried_by(end), static_cast<std::uint32_t>(object));
}

// ---- searching ----

const SweptBound& MotionWorld::bound_of(std::size_t object, SimTime s) {
  Object& o = objects_[object];
  if (!o.bound.answers_for(s)) o.bound = make_bound(static_cast<std::uint32_t>(object), kNone, s);
  return o.bound;
}

MovingPart MotionWorld::moving_part(std::uint32_t part, const OwnChain& chain) const {
  assert(part < model_.nodes.size() + model_.flexible.size());
  if (!model_.is_flexible(part)) return {{chain.data(), chain.size()}, &body(part)};
  return {{chain.data(), chain.size()}, nullptr, flexible_, part - static_cast<std::uint32_t>(model_.nodes.size())};
}

SweptBound MotionWorld::make_bound(std::uint32_t part, std::uint32_t common, SimTime s) const {
  const SimTime begin = grid_floor(s), end = begin + kLookahead;
  const OwnChain chain = chain_of(model_.frame_of(part), common);
  const MovingPart moving = moving_part(part, chain);
  if (moving.flexible != nullptr || chain.empty()) return swept_bound_of_way(moving, s, end);
  if (chain.size() == 1) return swept_bound(*chain.front(), body(part), s, begin, end);
  const ComposedPiece piece = composed_piece(moving.chain, s, moving.body->extent_m(), kCoarseError_m);
  return swept_bound(piece, body(part), s, begin, end);
}

SweptBound MotionWorld::bound_of_end(std::size_t end, SimTime s) {
  assert(end < model_.parts_of_node.size() && !model_.parts_of_node[end].empty());
  SweptBound all;
  bool first = true;
  for (const std::uint32_t part : model_.parts_of_node[end]) {
    const SweptBound bound = as_box(model_.is_flexible(part) ? make_bound(part, kNone, s) : bound_of(part, s));
    all = first ? bound : merged(all, bound);
    first = false;
  }
  return all;
}

SweptBound MotionWorld::bound_of_side(const Pair& pair, bool of_collider, SimTime s) {
  const std::uint32_t part = of_collider ? pair.part_a : pair.part_b;
  if (part == kNone) return bound_of_end(of_collider ? pair.collider : pair.collidee, s);
  const bool is_kept = pair.common == kNone && !model_.is_flexible(part);
  return is_kept ? bound_of(part, s) : make_bound(part, pair.common, s);
}

template <class Function>
auto MotionWorld::with_query(const Pair& pair, Function function) const {
  const auto as = is_answered(pair) ? collision::MeetAs::kSolids : collision::MeetAs::kPolygons;
  if (pair.is_plain) {  // nothing is composed
    const Timeline *const a = &objects_[pair.part_a].timeline, *const b = &objects_[pair.part_b].timeline;
    const MovingPart part_a{{&a, 1}, &body(pair.part_a)}, part_b{{&b, 1}, &body(pair.part_b)};
    return function(PartQuery{{&part_a, 1}, {&part_b, 1}, pair.type, as});
  }
  boost::container::small_vector<OwnChain, 2> chains;
  boost::container::small_vector<MovingPart, 2> sides[2];
  const auto add = [&](std::size_t side, std::uint32_t part) {
    chains.push_back(chain_of(model_.frame_of(part), pair.common));
    sides[side].push_back(moving_part(part, {}));
  };
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const std::uint32_t part = side == 0 ? pair.part_a : pair.part_b;
    if (part != kNone) {
      add(side, part);
    } else {
      for (const std::uint32_t each : model_.parts_of_node[side == 0 ? pair.collider : pair.collidee]) add(side, each);
    }
  }
  std::size_t next = 0;  // the chains do not move any more
  for (auto& side : sides) {
    for (MovingPart& part : side) {
      part.chain = {chains[next].data(), chains[next].size()};
      ++next;
    }
  }
  const PartQuery query{{sides[0].data(), sides[0].size()}, {sides[1].data(), sides[1].size()}, pair.type, as};
  return function(query);
}

void MotionWorld::search_window(Pair& pair) {
  const SimTime s = pair.clear_until;
  if (pair.is_plain) {
    search_window(pair, bound_of(pair.part_a, s), bound_of(pair.part_b, s));
  } else {
    search_composed_window(pair);
  }
}

void MotionWorld::search_composed_window(Pair& pair) {
  const SweptBound a = bound_of_side(pair, true, pair.clear_until), b = bound_of_side(pair, false, pair.clear_until);
  search_window(pair, a, b);
}

void MotionWorld::search_window(Pair& pair, const SweptBound& bound_a, const SweptBound& bound_b) {
  const SimTime s = pair.clear_until;
  SimTime end = grid_floor(s) + kLookahead;
  if (bound_a.next_change) end = std::min(end, *bound_a.next_change);
  if (bound_b.next_change) end = std::min(end, *bound_b.next_change);
  const bool still = bound_a.still && bound_b.still;
  if (pair.bears && !still) end = std::min(end, floor_to(s, kBearingCheck) + kBearingCheck);
  assert(end > s);

  if (still) {  // two objects that stand do not meet
    ++counters_.searches_skipped;
    pair.clear_until = bound_a.next_change || bound_b.next_change ? end : SimTime::max();
    return;
  }
  if (pair.has_exact_search && apart(bound_a, bound_b, pair.type)) {
    ++counters_.searches_far;
    if (pair.bears) {
      if (s < pair.held_until) {
        pair.clear_until = std::min(pair.held_until, end);
      } else {
        pair.contact = s;
        pair.lifts = true;
      }
      return;
    }
    note_apart(pair, s);
    pair.clear_until = end;
    return;
  }
  // A search begins not where this peer happens to be, but at the last instant until s that the timelines alone
  // decide, so that equal timelines give equal contact times, to the last bit.
  SimTime begin = grid_floor(s);
  if (bound_a.last_change) begin = std::max(begin, *bound_a.last_change);
  if (bound_b.last_change) begin = std::max(begin, *bound_b.last_change);
  search_interval(pair, begin, end);
  const SimTime held = std::max(s, pair.held_until);
  if (pair.bears && !pair.contact && held < pair.clear_until) search_lift(pair, held, pair.clear_until);
}

bool MotionWorld::touch_at(const Pair& pair, SimTime t) const {
  return with_query(pair, [&](const PartQuery& query) { return parts_touch(query, t); });
}

// Whether another part of the one end touches another part of the other one: then the two ends did so before t.
bool MotionWorld::ends_touch_elsewhere(const Pair& pair, SimTime t) {
  assert(!is_answered(pair) && pair.number + 1 < model_.first_part_pair.size());
  for (std::uint32_t i = model_.first_part_pair[pair.number]; i < model_.first_part_pair[pair.number + 1]; ++i) {
    Pair& other = pairs_[i];
    if (&other == &pair || other.unsupported) continue;
    // A law may make an end jump, so that one part begins to touch as another ceases to.
    // The search may have gone beyond t.
    const bool has_parted = !other.inside && other.parted >= t - kSameJump;
    const SimTime before = (has_parted ? std::min(other.parted, t) : t) - Duration{1};
    const bool touched = (other.inside || !other.searched || has_parted) && touch_at(other, before);
    if (other.fixed ? fixed_parts_touch(other, t) : touched) return true;
  }
  return false;
}

bool MotionWorld::ends_touch(ObjectId a, ObjectId b, SimTime t) {
  for (const std::uint32_t number : model_.pairs_of(a)) {
    if (model_.pairs[number].collider != b && model_.pairs[number].collidee != b) continue;
    for (std::uint32_t i = model_.first_part_pair[number]; i < model_.first_part_pair[number + 1]; ++i) {
      Pair& pair = pairs_[i];
      if (pair.unsupported) continue;
      // A contact that nobody answers is followed while it lasts.
      const bool followed = !is_answered(pair) && in_pair_checks_[i] && pair.searched;
      if (pair.fixed ? fixed_parts_touch(pair, t) : followed ? pair.inside : touch_at(pair, t)) return true;
    }
  }
  return false;
}

bool MotionWorld::fixed_parts_touch(Pair& pair, SimTime t) const {
  assert(pair.fixed);
  if (pair.type == CollisionType::kBox) return touch_at(pair, t);
  if (!pair.fixed_touch) {
    const auto state = [&](std::uint32_t part) {
      const OwnChain chain = chain_of(part, pair.common);
      return chain.empty() ? KinematicState{} : composed_at({chain.data(), chain.size()}, t);
    };
    const KinematicState a = state(pair.part_a), b = state(pair.part_b);
    pair.fixed_touch = collision::different_shapes_touch({body(pair.part_a), a}, {body(pair.part_b), b});
  }
  return *pair.fixed_touch;
}

void MotionWorld::search_lift(Pair& pair, SimTime begin, SimTime end) {
  assert(pair.bears && begin < end);
  if (touch_at(pair, end)) return;
  SimTime touching = begin, apart = end;
  while (apart - touching > Duration{1}) {
    const SimTime middle = touching + (apart - touching) / 2;
    (touch_at(pair, middle) ? touching : apart) = middle;
  }
  pair.contact = pair.clear_until = apart;
  pair.lifts = true;
}

// Until the base of an object that responds it went through everything: the base says where it really was.
void MotionWorld::note_apart(Pair& pair, SimTime s) {
  if (std::exchange(pair.inside, false)) pair.parted = s;
  const auto is_given_later = [&](std::size_t object, bool registered) {
    return registered && is_answering(objects_[object]) && objects_[object].base_time > s;
  };
  if (is_given_later(pair.collider, pair.collider_responds)) return;
  if (is_given_later(pair.collidee, pair.collidee_responds)) return;
  pair.free_at = s;
}

// A contact that nobody answers is one for as long as it lasts.
bool MotionWorld::goes_on(Pair& pair, SimTime s, SimTime end) {
  if (is_answered(pair) || !pair.inside) return false;
  if (!touch_at(pair, s)) {
    note_apart(pair, s);
    return false;
  }
  pair.clear_until = with_query(pair, [&](const PartQuery& query) { return parts_touch_until(query, s, end); });
  return true;
}

void MotionWorld::search_interval(Pair& pair, SimTime begin, SimTime end) {
  const Object &a = objects_[pair.collider], &b = objects_[pair.collidee];
  const SimTime s = pair.clear_until;
  assert(begin <= s && s < end);
  // What nobody answered because a base was given later is answered from that base on.
  const auto answers_since = [&](const Object& o, bool registered) {
    return will_respond(o, registered, s) && o.base_time > pair.touched;
  };
  if (answers_since(a, pair.collider_responds) || answers_since(b, pair.collidee_responds)) pair.inside = false;
  if (goes_on(pair, s, end)) return;
  const PartContact found = with_query(pair, [&](const PartQuery& query) {
    return first_part_contact(query, begin, s, end, counters_.contact_searches);
  });
  collision::Contact c = found.contact;
  const KinematicState &state_a = found.a, &state_b = found.b;
  const auto contact_at = [&](SimTime t, bool overlapped) {
    assert(t >= s);
    pair.contact = t;
    pair.clear_until = t;
    pair.normal = pair.common == kNone ? c.normal_world : Vec3(world_at(pair.common, t).orientation * c.normal_world);
    pair.overlapped = overlapped;
    pair.resting = c.resting;
    pair.lifts = false;
  };
  const bool first = !std::exchange(pair.searched, true);
  switch (c.state) {
    case collision::ContactState::kSeparated:
      note_apart(pair, s);
      pair.clear_until = end;
      return;
    case collision::ContactState::kContact: {
      const SimTime t = found.at;
      if (t > s) note_apart(pair, s);
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
      if (first) events_.push_back(BodiesOverlap{s, a.id, b.id});
      if (!is_answered(pair)) {
        if (s > start_) return contact_at(found.at, true);  // a law has put it there
        pair.inside = true;
        pair.clear_until = std::min(s + kTouchCheck, end);
        return;
      }
      const double speed = c.normal_world.dot(state_a.velocity - state_b.velocity);
      const bool pressed = speed == 0.0 && c.normal_world.dot(state_a.acceleration - state_b.acceleration) < 0.0;
      const bool answers = will_respond(a, pair.collider_responds, s) || will_respond(b, pair.collidee_responds, s);
      if ((speed < 0.0 || pressed) && answers && !pair.inside) {
        c.resting = pressed;
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
      pair.clear_until = std::min(std::max(s + kOverlapRetry, found.at), end);
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

// ---- answers to a contact ----

MotionModel MotionWorld::motion_after_response(std::size_t object, const Pair& pair, const MotionModel& self,
                                               const KinematicState& other, OtherSide other_side, const Vec3& n) const {
  const Object& o = objects_[object];
  const CollisionResponse* const response = model_.response_of(o.id);
  assert(response != nullptr && pair.contact);
  const Object& met = objects_[pair.collider == object ? pair.collidee : pair.collider];
  KinematicState after = respond({*response, model_.response_of(met.id), other_side, self.state, other, n});
  // At a contact time the object still stands where it did not collide; only an overlap leaves something to set back.
  if (pair.overlapped && response->set_back && pair.free_at) {
    const Vec3 back = world_at(object, *pair.free_at).position;
    // What is set back against its weight takes the work from its speed, or stays.
    const double left = after.velocity.squaredNorm() + 2.0 * after.acceleration.dot(back - after.position);
    if (left >= after.velocity.squaredNorm()) {
      after.position = back;
    } else if (left >= 0.0) {
      after.velocity *= std::sqrt(left / after.velocity.squaredNorm());
      after.position = back;
    }
  }
  if (same_motion(after, self.state)) return self;
  if (response->type == ResponseType::kImpulse) return law_after(response, self, after);
  return after_contact(self, after, n, response->type == ResponseType::kInverse);
}

MotionWorld::Answer MotionWorld::answer_to(const Pair& pair) const {
  assert(pair.contact);
  const SimTime t = *pair.contact;
  const Object &a = objects_[pair.collider], &b = objects_[pair.collidee];
  Answer answer;
  answer.authority = authority_of_ ? authority_of_(a.id, b.id, t) : ContactAuthority::kAsPublished;
  const auto answers = [&](const Object& o, bool registered) {
    const bool could_not_know = answer.authority != ContactAuthority::kAsPublished && o.role == Role::kPredicted;
    return will_respond(o, registered, could_not_know ? SimTime::max() : t);
  };
  answer.a_responds = answers(a, pair.collider_responds);
  answer.b_responds = answers(b, pair.collidee_responds);
  answer.before_a = answer.after_a = world_law(pair.collider, t);
  answer.before_b = answer.after_b = world_law(pair.collidee, t);
  const KinematicState &state_a = answer.before_a.state, &state_b = answer.before_b.state;
  const auto other_side = [&](const Object& o, bool registered, bool responds) {
    if (!is_answering(o)) return OtherSide::kGoesOn;
    const bool takes_part = registered && (responds || is_in_later_update(o, pair));
    return takes_part ? OtherSide::kAnswers : OtherSide::kAnswersApart;
  };
  if (answer.a_responds) {
    const OtherSide other = other_side(b, pair.collidee_responds, answer.b_responds);
    answer.after_a = motion_after_response(pair.collider, pair, answer.before_a, state_b, other, pair.normal);
  }
  if (answer.b_responds) {
    const OtherSide other = other_side(a, pair.collider_responds, answer.a_responds);
    answer.after_b = motion_after_response(pair.collidee, pair, answer.before_b, state_a, other, -pair.normal);
  }
  return answer;
}

// Whether the two would part for no more than kShortestFlight_s.
bool MotionWorld::comes_to_rest_at(const Pair& pair, const Answer& answer) const {
  const Vec3& n = pair.normal;
  if (pair.resting) return true;
  if (pair.overlapped) return false;
  const auto free = [&](std::size_t object, const MotionModel& after) {
    return pair.bears ? free_acceleration_of(object, *pair.contact) : after.state.acceleration;
  };
  const double speed = n.dot(answer.after_a.state.velocity - answer.after_b.state.velocity);
  const double acceleration = n.dot(free(pair.collider, answer.after_a) - free(pair.collidee, answer.after_b));
  const double came = (answer.before_a.state.velocity - answer.before_b.state.velocity).norm();
  return speed >= -kRounding * came && comes_to_rest(std::max(speed, 0.0), acceleration);
}

// Two that close although their centres do not approach along the normal: a turning body strikes with a corner, and its
// spin ends; or the normal is not that of the place where they close, and they go back the way they came.
void MotionWorld::answer_closing(const Pair& pair, Answer& answer) const {
  KinematicState &a = answer.after_a.state, &b = answer.after_b.state;
  if (!same_motion(answer.before_a.state, a) || !same_motion(answer.before_b.state, b)) return;
  const auto turns = [](bool responds, const KinematicState& s) {
    return responds && !s.angular_velocity_body.isZero(0.0);
  };
  const bool a_turns = turns(answer.a_responds, a), b_turns = turns(answer.b_responds, b);
  const auto stop_spin = [](MotionModel& law) {
    law.state.angular_velocity_body.setZero();
    law.angular_acceleration_body.setZero();
  };
  if (a_turns) stop_spin(answer.after_a);
  if (b_turns) stop_spin(answer.after_b);
  if (a_turns || b_turns) return;
  const Vec3 approach = a.velocity - b.velocity;
  const double speed = approach.norm();
  if (pair.normal.dot(approach) <= 0x1p-30 * speed) return;  // they graze
  Pair back = pair;
  back.normal = -approach / speed;
  answer = answer_to(back);
}

void MotionWorld::respond_to_contact(Pair& pair) {
  assert(pair.contact);
  const SimTime t = *pair.contact;
  if (pair.lifts) {
    lift(pair, t);
    return;
  }
  note_touch(pair, t);
  Answer answer = answer_to(pair);
  const std::size_t a = pair.collider, b = pair.collidee;
  if (pair.squeezed >= kGivenUp && stands_firm(pair, t)) {
    hold_against_wall(pair, t);
    return;
  }
  if (answer.authority == ContactAuthority::kDeferred || (!answer.a_responds && !answer.b_responds) ||
      pair.squeezed >= kGivenUp) {
    const bool goes_on = !is_answered(pair) && ends_touch_elsewhere(pair, t);
    pair.contact.reset();
    pair.inside = true;
    if (!goes_on) report(pair, t, answer);
    return;
  }
  if (is_squeezed(pair, t)) {
    answer_squeezed(pair, t);
  } else if (comes_to_rest_at(pair, answer)) {
    come_to_rest(pair, t);
  } else {
    if (!pair.overlapped) answer_closing(pair, answer);
    if (answer.a_responds) change_motion(a, t, answer.after_a, objects_[b].id);
    if (answer.b_responds) change_motion(b, t, answer.after_b, objects_[a].id);
    settle(a, b, t);
  }
  remove_gain(pair, t, answer);
  pair.contact.reset();
  answer.after_a = world_law(a, t);
  answer.after_b = world_law(b, t);
  const bool changed = !same_motion(answer.before_a.state, answer.after_a.state) ||
                       !same_motion(answer.before_b.state, answer.after_b.state);
  if (!changed && pair.bears) {  // they rest as before
    pair.clear_until = t + kOverlapRetry;
    return;
  }
  // A contact in which no response changes anything (an object that was stopped is run into) goes on.
  pair.inside = !changed;
  report(pair, t, answer);
}

// What others that touch the two have handed on may have made them faster; of two that both answer contacts none is a
// racket, so they go as they would, only slower.
void MotionWorld::remove_gain(const Pair& pair, SimTime t, const Answer& answer) {
  const std::size_t a = pair.collider, b = pair.collidee;
  if (!is_answering(objects_[a]) || !is_answering(objects_[b])) return;
  const bool in_update = (!answer.a_responds && is_in_later_update(objects_[a], pair)) ||
                         (!answer.b_responds && is_in_later_update(objects_[b], pair));
  if (in_update) return;
  const auto energy = [&](std::size_t object, bool responds, const KinematicState& s) {
    return responds ? model_.response_of(objects_[object].id)->mass_kg * s.velocity.squaredNorm() : 0.0;
  };
  const Vec3 velocity_a = world_law(a, t).state.velocity, velocity_b = world_law(b, t).state.velocity;
  const double before = energy(a, answer.a_responds, answer.before_a.state) +
                        energy(b, answer.b_responds, answer.before_b.state),
               after = energy(a, answer.a_responds, world_law(a, t).state) +
                       energy(b, answer.b_responds, world_law(b, t).state);
  if (after <= before * (1.0 + kRounding)) return;
  const double slower = std::sqrt(before / after);
  if (answer.a_responds) change_velocity(a, t, slower * velocity_a, b);
  if (answer.b_responds) change_velocity(b, t, slower * velocity_b, a);
}

void MotionWorld::report(const Pair& pair, SimTime t, const Answer& answer) {
  // An object that slides by the world's friction is published with exactly the deceleration by which receivers
  // recognise it (law_of_outcome), also where it does not respond: that of its own law has been turned and rounded
  // since its base.
  const auto state_as_published = [&](ObjectId id, const MotionModel& after) {
    const bool slides = after.kind == MotionKind::kSliding;
    return slides ? law_after(model_.response_of(id), after, after.state).state : after.state;
  };
  const ObjectId a = objects_[pair.collider].id, b = objects_[pair.collidee].id;
  ++counters_.contacts;
  events_.push_back(ContactEvent{t, a, b, pair.normal, answer.before_a.state, answer.before_b.state,
                                 state_as_published(a, answer.after_a), state_as_published(b, answer.after_b),
                                 pair.type, answer.authority == ContactAuthority::kDeferred});
}

void MotionWorld::change_motion(std::size_t index, SimTime t, const MotionModel& after_in_world, ObjectId cause) {
  Object& o = objects_[index];
  MotionModel after = after_in_world;
  if (o.carrier != kNone) after = MotionModel(relative_to(carrier_at(index, t), after_in_world.state));
  if (o.timeline.last_segment().from > t) events_.push_back(ContactsRetracted{o.id, t});
  // Other contacts of the same instant were answered before, and stand.
  retract(index, t + Duration{1});
  o.timeline.replace_from(t, after, cause);
  // A later update is gone from here: it was of another way than the one that is decided here.
  o.base_time = std::min(o.base_time, t);
  timeline_changed(index);
  reopen_pairs(index, t, false);
}

void MotionWorld::note_touch(Pair& pair, SimTime t) {
  if (!met_lately(pair.touched, t, kInstant)) pair.at_once = 0;
  if (!met_lately(pair.touched, t, kShortestFlight)) {
    pair.in_burst = pair.squeezed = 0;
    if (!pair.bears) pair.normals.clear();
  }
  pair.touched = t;
  ++pair.at_once;
  ++pair.in_burst;
  const auto same = std::ranges::find_if(pair.normals, [&](const Vec3& n) { return n.dot(pair.normal) > kSameNormal; });
  if (same != pair.normals.end()) {
    *same = pair.normal;
  } else if (pair.normals.size() < kNormalsMax) {
    pair.normals.push_back(pair.normal);
  } else {
    pair.normals.front() = pair.normal;
  }
}

// ---- what bears what ----

Vec3 MotionWorld::free_acceleration_of(std::size_t index, SimTime t) const {
  const Object& o = objects_[index];
  if (o.borne) return o.free;
  const MotionModel law = world_law(index, t);
  return law.kind == MotionKind::kSliding ? Vec3(Vec3::Zero()) : law.state.acceleration;
}

MotionWorld::Island MotionWorld::island_of(std::size_t a, std::size_t b, SimTime t, Touching which,
                                           Quantity quantity) const {
  Island island;
  const auto add = [&](std::size_t index, bool moves) {
    const auto object = static_cast<std::uint32_t>(index);
    if (moves) {
      const auto known = std::ranges::find(island.objects, object);
      if (known != island.objects.end()) return static_cast<std::uint32_t>(known - island.objects.begin());
    }
    const KinematicState state = world_law(index, t).state;
    const CollisionResponse* const response = model_.response_of(objects_[index].id);
    const bool accelerated = quantity == Quantity::kAcceleration;
    island.objects.push_back(moves ? object : kNone);
    island.bodies.push_back({!accelerated ? state.velocity
                             : moves      ? free_acceleration_of(index, t)
                                          : state.acceleration,
                             moves ? 1.0 / response->mass_kg : 0.0});
    return static_cast<std::uint32_t>(island.objects.size() - 1);
  };
  for (const std::size_t index : {a, b}) {
    if (will_respond(objects_[index], model_.response_of(objects_[index].id) != nullptr, t)) add(index, true);
  }
  std::vector<std::uint32_t> seen;
  for (std::size_t next = 0; next < island.objects.size(); ++next) {
    const std::uint32_t object = island.objects[next];
    if (object == kNone) continue;
    for (const std::uint32_t i : pairs_of(object)) {
      const Pair& pair = pairs_[i];
      const bool touches = pair.bears || (which == Touching::kAny && met_lately(pair.touched, t, kShortestFlight));
      if (!touches || !pair.watched || std::ranges::find(seen, i) != seen.end()) continue;
      seen.push_back(i);
      const bool a_moves = will_respond(objects_[pair.collider], pair.collider_responds, t);
      const bool b_moves = will_respond(objects_[pair.collidee], pair.collidee_responds, t);
      if (!a_moves && !b_moves) continue;
      const std::uint32_t body_a = add(pair.collider, a_moves), body_b = add(pair.collidee, b_moves);
      for (const Vec3& n : pair.normals) {
        island.constraints.push_back({body_a, body_b, n});
        island.pairs.push_back(i);
      }
    }
  }
  return island;
}

std::vector<std::uint32_t> MotionWorld::solve(Island& island) {
  if (change_least(island.bodies, island.constraints)) return {};
  // What comes and gives way to nothing leaves no room: it goes through, rather than push the others through what
  // stands.
  std::vector<std::uint32_t> through;
  std::vector<OneSided> standing;
  for (std::size_t i = 0; i < island.constraints.size(); ++i) {
    const OneSided& c = island.constraints[i];
    const auto comes = [&](std::uint32_t body) {
      return island.objects[body] == kNone && !island.bodies[body].value.isZero(0.0);
    };
    if (comes(c.a) || comes(c.b)) {
      through.push_back(island.pairs[i]);
    } else {
      standing.push_back(c);
    }
  }
  if (change_least(island.bodies, standing)) return through;
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {  // rounding left no solution: to stand is always one
    if (island.objects[i] != kNone) island.bodies[i].value.setZero();
  }
  return through;
}

void MotionWorld::come_to_rest(Pair& pair, SimTime t) {
  ++counters_.came_to_rest;
  // A turning body that is pressed hard would be lifted by its edges and meet again without end.
  if (met_lately(pair.lifted, t, kShortestFlight)) pair.held_until = t + kShortestFlight;
  pair.bears = true;
  const std::size_t a = pair.collider, b = pair.collidee;
  if (will_respond(objects_[a], pair.collider_responds, t)) end_rolling(a, t, pair.normal, b);
  if (will_respond(objects_[b], pair.collidee_responds, t)) end_rolling(b, t, pair.normal, a);
  const MotionModel law_a = world_law(a, t), law_b = world_law(b, t);
  // What parts too slowly to come apart would be lifted off for good without the acceleration that presses it. Where a
  // body rolls, the speed of its centre is not that of the contact.
  const double speed = pair.normal.dot(law_a.state.velocity - law_b.state.velocity);
  const bool rolls = rolling_off(a, law_a.state, pair.normal) || rolling_off(b, law_b.state, pair.normal);
  const bool driven = (!gives_way(a, pair.collider_responds, t) && !is_motionless(law_a.state)) ||
                      (!gives_way(b, pair.collidee_responds, t) && !is_motionless(law_b.state));
  if (speed > 0.0 && !rolls && !driven) {  // to keep up with what moves away would take energy
    const auto gives = [&](std::size_t object, bool registered) {
      const CollisionResponse* const response = model_.response_of(objects_[object].id);
      return will_respond(objects_[object], registered, t) ? 1.0 / response->mass_kg : 0.0;
    };
    const double of_a = gives(a, pair.collider_responds), of_b = gives(b, pair.collidee_responds);
    if (of_a > 0.0) change_velocity(a, t, law_a.state.velocity - (speed * of_a / (of_a + of_b)) * pair.normal, b);
    if (of_b > 0.0) change_velocity(b, t, law_b.state.velocity + (speed * of_b / (of_a + of_b)) * pair.normal, a);
  }
  settle_velocities(pair, t, Touching::kBearing);
  settle(a, b, t);
}

std::optional<Vec3> MotionWorld::rolling_off(std::size_t index, const KinematicState& state, const Vec3& normal) const {
  const std::optional<collision::ExactSphere>& sphere = body(index).sphere;
  const Vec3& all = state.angular_velocity_body;
  if (all.isZero(0.0) || (sphere && sphere->center.isZero(0.0))) return std::nullopt;
  const Vec3 n = state.orientation.conjugate() * normal;
  Vec3 spin = n.dot(all) * n;
  if ((spin - all).norm() <= kRounding * spin.norm()) return std::nullopt;
  return spin;
}

void MotionWorld::end_rolling(std::size_t index, SimTime t, const Vec3& normal, std::size_t cause) {
  MotionModel law = world_law(index, t);
  const std::optional<Vec3> spin = rolling_off(index, law.state, normal);
  if (!spin) return;
  law.state.angular_velocity_body = *spin;
  law.angular_acceleration_body.setZero();
  change_motion(index, t, law, objects_[cause].id);
}

void MotionWorld::change_velocity(std::size_t index, SimTime t, const Vec3& velocity, std::size_t cause) {
  const MotionModel law = world_law(index, t);
  if (law.state.velocity == velocity) return;
  KinematicState after = law.state;
  after.velocity = velocity;
  const CollisionResponse* const response = model_.response_of(objects_[index].id);
  const bool impulse = response->type == ResponseType::kImpulse;
  change_motion(index, t, impulse ? law_after(response, law, after) : MotionModel(after), objects_[cause].id);
}

void MotionWorld::settle_velocities(Pair& pair, SimTime t, Touching which) {
  const std::size_t a = pair.collider, b = pair.collidee;
  Island island = island_of(a, b, t, which, Quantity::kVelocity);
  for (const std::uint32_t i : solve(island)) {
    Pair& through = pairs_[i];
    through.bears = false;
    through.inside = true;
    through.squeezed = kGivenUp;
  }
  for (std::size_t i = 0; i < island.objects.size(); ++i) {
    const std::uint32_t index = island.objects[i];
    if (index == kNone) continue;
    Vec3& velocity = island.bodies[i].value;
    const double came = world_law(index, t).state.velocity.norm();
    const double flight = kShortestFlight_s * free_acceleration_of(index, t).norm();
    if (velocity.norm() <= kRounding * (came + flight)) velocity.setZero();  // nothing of it is left but rounding
    change_velocity(index, t, velocity, index == a ? b : a);
  }
}

bool MotionWorld::is_squeezed(const Pair& pair, SimTime t) const {
  return pair.at_once > kAnswersMax || (pair.in_burst > kAnswersMax && is_driven(pair, t));
}

bool MotionWorld::is_driven(const Pair& pair, SimTime t) const {
  const Island island = island_of(pair.collider, pair.collidee, t, Touching::kAny, Quantity::kVelocity);
  for (std::size_t i = 0; i < island.objects.size(); ++i) {
    if (island.objects[i] == kNone && !island.bodies[i].value.isZero(0.0)) return true;
  }
  return false;
}

void MotionWorld::answer_squeezed(Pair& pair, SimTime t) {
  ++counters_.jammed;
  const std::size_t a = pair.collider, b = pair.collidee;
  const KinematicState before_a = world_law(a, t).state, before_b = world_law(b, t).state;
  if (++pair.squeezed <= kAnswersMax) settle_velocities(pair, t, Touching::kAny);
  const bool changed = !same_motion(before_a, world_law(a, t).state) || !same_motion(before_b, world_law(b, t).state);
  if (pair.squeezed > kAnswersMax || !changed) stop(pair, t);
  settle(pair.collider, pair.collidee, t);
}

// The two stand from t on, as far as they respond: there is no room left for any other answer.
void MotionWorld::stop(Pair& pair, SimTime t) {
  const std::size_t a = pair.collider, b = pair.collidee;
  for (const auto& [index, registered, cause] :
       {std::tuple{a, pair.collider_responds, b}, std::tuple{b, pair.collidee_responds, a}}) {
    Object& o = objects_[index];
    if (!will_respond(o, registered, t)) continue;
    if (!o.borne) o.free = free_acceleration_of(index, t);
    const KinematicState stands = at_rest(world_at(index, t).pose());
    const bool stood = is_motionless(world_law(index, t).state);
    o.borne = true;
    if (!stood) change_motion(index, t, stands, objects_[cause].id);
  }
  pair.bears = true;
}

bool MotionWorld::stands_firm(const Pair& pair, SimTime t) const {
  const bool a_gives_way = gives_way(pair.collider, pair.collider_responds, t);
  if (a_gives_way == gives_way(pair.collidee, pair.collidee_responds, t)) return false;
  return is_motionless(world_at(a_gives_way ? pair.collidee : pair.collider, t));
}

void MotionWorld::hold_against_wall(Pair& wall, SimTime t) {
  const std::size_t held = gives_way(wall.collider, wall.collider_responds, t) ? wall.collider : wall.collidee;
  const bool stood = is_motionless(world_law(held, t).state);
  for (const std::uint32_t i : pairs_of(held)) {
    Pair& pair = pairs_[i];
    if (!met_lately(pair.touched, t, kShortestFlight) || stands_firm(pair, t)) continue;
    pair.contact.reset();
    pair.bears = pair.lifts = false;
    pair.inside = true;
    pair.squeezed = kGivenUp;
    reschedule(i);
  }
  wall.contact.reset();
  wall.inside = stood;  // it does not even move
  stop(wall, t);
}

void MotionWorld::release_parting(std::size_t object, SimTime t) {
  for (const std::uint32_t i : pairs_of(object)) {
    Pair& pair = pairs_[i];
    if (!pair.bears) continue;
    const Vec3 a = world_law(pair.collider, t).state.velocity;
    const Vec3 b = world_law(pair.collidee, t).state.velocity;
    std::erase_if(pair.normals, [&](const Vec3& n) { return n.dot(a - b) > kRounding * (a.norm() + b.norm()); });
    pair.bears = !pair.normals.empty();
  }
}

void MotionWorld::settle(std::size_t a, std::size_t b, SimTime t) {
  release_parting(a, t);
  if (b != a) release_parting(b, t);
  Island island = island_of(a, b, t, Touching::kBearing, Quantity::kAcceleration);
  static_cast<void>(solve(island));  // what cannot be held is squeezed, and answered as that
  for (std::size_t i = 0; i < island.objects.size(); ++i) {
    const std::uint32_t index = island.objects[i];
    if (index == kNone) continue;
    Object& o = objects_[index];
    const bool borne = std::ranges::any_of(pairs_of(index), [&](std::uint32_t pair) { return pairs_[pair].bears; });
    if (!borne && !o.borne) continue;
    if (!o.borne) o.free = free_acceleration_of(index, t);
    o.borne = borne;
    const MotionModel law = world_law(index, t);
    const bool slides = law.kind == MotionKind::kSliding;
    Vec3 acceleration = island.bodies[i].value;
    if (acceleration.norm() <= kRounding * o.free.norm()) acceleration.setZero();  // all of it is borne
    if (acceleration == (slides ? Vec3(Vec3::Zero()) : law.state.acceleration)) continue;
    KinematicState after = law.state;
    after.acceleration = acceleration;
    const CollisionResponse* const response = model_.response_of(o.id);
    const bool impulse = response->type == ResponseType::kImpulse;
    const bool lies = acceleration.isZero(0.0);
    change_motion(index, t, impulse ? law_after(response, lies ? law : MotionModel{}, after) : MotionModel(after),
                  objects_[index == a ? b : a].id);
  }
}

void MotionWorld::lift(Pair& pair, SimTime t) {
  pair.contact.reset();
  pair.lifts = pair.bears = false;
  pair.lifted = t;
  pair.normals.clear();
  settle(pair.collider, pair.collidee, t);
}

// ---- advancing ----

// Of the pairs that are due until then: the one with the earliest contact, the first in the model's order of those.
std::optional<std::size_t> MotionWorld::first_contact_until(SimTime to) {
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
  return first;
}

void MotionWorld::advance(SimTime to) {
  std::size_t contacts = 0;
  for (auto first = first_contact_until(to); first; first = first_contact_until(to)) {
    Pair& pair = pairs_[*first];
    assert(*pair.contact <= to);
    if (++contacts <= kContactsMax) {
      respond_to_contact(pair);
    } else {
      if (contacts == kContactsMax + 1) ++counters_.capped;
      const SimTime t = *pair.contact;
      pair.contact.reset();
      if (pair.lifts) {
        pair.lifts = pair.bears = false;
      } else {
        stop(pair, t);
        pair.inside = true;
      }
      pair.clear_until = t + kOverlapRetry;
    }
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
  return world_at(index, t);
}

KinematicState MotionWorld::relative_at(ObjectId object, SimTime t) const {
  return objects_[index_of(object)].timeline.at(t);
}

KinematicState MotionWorld::in_carrier(ObjectId object, SimTime t, const KinematicState& world) const {
  const std::size_t index = index_of(object);
  return objects_[index].carrier == kNone ? world : relative_to(carrier_at(index, t), world);
}

KinematicState MotionWorld::in_world(ObjectId object, SimTime t, const KinematicState& relative) const {
  const std::size_t index = index_of(object);
  return objects_[index].carrier == kNone ? relative : composed(carrier_at(index, t), relative);
}

Vec3 MotionWorld::vector_in_carrier(ObjectId object, SimTime t, const Vec3& world) const {
  return in_frame_of_carrier(index_of(object), t, world);
}

Vec3 MotionWorld::vector_in_world(ObjectId object, SimTime t, const Vec3& relative) const {
  const std::size_t index = index_of(object);
  return objects_[index].carrier == kNone ? relative : Vec3(carrier_at(index, t).orientation * relative);
}

bool MotionWorld::is_carried(ObjectId object) const { return objects_[index_of(object)].carrier != kNone; }

bool MotionWorld::is_at_rest_from(ObjectId object, SimTime t) const {
  for (std::uint32_t i = static_cast<std::uint32_t>(index_of(object)); i != kNone; i = objects_[i].carrier) {
    const Timeline& timeline = objects_[i].timeline;
    if (!is_motionless(timeline.at(t)) || timeline.next_change_after(t)) return false;
  }
  return true;
}

bool MotionWorld::stands_in_carrier_from(ObjectId object, SimTime t) const {
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
