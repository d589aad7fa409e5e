#include "replication/physics/world/moving_objects.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "replication/physics/laws/composed_motion.hpp"
#include "replication/physics/world/part_contact.hpp"

namespace peerd::replication {
namespace {

// Timelines keep what is older for this much longer at most, or for as long again where that is less: a driven object
// gets a segment at each tick, and to forget them one by one would cost more than everything else.
constexpr Duration kPruneWithin = std::chrono::seconds(2);
// The objects' turns to be pruned within that time, so that one tick does not prune all of them.
constexpr std::int64_t kPruningSlots = 128;

}  // namespace

MovingObjects::MovingObjects(const WorldModel& model, SimTime start)
    : model_(&model), start_(start), objects_(model.nodes.size(), false), roles_(model.nodes.size(), Role::kScene) {}

KinematicState MovingObjects::state_in_file(const ModelNode& node) const {
  KinematicState state = at_rest(model_->scene->rigid_pose(node.object));
  if (node.carrier == kNone) return state;
  return relative_to(at_rest(model_->scene->rigid_pose(model_->nodes[node.carrier].object)), state);
}

MovingObject MovingObjects::made(const ModelNode& node, Role role) const {
  return {.id = node.object,
          .role = role,
          .timeline = Timeline(start_, state_in_file(node)),
          .base_time = start_,
          .given_time = start_,
          .answers = model_->answers(node.object),
          .carrier = node.carrier,
          .bound = {}};
}

MovingObject& MovingObjects::make(std::size_t node) const {
  assert(node < model_->nodes.size());
  return objects_.add(node, made(model_->nodes[node], roles_[node]));
}

void MovingObjects::add(ObjectId object) {
  assert(!contains(object));
  declared_.set(object, static_cast<std::uint32_t>(objects_.size()));
  objects_.push_back(made({object}, Role::kScene));
  roles_.push_back(Role::kScene);
}

bool MovingObjects::has_never_moved(std::size_t node) const {
  const MovingObject* const o = peek(node);
  if (o == nullptr) return true;
  assert(o->carrier == model_->nodes[node].carrier);
  const Timeline::Segment& law = o->timeline.segment(0);
  const bool is_first = o->revision == 0 && o->timeline.segment_count() == 1 && law.from == start_ && !law.cause;
  return is_first && is_motionless(law.model.state);
}

Vec3 MovingObjects::first_position(std::size_t node) const {
  assert(has_never_moved(node));
  const MovingObject* const o = peek(node);
  return o == nullptr ? state_in_file(model_->nodes[node]).position : o->timeline.segment(0).model.state.position;
}

std::vector<std::uint32_t> MovingObjects::asked_for() const {
  const auto numbers = objects_.numbers();
  std::vector<std::uint32_t> ascending(numbers.begin(), numbers.end());
  std::ranges::sort(ascending);
  return ascending;
}

std::optional<ObjectId> MovingObjects::carrier_of(std::size_t index) const {
  const std::uint32_t carrier = index < model_->nodes.size() ? model_->nodes[index].carrier : kNone;
  return carrier == kNone ? std::nullopt : std::optional(model_->nodes[carrier].object);
}

void MovingObjects::set_role(std::size_t index, Role role) {
  assert(index < size() && roles_.size() == size());
  roles_[index] = role;
  MovingObject* const o = objects_.find(index);
  if (o == nullptr) return;
  o->role = role;
  if (role == Role::kScene || role == Role::kPredicted) o->free_is_given = false;  // its owner publishes it
}

void MovingObjects::change_model(const WorldModel& next, SimTime now) {
  assert(next.scene == model_->scene);
  const MovingObjects before = std::exchange(*this, MovingObjects(next, start_));
  flexible_ = before.flexible_;
  driven_history_ = before.driven_history_;
  std::map<ObjectId, Pose> moved;  // new carriers that have left their places in the file
  for (const std::uint32_t i : before.asked_for()) {
    const ObjectId id = before.id_of(i);
    if (next.is_carrier(id) && !before.model_->is_carrier(id)) moved[id] = before[i].timeline.at(now).pose();
  }
  const auto pose_in = [&](std::optional<ObjectId> outer, ObjectId id) {
    if (const auto at = moved.find(id); at != moved.end()) return at->second;
    const KinematicState frame = outer ? at_rest(next.scene->rigid_pose(*outer)) : KinematicState{};
    return relative_to(frame, at_rest(next.scene->rigid_pose(id))).pose();
  };
  for (std::uint32_t i = 0; i < before.size(); ++i) {
    const ObjectId id = before.id_of(i);
    if (!contains(id)) add(id);  // nothing needs it: it meets nothing
    const std::size_t index = index_of(id);
    set_role(index, before.roles_[i]);
    const auto from = before.carrier_of(i), to = carrier_of(index);
    if (before.peek(i) == nullptr && from == to) continue;
    MovingObject& o = (*this)[index];
    continue_as(o, before[i]);
    if (from != to) {
      assert(to && "there are more carriers, so the nearest one is nearer");
      const Pose frame = pose_in(from, *to);
      o.timeline.change_frame(frame);
      for (Base& base : o.bases) {
        if (base.model) base.model = in_frame(frame, *base.model);
      }
    }
  }
  assert(size() >= next.nodes.size() && size() >= before.size());
  for (const std::uint32_t i : asked_for()) timeline_changed(i);
}

void MovingObjects::continue_as(MovingObject& o, const MovingObject& before) const {
  const std::uint32_t carrier = o.carrier;
  const bool answers = o.answers;
  o = before;
  o.carrier = carrier;
  o.answers = answers;
  o.pruning_scheduled = o.changed = false;
}

std::vector<MovingObjects::Placed> MovingObjects::change_scene(const WorldModel& next, const SceneChange& change) {
  const MovingObjects before = std::exchange(*this, MovingObjects(next, start_));
  flexible_ = before.flexible_;
  driven_history_ = before.driven_history_;
  const Scene &scene_before = *before.model_->scene, &scene = *next.scene;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const ObjectId id = before.id_of(i);
    if (scene.contains(id) && !contains(id)) add(id);  // nothing needs it: it meets nothing
  }
  const auto is_same_pose = [](const KinematicState& a, const KinematicState& b) {
    return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
  };
  const auto place_in_file = [](const Scene& of, std::optional<ObjectId> carrier, ObjectId id) {
    const KinematicState world = at_rest(of.rigid_pose(id));
    return carrier ? relative_to(at_rest(of.rigid_pose(*carrier)), world) : world;
  };
  std::vector<Placed> placed;
  for (std::uint32_t i = 0; i < size(); ++i) {  // carriers come before what they carry
    const ObjectId id = id_of(i);
    const std::optional<ObjectId> carrier = carrier_of(i);
    const KinematicState in_file = place_in_file(scene, carrier, id);
    const bool was_there = scene_before.contains(id) && (!carrier || scene_before.contains(*carrier));
    const bool stays = was_there && is_same_pose(place_in_file(scene_before, carrier, id), in_file);
    if (!before.contains(id)) {
      set_role(i, change.role_of(id));
      if (!stays) (*this)[i].timeline = Timeline(change.at, in_file);
      continue;
    }
    const std::size_t k = before.index_of(id);
    set_role(i, before.roles_[k]);
    const bool same_frame = before.carrier_of(k) == carrier;
    if (before.peek(k) == nullptr && same_frame && stays) continue;
    const MovingObject& old = before[k];
    MovingObject& o = (*this)[i];
    Timeline fresh = stays ? o.timeline : Timeline(change.at, in_file);
    continue_as(o, old);
    if (!same_frame) o.bases.clear();
    const bool is_moved = change.is_moved(id);
    if (same_frame) {
      if (!stays && !is_moved) placed.push_back({id, in_file});
      continue;
    }
    MotionModel law = in_file;
    if (is_moved) {
      const KinematicState world = before.world_at(k, change.at);
      law = MotionModel(carrier ? relative_to(world_at(o.carrier, change.at), world) : world);
      fresh = Timeline(change.at, law);
    }
    o.timeline = std::move(fresh);
    placed.push_back({id, law});
  }
  for (const std::uint32_t i : asked_for()) timeline_changed(i);
  return placed;
}

std::span<const std::uint32_t> MovingObjects::carried_by(std::size_t object) const {
  if (object >= model_->carried_by.size()) return {};
  return model_->carried_by[object];
}

MovingObjects::OwnChain MovingObjects::chain_of(std::uint32_t object, std::uint32_t common) const {
  OwnChain chain;
  for (std::uint32_t i = object; i != kNone && i != common; i = (*this)[i].carrier) {
    chain.insert(chain.begin(), &(*this)[i].timeline);
  }
  return chain;
}

KinematicState MovingObjects::world_at(std::size_t object, SimTime t) const {
  const MovingObject& o = (*this)[object];
  if (o.carrier == kNone) return o.timeline.at(t);
  const OwnChain chain = chain_of(static_cast<std::uint32_t>(object));
  return composed_at({chain.data(), chain.size()}, t);
}

KinematicState MovingObjects::carrier_at(std::size_t object, SimTime t) const {
  assert((*this)[object].carrier != kNone);
  return world_at((*this)[object].carrier, t);
}

Vec3 MovingObjects::in_frame_of_carrier(std::size_t object, SimTime t, const Vec3& world) const {
  if ((*this)[object].carrier == kNone) return world;
  return carrier_at(object, t).orientation.conjugate() * world;
}

MotionModel MovingObjects::world_law(std::size_t object, SimTime t) const {
  const MovingObject& o = (*this)[object];
  return o.carrier == kNone ? o.timeline.model_at(t) : MotionModel(world_at(object, t));
}

Vec3 MovingObjects::free_acceleration_of(std::size_t index, SimTime t) const {
  const MovingObject& o = (*this)[index];
  if (o.borne || (o.free_is_given && o.role == Role::kAuthoritative)) return o.free;
  const MotionModel law = world_law(index, t);
  return law.kind == MotionKind::kSliding ? Vec3(Vec3::Zero()) : law.state.acceleration;
}

bool MovingObjects::is_in_side(std::size_t object, std::size_t end, std::uint32_t part) const {
  assert(end < model_->nodes.size());
  if (object == end) return true;
  if (part != kNone) part = model_->frame_of(part);
  if (part != kNone && object == part) return true;
  const auto carries = carried_by(object);
  const auto is_carried = [&](std::size_t node) {
    return std::ranges::binary_search(carries, static_cast<std::uint32_t>(node));
  };
  if (part != kNone) return is_carried(part);
  return is_carried(end) || std::ranges::binary_search(carried_by(end), static_cast<std::uint32_t>(object));
}

bool MovingObjects::is_lived(std::size_t end) const {
  for (auto i = static_cast<std::uint32_t>(end); i != kNone; i = (*this)[i].carrier) {
    if ((*this)[i].role == Role::kAuthoritative || (*this)[i].role == Role::kDriven) return true;
  }
  return false;
}

SimTime MovingObjects::known_since(std::size_t end) const {
  SimTime known = (*this)[end].timeline.begin();
  for (std::uint32_t i = (*this)[end].carrier; i != kNone; i = (*this)[i].carrier) {
    known = std::max(known, (*this)[i].timeline.begin());
  }
  return known;
}

const SweptBound& MovingObjects::bound_of(std::size_t object, SimTime s) {
  MovingObject& o = (*this)[object];
  if (!o.bound.answers_for(s)) o.bound = make_bound(static_cast<std::uint32_t>(object), kNone, s);
  return o.bound;
}

MovingPart MovingObjects::moving_part(std::uint32_t part, const OwnChain& chain) const {
  assert(part < model_->nodes.size() + model_->flexible.size());
  if (!model_->is_flexible(part)) return {{chain.data(), chain.size()}, &body(part)};
  return {{chain.data(), chain.size()}, nullptr, flexible_, part - static_cast<std::uint32_t>(model_->nodes.size())};
}

SweptBound MovingObjects::make_bound(std::uint32_t part, std::uint32_t common, SimTime s) const {
  const SimTime begin = floor_to(s, kLookahead), end = begin + kLookahead;
  const OwnChain chain = chain_of(model_->frame_of(part), common);
  const MovingPart moving = moving_part(part, chain);
  if (moving.flexible != nullptr || chain.empty()) return swept_bound_of_way(moving, s, end);
  assert(moving.body != nullptr);
  if (chain.size() == 1) return swept_bound(*chain.front(), body(part), s, begin, end);
  const ComposedPiece piece = composed_piece(moving.chain, s, moving.body->extent_m(), kCoarseError_m);
  return swept_bound(piece, body(part), s, begin, end);
}

SweptBound MovingObjects::bound_of_end(std::size_t end, SimTime s) {
  assert(end < model_->parts_of_node.size() && !model_->parts_of_node[end].empty());
  SweptBound all;
  bool first = true;
  for (const std::uint32_t part : model_->parts_of_node[end]) {
    const SweptBound bound = as_box(model_->is_flexible(part) ? make_bound(part, kNone, s) : bound_of(part, s));
    all = first ? bound : merged(all, bound);
    first = false;
  }
  return all;
}

Duration MovingObjects::history_of(const MovingObject& o) const {
  return o.role == Role::kDriven ? driven_history_.value_or(kHistory) : kHistory;
}

void MovingObjects::note_change(std::size_t index) {
  if (std::exchange((*this)[index].changed, true)) return;
  changed_.push_back(static_cast<std::uint32_t>(index));
}

// Called after any change of the object's timeline.
void MovingObjects::timeline_changed(std::size_t index) {
  note_change(index);
  for (const std::uint32_t carried : carried_by(index)) {
    note_change(carried);
    (*this)[carried].bound.until = SimTime::min();
  }
  schedule_pruning(index);
}

void MovingObjects::schedule_pruning(std::size_t index) {
  MovingObject& o = (*this)[index];
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

void MovingObjects::prune_timelines(SimTime advanced) {
  while (!prunings_.empty() && prunings_.front().at <= advanced) {
    const Pruning due = prunings_.front();
    std::ranges::pop_heap(prunings_, std::greater{});
    prunings_.pop_back();
    MovingObject& o = (*this)[due.object];
    o.pruning_scheduled = false;
    o.timeline.forget_before(advanced - history_of(o));
    schedule_pruning(due.object);
  }
}

}  // namespace peerd::replication
