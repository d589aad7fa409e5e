#include "replication/objects/replica/launches.hpp"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>
#include <vector>

#include "replication/physics/laws/response.hpp"

namespace peerd::replication {
namespace {

void note(OwnObject& own, const VelocityChange& change) {
  if (own.velocity_changes.size() == VelocityChange::kKept) own.velocity_changes.erase(own.velocity_changes.begin());
  own.velocity_changes.push_back(change);
}

}  // namespace

void Launches::shift(Duration by) {
  for (auto& [object, at] : scheduled_) at += by;
}

void Launches::launch(SimTime t, ObjectId object, const FileVelocity& file_velocity) {
  assert(!own_.at(object).driven);
  const Launch& launch = own_.at(object).launch;
  const MotionWorld& truth = replica_.truth();
  KinematicState state = truth.relative_at(object, t);
  const Vec3 before = state.velocity;
  state.velocity = truth.vector_in_carrier(object, t, launch.velocity ? *launch.velocity : file_velocity(t, object));
  const Vec3 acceleration = launch.acceleration.value_or(model_->gravity_of(object));
  state.acceleration = truth.vector_in_carrier(object, t, acceleration);
  state.angular_velocity_body = truth.at(object, t).orientation.conjugate() * launch.angular_velocity;
  replica_.truth().set_free_acceleration(object, acceleration);
  own_.at(object).driven_since = t;
  note(own_.at(object), {t, before, state.velocity});
  replica_.truth().set_base(object, t, law_after(model_->response_of(object), MotionModel{}, state));
}

void Launches::begin_due(SimTime until, const FileVelocity& file_velocity) {
  std::vector<std::pair<SimTime, ObjectId>> due;
  for (const auto& [object, at] : scheduled_) {
    if (at <= until) due.emplace_back(at, object);
  }
  std::ranges::sort(due);
  std::optional<SimTime> advanced;
  for (const auto& [at, object] : due) {
    // Once for each instant: what is launched together moves together, also where it touches.
    if (at != advanced) replica_.advance_truth(at);
    advanced = at;
    launch(at, object, file_velocity);
    unpublished_[object] = at;
    scheduled_.erase(object);
  }
}

void Launches::change_velocity(SimTime t, ObjectId object, const Vec3& velocity, bool absolute) {
  assert(own_.contains(object) && !own_.at(object).driven);
  const MotionModel law = replica_.truth().model_at(object, t);
  KinematicState state = law.state;
  const Vec3 relative = replica_.truth().vector_in_carrier(object, t, velocity);
  state.velocity = absolute ? relative : Vec3(state.velocity + relative);
  note(own_.at(object), {t, law.state.velocity, state.velocity, absolute});
  replica_.truth().set_base(object, t, law_after(model_->response_of(object), law, state));
  scheduled_.erase(object);
  unpublished_[object] = t;
}

void Launches::let_go(SimTime t, ObjectId object, const KinematicState& world) {
  assert(own_.contains(object) && !own_.at(object).driven);
  MotionWorld& truth = replica_.truth();
  KinematicState state = truth.in_carrier(object, t, world);
  assert(state.position.allFinite() && state.velocity.allFinite());
  const Vec3 free = truth.free_acceleration(object).value_or(model_->gravity_of(object));
  state.acceleration = truth.vector_in_carrier(object, t, free);
  own_.at(object).driven_since = t;
  note(own_.at(object), {t, truth.relative_at(object, t).velocity, state.velocity});
  truth.set_base(object, t, law_after(model_->response_of(object), MotionModel{}, state));
  scheduled_.erase(object);
  unpublished_[object] = t;
}

void Launches::begin_anew(SimTime t, ObjectId object, const Pose& place, const Vec3& velocity) {
  assert(own_.contains(object) && !own_.at(object).driven);
  MotionWorld& truth = replica_.truth();
  KinematicState state = at_rest(place);
  if (scheduled_.contains(object)) {
    truth.set_base(object, t, state);
    own_.republish(object);
    return;
  }
  const Vec3 free = truth.free_acceleration(object).value_or(truth.unborne_acceleration(object, t));
  state.velocity = truth.vector_in_carrier(object, t, velocity);
  state.acceleration = truth.vector_in_carrier(object, t, free);
  note(own_.at(object), {t, truth.relative_at(object, t).velocity, state.velocity, true});
  truth.set_base(object, t, law_after(model_->response_of(object), MotionModel{}, state));
  unpublished_[object] = t;
}

std::vector<ObjectId> Launches::fallen(SimTime t) {
  std::vector<ObjectId> fallen;
  if (!model_->laws.return_below) return fallen;
  const SimTime instant = floor_to(t, std::chrono::milliseconds(500));
  if (std::exchange(looked_for_fallen_, instant) == instant) return fallen;
  for (const auto& [object, each] : std::as_const(own_)) {
    if (each.driven) continue;
    if (replica_.truth().at(object, t).position.y() < *model_->laws.return_below) fallen.push_back(object);
  }
  return fallen;
}

void Launches::forget(ObjectId object) {
  scheduled_.erase(object);
  unpublished_.erase(object);
}

}  // namespace peerd::replication
