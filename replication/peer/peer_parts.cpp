#include "replication/peer/peer_parts.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "core/mixed_bits.hpp"
#include "replication/physics/laws/response.hpp"

namespace peerd::replication {
namespace {

template <class T>
std::vector<T> without_doubles(std::vector<T> all) {
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  return all;
}

// The author of the operations of one life of a peer: of two that are not the same the numbers differ, but for one case
// in 2^31.
AuthorId author_of(PeerId peer, std::uint64_t incarnation) {
  const std::uint64_t bits = mixed_bits(mixed_bits(incarnation) + peer.value);
  return AuthorId{1 + static_cast<std::uint32_t>(bits % kAuthorMax)};
}

Writer writer_of(AuthorId author, const OperationLogs& logs, const PeerConfig& config, bool is_own) {
  if (config.signer == nullptr) return writer_without_key(author);
  const auto key = logs.key(author);
  return config.signer->writer(key.empty() && is_own ? config.signer->own_key() : key);
}

PeerConfig without_log(PeerConfig config) {
  config.log.parts = {};
  return config;
}

// Takes the logs that the configuration has. All of it has taken effect, whatever the clock says now: the scene that it
// makes is that which the peer begins with. Returns the stamp of the last operation; min(): there is none.
SimTime restore(const std::vector<OperationPart>& stored, OperationLogs& logs, LivingScene& living,
                ModelInForce& model) {
  for (const OperationPart& part : stored) {
    auto operations = logs.restore(part);
    assert(operations);  // who gives a peer a log has read it
    for (Operation& operation : *operations) living.add(std::move(operation));
  }
  SimTime last = SimTime::min();
  for (const LogLength& log : logs.lengths()) {
    assert(logs.whole(log.author) == log.bytes);
    last = std::max(last, logs.last_stamp(log.author));
  }
  if (const auto change = living.apply(SimTime::max(), SimTime::max()); change && change->scene) {
    model.replace(edited(*model, change->scene));
  }
  return last;
}

// The ones that the scene still has.
std::vector<OwnedObject> existing(const std::vector<OwnedObject>& objects, const Scene& scene) {
  std::vector<OwnedObject> all = objects;
  std::erase_if(all, [&](const OwnedObject& each) { return !scene.contains(each.object); });
  return all;
}

}  // namespace

PeerParts::PeerParts(PeerConfig peer_config, const WorldModel& world_model)
    : config(without_log(peer_config)),
      configured(world_model.owned),
      model(world_model),
      author(config.author.value_or(author_of(config.id, config.incarnation))),
      logs(author, config.signer),
      living(*world_model.scene, config.rare,
             OperationBodies([this](OperationId id) { return logs.operation(id).body; }),
             [this](AuthorId of) { return writer_of(of, logs, config, of == author); }),
      stored_until(restore(peer_config.log.parts, logs, living, model)),
      ticks(config.tick_hz),
      outbox(config.id, config.incarnation, counters),
      members(config.lost_after, config.large),
      limits(members, outbox, counters),
      admission(config, members, outbox, limits),
      time(config, members, outbox, counters, limits),
      greeter(config, members),
      exchange(logs, config.id, author, mixed_bits(author.value), {}, config.rare),
      own(model, existing(config.owned, *model->scene), config.policy.surface_error),
      scene(model),
      replica(model, config.detection.get()),
      scripted(model),
      launches(model, own, replica),
      display(config, model, own, replica, counters),
      sight(config, model, members, owners, own, scene, replica, [this](ObjectId object) { display.forget(object); }),
      regions(config, model, members, owners, own, replica, ticks, outbox, counters,
              [this](ObjectId object, bool received) {
                if (received) display.forget(object);
                watch_pairs_of(object);
              }),
      decisions(config, model, members, owners, scene, own, replica, display, ticks, outbox, counters,
                [this](ObjectId object, PeerId by, SimTime contact) { give_scene_object(object, by, contact); }),
      decision_check(model, members, owners, replica, ticks),
      ghost_check(config, members, owners, scene, own, replica, sight, regions, decisions, outbox, counters),
      publication(config, model, members, owners, own, launches, replica, regions, decisions, ticks, outbox, counters) {
  assert(std::ranges::is_sorted(configured));
  counters.scene_changes += model.revision();
  time.begin_behind(stored_until);
  for (const auto& [object, each] : std::as_const(own)) {
    owners.set(object, config.id);
    scene.remove(object);
  }
  for (const auto& [object, each] : std::map(scene.all())) {
    if (!is_scene_object(*model, object)) scene.remove(object);
  }
  for (const OwnedObject& each : config.owned) {
    if (!own.contains(each.object)) removed[each.object] = {.owner = config.id};  // by an operation of the store
  }
  assert(own.size() <= owners.size());
}

Pose PeerParts::place_by_scene(ObjectId object) const {
  const auto carrier = model->carrier_of(object);
  const KinematicState world = at_rest(model->scene->rigid_pose(object));
  return carrier ? relative_to(at_rest(model->scene->rigid_pose(*carrier)), world).pose() : world.pose();
}

void PeerParts::drop(PeerId sender, const char* reason) {
  ++counters.drops[reason];
  if (Member* member = members.find(sender)) ++member->drops[reason];
}

void PeerParts::extend_motions(SimTime t) {
  replica.set_world_zero(world_time.zero(), t);
  scripted.extend(t, world_time.zero(), owners, scene, replica);
  launches.begin_due(t, [this](SimTime at, ObjectId object) { return file_velocity(at, object); });
}

void PeerParts::advance_worlds(SimTime t) {
  extend_motions(t);
  replica.advance_truth(t);
  replica.advance_ghosts(t);
}

// The truth of a remote object may have gone another way at a contact with a third peer's. The owner, whose ghost
// stands where it believes the object, sends no update for up to a minute; what this peer moves would meet it where it
// is not.
void PeerParts::follow_resting_ghosts(SimTime t) {
  assert(replica.begun() && t <= reached());
  const SimTime instant = floor_to(t, std::chrono::milliseconds(500));
  if (std::exchange(resting_followed, instant) == instant) return;
  const SimTime settled = t - std::chrono::seconds(1) - 2 * members.longest_latency();
  MotionWorld& truth = replica.truth();
  const MotionWorld& ghosts = replica.ghosts();
  for (const auto& [object, owner] : owners) {
    if (own.contains(object) || scene.contains(object) || !replica.receives(object)) continue;
    if (!truth.has(object) || !ghosts.has(object) || !ghosts.is_at_rest_from(object, t)) continue;
    if (ghosts.law_since(object, t) > settled || truth.law_since(object, t) > settled) continue;
    const KinematicState stands = ghosts.relative_at(object, t), here = truth.relative_at(object, t);
    // A pushed object moves on in its owner's truth as in this one. Its ghost stands, as it is not wrong enough yet for
    // an update.
    if (truth.is_borne(object) && !is_motionless(here)) continue;
    if (is_motionless(here) && is_at_same_place(here, stands)) continue;
    const auto free = ghosts.is_borne(object) ? std::optional(ghosts.unborne_acceleration(object, t)) : std::nullopt;
    truth.set_base(object, t, stands, {}, free);
  }
}

bool PeerParts::let_move(std::span<const ObjectId> objects) {
  const auto is_owned = [&](ObjectId object) { return owners.of(object) != kNobody; };
  const auto needs = [&](ObjectId object) { return needs_carrier(*model, object, is_owned); };
  if (std::ranges::none_of(objects, needs)) return false;
  std::vector<ObjectId> moved(objects.begin(), objects.end());
  for (const auto& [object, owner] : owners) moved.push_back(object);
  auto next = extended(*model, moved);
  replica.change_model(*next);
  for (auto& [object, each] : own) {  // the samples of the models are in the frame before
    if (next->carrier_of(object) != model->carrier_of(object)) each.models.reset();
  }
  model.replace(std::move(next));
  scripted.follow_model();
  ++counters.models_changed;
  return true;
}

void PeerParts::change_scene(std::shared_ptr<const Scene> edited_scene, SimTime at, const std::set<ObjectId>& going_on,
                             std::span<const SetField> fields) {
  const std::shared_ptr<const WorldModel> next = edited(*model, std::move(edited_scene));
  forget_what_is_gone(*next->scene);
  const auto is_owned = [&](ObjectId object) { return owners.of(object) != kNobody; };
  const auto role_in_ghosts = [&](ObjectId object) {
    return is_owned(object) || is_scene_object(*next, object) ? Role::kPredicted : Role::kScene;
  };
  const auto role_in_truth = [&](ObjectId object) {
    const OwnObject* const each = std::as_const(own).find(object);
    if (each == nullptr) return role_in_ghosts(object);
    return each->driven ? Role::kDriven : Role::kAuthoritative;
  };
  std::map<ObjectId, Begin> begins, begins_of_scene;  // by the scene before, of own objects and of those of the scene
  for (const auto& [object, each] : std::as_const(own)) {
    if (!going_on.contains(object)) begins.emplace(object, begin_by_scene(object, fields));
  }
  for (const auto& [object, each] : scene.all()) begins_of_scene.emplace(object, begin_by_scene(object, fields));
  const auto placed = replica.change_scene(*next, at, is_owned, role_in_truth, role_in_ghosts);
  for (auto& [object, each] : own) {  // the samples of the models are in the frame before
    if (next->carrier_of(object) != model->carrier_of(object)) each.models.reset();
  }
  model.replace(next);
  own.follow_model();
  for (const auto& [object, law] : placed) {
    if (scene.contains(object)) scene.place(object, at, law, model->carrier_of(object));
  }
  for (const ObjectId object : follow_scene_objects(at)) {
    if (replica.begun()) replica.declare_remote(object, Role::kPredicted);
  }
  for (const ObjectId object : scripted.follow_scene(at, world_time.zero())) {
    if (next->scene->contains(object)) stand_by_scene(object, at);
  }
  regions.follow_model();
  for (const auto& [object, begin] : begins) begin_own_anew(object, at, begin);
  for (const auto& [object, begin] : begins_of_scene) {
    if (scene.contains(object)) give_velocity(object, at, begin);
  }
  ++counters.scene_changes;
}

bool PeerParts::is_scene_object(const WorldModel& of, ObjectId object) const {
  return of.answers(object) && !std::ranges::binary_search(configured, object) && !of.scene->object(object).enslaved;
}

std::vector<ObjectId> PeerParts::follow_scene_objects(SimTime since) {
  std::vector<ObjectId> added = scene.follow_model(since, owners);
  std::erase_if(added, [&](ObjectId object) {
    if (is_scene_object(*model, object)) return false;
    scene.remove(object);
    return true;
  });
  return added;
}

void PeerParts::forget_what_is_gone(const Scene& next) {
  std::vector<ObjectId> gone;
  for (std::uint32_t i = 0; i < model->scene->instances.size(); ++i) {
    if (const ObjectId id = model->scene->id_of(i); !next.contains(id)) gone.push_back(id);
  }
  for (const ObjectId object : gone) {
    if (const PeerId owner = owners.of(object); owner != kNobody) {
      removed[object] = {owner, owners.as_founder(object), scene.decided(object)};
    }
    owners.set(object, kNobody);
    scene.remove(object);
    launches.forget(object);
    display.forget(object);
    decisions.remove(object);
    left_behind.erase(object);
  }
  own.remove(gone);
}

PeerParts::Begin PeerParts::begin_by_scene(ObjectId object, std::span<const SetField> fields) const {
  const NodeId node = model->scene->document->ids.id_of(model->scene->at(object).node);
  const auto is_set = [&](std::string_view name) {
    return std::ranges::any_of(fields, [&](const SetField& set) { return set.node == node && set.field == name; });
  };
  return {place_by_scene(object), model->scene->object(object).velocity, is_set("translation") || is_set("rotation"),
          is_set("velocityVector")};
}

// An own object whose place or velocityVector an edit sets begins anew, as its fields say now: whoever puts a falling
// ball somewhere wants it there, and not its speed. An object that something drives goes its own way.
void PeerParts::begin_own_anew(ObjectId object, SimTime at, const Begin& before) {
  const Pose place = place_by_scene(object);
  const bool is_placed = before.place_is_set || place.position != before.place.position ||
                         place.orientation.coeffs() != before.place.orientation.coeffs();
  const bool is_pushed = before.velocity_is_set || model->scene->object(object).velocity != before.velocity;
  if ((!is_placed && !is_pushed) || own.at(object).driven || !replica.begun()) return;
  const Pose from = is_placed ? place : replica.truth().relative_at(object, at).pose();
  launches.begin_anew(at, object, from, file_velocity(at, object));
}

// The world itself moves the object no more.
void PeerParts::stand_by_scene(ObjectId object, SimTime at) {
  if (owners.of(object) != kNobody || scene.is_moved(object) || !replica.begun()) return;
  const MotionModel law(at_rest(place_by_scene(object)));
  for (MotionWorld* const in : {&replica.truth(), &replica.ghosts()}) {
    if (in->has(object)) in->set_base(object, at, law);
  }
}

// An edit sets the velocityVector of an object that nobody owns and a contact has moved. All peers know its law.
void PeerParts::give_velocity(ObjectId object, SimTime at, const Begin& before) {
  const bool is_pushed = before.velocity_is_set || model->scene->object(object).velocity != before.velocity;
  if (!is_pushed || owners.of(object) != kNobody || !scene.is_moved(object) || !replica.begun()) return;
  MotionWorld& truth = replica.truth();
  KinematicState state = truth.relative_at(object, at);
  state.velocity = truth.vector_in_carrier(object, at, file_velocity(at, object));
  const MotionModel law = law_after(model->response_of(object), truth.model_at(object, at), state);
  truth.set_base(object, at, law);
  replica.ghosts().set_base(object, at, law);
  scene.place(object, at, law, model->carrier_of(object));
}

// An object of this peer that has fallen out of the world comes back, where the world's file says below which height.
void PeerParts::return_fallen(SimTime t) {
  for (const ObjectId object : launches.fallen(t)) {
    launches.begin_anew(t, object, place_by_scene(object), file_velocity(t, object));
  }
}

Vec3 PeerParts::file_velocity(SimTime at, ObjectId object) {
  return velocity_in_world(at, object, model->scene->object(object).velocity);
}

Vec3 PeerParts::velocity_in_world(SimTime at, ObjectId object, const Vec3& in_parent) {
  const ModelNode* const node = model->node(object);
  if (node == nullptr || node->carrier == ModelNode::kNone || !replica.begun()) {
    return scripted.to_world(at, world_time.zero(), object, in_parent);
  }
  // The carrier stands above the parent, and nothing between them moves.
  const Quat of_carrier = model->scene->rigid_pose(model->nodes[node->carrier].object).orientation;
  return replica.truth().vector_in_world(object, at,
                                         of_carrier.conjugate() * model->scene->to_world(object, in_parent));
}

// These objects have an owner from now on: that matters to their pairs, and to those of what they are paired with.
void PeerParts::watch_pairs_around(std::span<const ObjectId> objects) {
  if (regions.cuts()) {
    // Interests in what they carry, or in what carries them, matter, too.
    std::vector<std::uint32_t> moved;
    for (const ObjectId object : objects) {
      std::ranges::copy(model->pairs_of(object), std::back_inserter(moved));
      if (model->node(object) == nullptr) continue;
      for (const std::uint32_t k : model->part_pairs_moved_by(model->index_of(object))) {
        moved.push_back(model->part_pairs[k].pair);
      }
    }
    regions.measure_contact_ranges(PairNumbers(without_doubles(std::move(moved))), false);
  }
  decisions.watch().follow_owners_of(objects);
}

void PeerParts::give_scene_object(ObjectId object, PeerId owner, SimTime decided) {
  assert(owner != kNobody && scene.contains(object));
  const bool is_here = owner == config.id || members.contains(owner);
  const PeerId before = owners.of(object);
  SceneObject& known = scene.at(object);
  known.decided = decided;
  known.decided_by = owner;
  known.is_free = !is_here;  // its owner is gone already: it goes on by the decision
  known.sequence = 1;
  known.freed = SimTime::min();
  scene.note_moved(object);
  scene.differing().erase(object);
  set_owner_of_scene_object(object, is_here ? owner : kNobody, before);
}

void PeerParts::set_owner_of_scene_object(ObjectId object, PeerId owner, PeerId before) {
  assert(before == owners.of(object));
  if (owner == before) return;
  replica.compute_ghost(object);
  if (before == config.id) {
    launches.forget(object);
    regions.forget_handovers_of(object);
    own.remove({&object, 1});
    scene.adopted().erase(object);
  }
  owners.set(object, owner);
  // Its updates go to a region that this peer listens to.
  const bool is_near =
      replica.begun() && regions.interest().receives(replica.ghost(object, ticks.last_time()).position);
  if (owner == config.id) {
    own.adopt(object);
    scene.adopted().insert(object);
    // The decision has said how it moves; to a peer that hears of some regions only, an update says where.
    if (!regions.cuts()) own.at(object).last_sent = ticks.last_time();
  } else if (owner != kNobody && !is_near) {
    regions.on_claimed(object, ticks.last_time());
  }
  if (owner == config.id || owner == kNobody) regions.on_known_everywhere(object);
  if (replica.begun()) {
    replica.declare_remote(object, Role::kPredicted);
    if (owner == config.id) replica.truth().declare(object, Role::kAuthoritative);
  }
  watch_pairs_around({&object, 1});
}

}  // namespace peerd::replication
