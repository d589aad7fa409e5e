#include "replication/replica/replica.hpp"

#include "replication/parts/contact_polygons.hpp"

namespace peerd::replication {

KinematicState Replica::ghost(ObjectId object, SimTime t) const {
  return ghosts().has(object) ? ghosts().at(object, t) : at_rest(model_->scene->rigid_pose(object));
}

KinematicState Replica::truth(ObjectId object, SimTime t) const {
  return truth().has(object) ? truth().at(object, t) : ghost(object, t);
}

void Replica::name_polygons(ContactEvent& contact, bool of_truth) const {
  contact.polygons = touched_polygons(*model_, of_truth ? truth() : ghosts(), flexible_.get(), contact);
}

Vec3 Replica::position_of(const UpdateRecord& update) {
  if (!update.carrier) return update.model.state.position;
  compute_ghost(*update.carrier);
  return composed(ghost(*update.carrier, update.at), update.model.state).position;
}

void Replica::change_model(const WorldModel& next) {
  compute_all();
  if (flexible_ != nullptr) {  // the numbers of the parts change
    flexible_ = std::make_unique<FlexibleParts>(next, flexible_->world_zero());
  }
  if (begun()) {
    for (MotionWorld* world : {&worlds_->truth, &worlds_->ghosts}) {
      if (flexible_ != nullptr) world->set_flexible(*flexible_);
      world->change_model(next);
    }
  }
}

MotionModel Replica::in_own_frame(const UpdateRecord& update) {
  if (model_->carrier_of(update.object) == update.carrier || !ghosts().has(update.object)) return update.model;
  compute_ghost(update.object);
  if (update.carrier) compute_ghost(*update.carrier);
  const KinematicState& state = update.model.state;
  const KinematicState world = update.carrier ? composed(ghost(*update.carrier, update.at), state) : state;
  return ghosts().in_carrier(update.object, update.at, world);
}

void Replica::set_ghost(ObjectId object, SimTime t, const MotionModel& model, bool owned) {
  note_change_ahead(object);
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
  compute_ghost(object);
  note_change_ahead(object);
  colliding_.wake(object);  // it is where the other world has it from now on
  if (truth().has(object)) truth().declare(object, role);
  ghosts().declare(object, role);
}

const UpdateRecord* Replica::last_update_of(ObjectId object) const {
  const auto at = last_updates_.find(object);
  return at == last_updates_.end() ? nullptr : &at->second;
}

}  // namespace peerd::replication
