#include "replication/peer_parts.hpp"

#include <cassert>
#include <utility>

namespace peerd::replication {

PeerParts::PeerParts(PeerConfig peer_config, const WorldModel& world_model)
    : config(std::move(peer_config)),
      model(world_model),
      ticks(config.tick_hz),
      outbox(config.id, config.incarnation, counters),
      members(config.lost_after),
      admission(config, members, outbox),
      time(config, members, outbox, counters),
      greeter(config, members),
      owners(model->scene->instances.size()),
      own(*model->scene, config.owned, config.policy.surface_error),
      replica(model),
      scripted(model),
      launches(model, own, replica),
      display(config, model, own, replica, counters),
      regions(config, model, members, owners, own, replica, ticks, outbox, counters,
              [this](ObjectId object, bool received) {
                if (received) display.forget(object);
                watch_pairs_of(object);
              }),
      decisions(config, model, members, owners, own, replica, ticks, outbox, counters),
      publication(config, model, members, owners, own, launches, replica, regions, decisions, ticks, outbox, counters) {
  for (const auto& [object, each] : std::as_const(own)) owners.set(object, config.id);
  assert(own.size() <= owners.size());
}

void PeerParts::drop(PeerId sender, const char* reason) {
  ++counters.drops[reason];
  if (Member* member = members.find(sender)) ++member->drops[reason];
}

void PeerParts::extend_motions(SimTime t) {
  replica.set_world_zero(world_time.zero(), t);
  scripted.extend(t, world_time.zero(), owners, replica);
  launches.begin_due(t, [this](SimTime at, ObjectId object) { return file_velocity(at, object); });
}

bool PeerParts::let_move(std::span<const ObjectId> objects) {
  std::vector<ObjectId> owned;
  for (const auto& [object, owner] : owners) owned.push_back(object);
  auto next = extended(*model, objects, owned);
  if (next == nullptr) return false;
  replica.change_model(model, std::move(next));
  scripted.follow_model();
  ++counters.models_changed;
  return true;
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

}  // namespace peerd::replication
