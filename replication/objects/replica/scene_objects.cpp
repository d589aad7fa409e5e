#include "replication/objects/replica/scene_objects.hpp"

#include <algorithm>

#include "core/mixed_bits.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {

SceneObjects::SceneObjects(const ModelInForce& model) : model_(model) { (void)add_all({}, Owners()); }

std::vector<ObjectId> SceneObjects::add_all(SimTime since, const Owners& owners) {
  std::vector<ObjectId> added;
  for (const ModelNode& node : model_->nodes) {
    if (owners.of(node.object) != kNobody || !model_->answers(node.object)) continue;
    const auto [at, is_new] = all_.try_emplace(node.object);
    if (!is_new) continue;
    at->second.since = since;
    added.push_back(node.object);
  }
  return added;
}

std::vector<ObjectId> SceneObjects::follow_model(SimTime since, const Owners& owners) {
  std::vector<ObjectId> over;
  for (const auto& [object, each] : all_) {
    if (!model_->scene->contains(object)) over.push_back(object);
  }
  for (const ObjectId object : over) remove(object);
  return add_all(since, owners);
}

void SceneObjects::place(ObjectId object, SimTime at, const MotionModel& law, std::optional<ObjectId> carrier) {
  if (!is_moved(object)) return;
  SceneObject& known = this->at(object);
  ++known.sequence;
  known.freed = at;
  known.model = law;
  known.carrier = carrier;
}

bool SceneObjects::answers(const CollisionPair& pair, ObjectId object) const {
  assert(object == pair.collider || object == pair.collidee);
  return (object == pair.collider || pair.mutual) && contains(object);
}

SimTime SceneObjects::decided(ObjectId object) const {
  const auto known = all_.find(object);
  return known == all_.end() ? SimTime{} : known->second.decided;
}

void SceneObjects::remove(ObjectId object) {
  all_.erase(object);
  moved_.erase(object);
  differing_.erase(object);
  adopted_.erase(object);
  std::erase(left_, object);
}

void SceneObjects::note_moved(ObjectId object) {
  assert(contains(object));
  moved_.insert(object);
}

void SceneObjects::restart(SimTime now) {
  for (auto& [object, scene] : all_) scene.since = now;
}

void SceneObjects::restart_moved(SimTime now) {
  restart(now);
  differing_.clear();  // both worlds begin with one motion of each
  for (auto& [object, scene] : all_) scene.ghost_reset.reset();
  for (const ObjectId object : moved_) at(object).freed = now;
}

void SceneObjects::shift(Duration by) {
  for (auto& [object, scene] : all_) {
    if (scene.decided != SimTime{}) scene.decided += by;
    if (scene.freed != SimTime::min()) scene.freed += by;
  }
}

void SceneObjects::note_unmoved(ObjectId object) {
  const SceneObject& known = at(object);
  if (known.decided == SimTime{} && known.freed == SimTime::min()) moved_.erase(object);
}

bool SceneObjects::supersedes(const UpdateRecord& state, SimTime since) const {
  const SceneObject& known = at(state.object);
  if (state.decision != known.decided) return state.decision > known.decided;
  if (state.sequence != known.sequence) return state.sequence > known.sequence;
  return known.is_free && since < known.since;
}

std::vector<UpdateRecord> SceneObjects::states(const Owners& owners, const MotionWorld& truth, SimTime now) const {
  std::vector<UpdateRecord> states;
  for (const ObjectId object : moved_) {
    if (owners.of(object) != kNobody) continue;
    const SceneObject& scene = this->at(object);
    const SimTime at = truth.law_since(object, now);
    const UpdateRecord state{
        object, scene.sequence, at, truth.model_at(object, at), scene.decided, {}, model_->carrier_of(object)};
    if (acceptable(state.model.state) && within_limits(state.model)) states.push_back(state);
  }
  assert(states.size() <= moved_.size());
  return states;
}

std::uint64_t SceneObjects::digest(const Owners& owners, const MotionWorld& truth, SimTime at) const {
  std::uint64_t sum = 0;
  for (const ObjectId object : moved_) {
    if (owners.of(object) != kNobody) continue;
    const SimTime began = std::max(this->at(object).freed, truth.law_since(object, at));
    const auto ns = static_cast<std::uint64_t>(began.time_since_epoch().count());
    sum ^= mixed_bits(mixed_bits(object.packed() + 1) + ns) | 1;  // that of one object is not 0
  }
  return sum;
}

}  // namespace peerd::replication
