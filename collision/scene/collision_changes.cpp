#include "collision/scene/collision_changes.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

namespace peerd::collision {

void CollisionChanges::add_object(ObjectId id, bool is_transform) {
  assert(objects_.empty() || objects_.back().id < id);
  objects_.push_back({.id = id, .is_transform = is_transform});
}

void CollisionChanges::add_interest(BroadIndex collider, BroadIndex collidee) {
  assert(collider != collidee && collider < objects_.size() && collidee < objects_.size());
  interests_.push_back({collider, collidee});
  is_colliding_.push_back(0);
}

void CollisionChanges::begin_tick() {
  began_.clear();
  ended_.clear();
  not_colliding_.clear();
}

bool CollisionChanges::set_colliding(std::uint32_t interest, bool colliding) {
  assert(interest < interests_.size());
  if (is_colliding(interest) == colliding) return false;
  is_colliding_[interest] = colliding;
  (colliding ? began_ : ended_).push_back(interest);
  for (const BroadIndex i : {interests_[interest].collider, interests_[interest].collidee}) {
    Object& object = objects_[i];
    assert(colliding || object.collisions > 0);
    object.collisions += colliding ? 1u : ~0u;
    if (!std::exchange(object.changed, true)) changed_objects_.push_back(i);
  }
  return true;
}

void CollisionChanges::refuse(std::uint32_t interest, const std::string& why) {
  assert(interest < interests_.size() && !why.empty());
  refusals_[interest] = why;
  refusals_changed_ = true;
}

void CollisionChanges::accept(std::uint32_t interest) { refusals_changed_ |= refusals_.erase(interest) > 0; }

const CollisionChanges::Tick& CollisionChanges::end_tick() {
  if (!began_.empty() || !ended_.empty()) {
    std::ranges::sort(began_);
    std::ranges::sort(ended_);
    merged_.clear();
    std::ranges::set_difference(colliding_, ended_, std::back_inserter(merged_));
    colliding_.clear();
    std::ranges::merge(merged_, began_, std::back_inserter(colliding_));
    assert(std::ranges::adjacent_find(colliding_) == colliding_.end());
  }
  std::ranges::sort(changed_objects_);
  for (const BroadIndex i : changed_objects_) {
    Object& object = objects_[i];
    object.changed = false;
    const bool colliding = object.collisions > 0;
    if (std::exchange(object.was_colliding, colliding) != colliding && object.is_transform) {
      not_colliding_.push_back({object.id, !colliding});
    }
  }
  changed_objects_.clear();
  if (std::exchange(refusals_changed_, false)) {
    refused_.clear();
    for (const auto& [interest, why] : refusals_) refused_.push_back({interest, why});
  }
  result_ = {colliding_, began_, ended_, not_colliding_, refused_};
  return result_;
}

}  // namespace peerd::collision
