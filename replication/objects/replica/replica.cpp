#include "replication/objects/replica/replica.hpp"

#include <algorithm>

#include "replication/physics/parts/contact_polygons.hpp"

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

// The numbers of the parts change.
void Replica::renew_flexible(const WorldModel& next) {
  if (flexible_ == nullptr && next.flexible.empty()) return;
  const std::optional<SimTime> zero = flexible_ ? flexible_->world_zero() : std::nullopt;
  flexible_ = std::make_unique<FlexibleParts>(next, zero);
  if (!begun()) return;
  worlds_->truth.set_flexible(*flexible_);
  worlds_->ghosts.set_flexible(*flexible_);
}

void Replica::change_model(const WorldModel& next) {
  compute_all();
  renew_flexible(next);
  if (!begun()) return;
  worlds_->truth.change_model(next);
  worlds_->ghosts.change_model(next);
}

std::vector<MovingObjects::Placed> Replica::change_scene(const WorldModel& next, SimTime at,
                                                         const std::function<bool(ObjectId)>& is_moved,
                                                         const RoleOf& role_in_truth, const RoleOf& role_in_ghosts) {
  compute_all();
  renew_flexible(next);
  std::erase_if(last_updates_, [&](const auto& update) { return !next.scene->contains(update.first); });
  std::erase_if(kept_updates_, [&](const auto& updates) { return !next.scene->contains(updates.first); });
  for (std::uint32_t i = 0; i < model_->scene->instances.size(); ++i) {
    if (const ObjectId id = model_->scene->id_of(i); !next.scene->contains(id)) unreceived_.set(id, false);
  }
  std::erase_if(changed_, [&](ObjectId object) { return !next.scene->contains(object); });
  colliding_.change_scene(next, at);
  if (!begun()) return {};
  (void)worlds_->ghosts.change_scene(next, {at, is_moved, role_in_ghosts});
  return worlds_->truth.change_scene(next, {at, is_moved, role_in_truth});
}

Base Replica::base_of(const UpdateRecord& update) {
  Base base{update.at, update.model};
  if (update.drive) {
    const Vec3& free = update.drive->acceleration;
    base.free = update.carrier ? Vec3(ghost(*update.carrier, update.at).orientation * free) : free;
  }
  if (model_->carrier_of(update.object) == update.carrier || !ghosts().has(update.object)) return base;
  compute_ghost(update.object);
  if (update.carrier) compute_ghost(*update.carrier);
  const KinematicState& state = update.model.state;
  const KinematicState world = update.carrier ? composed(ghost(*update.carrier, update.at), state) : state;
  base.model = ghosts().in_carrier(update.object, update.at, world);
  return base;
}

void Replica::set_ghost(ObjectId object, SimTime t, const std::optional<MotionModel>& model, bool owned,
                        const std::optional<Rest>& rest, const std::optional<Vec3>& free) {
  note_change_ahead(object);
  ghosts().set_base(object, t, model, rest, free);
  if (!owned && truth().has(object)) truth().set_base(object, t, model, rest, free);
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
  if (!receives(object) && !ghosts().has(object)) return;
  compute_ghost(object);
  note_change_ahead(object);
  colliding_.wake(object);  // it is where the other world has it from now on
  if (truth().has(object)) truth().declare(object, role);
  ghosts().declare(object, role);
}

// A later update of an earlier time makes those after that void.
void Replica::keep_update(const UpdateRecord& update) {
  if (model_->pairs_of(update.object).empty()) return;
  std::vector<UpdateRecord>& kept = kept_updates_[update.object];
  forget_kept(kept, update.at, update.at);
  kept.push_back(update);
}

// Laying an overtaken update costs as much as laying all later ones. A jitter of some ticks lets a few overtake it.
constexpr std::ptrdiff_t kOvertakenBy = 8;

bool Replica::keep_overtaken(const UpdateRecord& update) {
  const auto at = kept_updates_.find(update.object);
  if (at == kept_updates_.end() || at->second.empty()) return false;
  std::vector<UpdateRecord>& kept = at->second;
  assert(kept.front().at <= kept.back().at);
  const auto later = std::ranges::upper_bound(kept, update.at, {}, &UpdateRecord::at);
  if (kept.end() - later > kOvertakenBy) return false;
  if (later != kept.begin() && std::prev(later)->sequence >= update.sequence) return false;
  const auto is_not_void = [&](const UpdateRecord& each) { return each.sequence >= update.sequence; };
  const auto next = std::find_if(later, kept.end(), is_not_void);
  if (next != kept.end() && next->sequence == update.sequence) return false;
  const auto first = std::ranges::lower_bound(kept, update.at, {}, &UpdateRecord::at);
  kept.insert(kept.erase(first, next), update);
  return true;
}

std::span<const UpdateRecord> Replica::kept_updates(ObjectId object) const {
  const auto at = kept_updates_.find(object);
  return at == kept_updates_.end() ? std::span<const UpdateRecord>{} : std::span<const UpdateRecord>(at->second);
}

const UpdateRecord* Replica::last_update_of(ObjectId object) const {
  const auto at = last_updates_.find(object);
  return at == last_updates_.end() ? nullptr : &at->second;
}

}  // namespace peerd::replication
