#include "peerd/view/frames/movers.hpp"

#include <algorithm>

#include "core/motion/carriers.hpp"
#include "core/motion/founder_objects.hpp"
#include "core/motion/predefined_motion.hpp"

namespace peerd::view {
namespace {

// `known`: those that a peer knows, ascending.
Movers with_what_moves(const Scene& scene, std::vector<ObjectId> known) {
  std::ranges::sort(known);
  known.erase(std::ranges::unique(known).begin(), known.end());
  const PredefinedMotion motion(scene);
  const Carriers carriers(scene, motion, known);
  Movers out;
  std::vector<std::uint32_t> number(scene.instances.size(), Movers::kNone);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const ObjectId id = scene.id_of(i);
    if (!carriers.contains(id)) continue;
    number[i] = static_cast<std::uint32_t>(out.ids.size());
    const auto above = carriers.above(id);
    out.ids.push_back(id);
    out.above.push_back(above ? number[scene.index_of(*above)] : Movers::kNone);
    out.of_peer.push_back(std::ranges::binary_search(known, id));
  }
  return out;
}

}  // namespace

Movers movers_of(const Scene& scene) {
  std::vector<ObjectId> known = founder_objects(scene);
  const auto add = [&](ObjectId id) {
    if (scene.at(id).kind == NodeKind::kTransform) known.push_back(id);
  };
  for (const CollisionInterest& interest : scene.interests) {
    for (const ObjectId id : interest.colliders.ends) add(id);
    for (const ObjectId id : interest.collidees.ends) add(id);
  }
  for (const KeySensor& sensor : scene.key_sensors) {
    if (sensor.recipient) add(*sensor.recipient);
  }
  return with_what_moves(scene, std::move(known));
}

Movers movers_of(const replication::Peer& peer, const Movers& before) {
  const Scene& scene = peer.scene();
  std::vector<ObjectId> known;
  for (const replication::ModelNode& node : peer.model().nodes) {
    if (node.is_carrier) known.push_back(node.object);
  }
  for (const ObjectId id : peer.model().owned) known.push_back(id);
  for (const auto& [id, owner] : peer.owners()) known.push_back(id);
  for (std::size_t i = 0; i < before.ids.size(); ++i) {
    if (before.of_peer[i] && scene.contains(before.ids[i])) known.push_back(before.ids[i]);
  }
  return with_what_moves(scene, std::move(known));
}

}  // namespace peerd::view
