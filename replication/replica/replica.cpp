#include "replication/replica/replica.hpp"

namespace peerd::replication {

KinematicState Replica::ghost(ObjectId object, SimTime t) const {
  return ghosts().has(object) ? ghosts().at(object, t) : at_rest(model_->scene->rigid_pose(object));
}

KinematicState Replica::truth(ObjectId object, SimTime t) const {
  return truth().has(object) ? truth().at(object, t) : ghost(object, t);
}

Vec3 Replica::position_of(const UpdateRecord& update) const {
  if (!ghosts().has(update.object)) return update.model.state.position;
  return ghosts().in_world(update.object, update.at, update.model.state).position;
}

void Replica::set_ghost(ObjectId object, SimTime t, const MotionModel& model, bool owned) {
  ghosts().set_base(object, t, model);
  if (!owned && truth().has(object)) truth().set_base(object, t, model);
}

void Replica::note_changes() {
  const auto note = [this](ObjectId object) {
    colliding_.wake(object);
    changed_.push_back(object);
  };
  truth().take_changed(note);
  ghosts().take_changed(note);
}

void Replica::declare_remote(ObjectId object, Role role) {
  colliding_.wake(object);  // it is where the other world has it from now on
  if (truth().has(object)) truth().declare(object, role);
  ghosts().declare(object, role);
}

const UpdateRecord* Replica::last_update_of(ObjectId object) const {
  const auto at = last_updates_.find(object);
  return at == last_updates_.end() ? nullptr : &at->second;
}

}  // namespace peerd::replication
