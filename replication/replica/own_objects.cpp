#include "replication/replica/own_objects.hpp"

#include <algorithm>
#include <cassert>

#include "core/scene/bounding_radius.hpp"

namespace peerd::replication {

OwnObjects::OwnObjects(const ModelInForce& model, std::span<const OwnedObject> objects, bool surface_error)
    : model_(model), surface_error_(surface_error) {
  add(objects);
}

void OwnObjects::add(std::span<const OwnedObject> objects) {
  std::vector<OwnedObject> sorted(objects.begin(), objects.end());
  std::ranges::sort(sorted, {}, &OwnedObject::object);
  map_.reserve(map_.size() + sorted.size());
  for (const OwnedObject& e : sorted) {
    assert(model_->scene->contains(e.object));
    OwnObject& own = map_[e.object];
    own.driven = e.driven;
    own.launch = e.launch;
    if (surface_error_) own.bounding_radius_m = bounding_radius_m(*model_->scene, e.object);
    assert(own.bounding_radius_m >= 0.0);
  }
  build_index();
}

void OwnObjects::adopt(ObjectId object, std::uint32_t sequence) {
  assert(!contains(object) && model_->scene->contains(object));
  OwnObject& own = map_[object];
  own.adopted = true;
  own.sequence = sequence;
  if (surface_error_) own.bounding_radius_m = bounding_radius_m(*model_->scene, object);
  build_index();
}

void OwnObjects::build_index() {
  index_.clear();
  checks_ = Schedule(map_.size());
  for (std::uint32_t index = 0; const auto& [object, own] : map_) index_.set(object, index++);
  check_all();
}

void OwnObjects::remove(std::span<const ObjectId> objects) {
  const std::size_t before = map_.size();
  for (const ObjectId object : objects) map_.erase(object);
  if (map_.size() != before) build_index();
}

void OwnObjects::follow_model() {
  for (auto& [object, own] : map_) {
    assert(model_->scene->contains(object));
    if (surface_error_) own.bounding_radius_m = bounding_radius_m(*model_->scene, object);
  }
  check_all();
}

void OwnObjects::check(ObjectId object) {
  if (const std::uint32_t index = index_.of(object); index != kNoIndex) checks_.set(index, SimTime::min());
}

void OwnObjects::check_all() {
  for (std::size_t index = 0; index < checks_.size(); ++index) checks_.set(index, SimTime::min());
}

void OwnObjects::republish(ObjectId object) {
  OwnObject* const own = find(object);
  if (own == nullptr) return;
  own->republish = true;
  check(object);
}

void OwnObjects::resend_all() {
  for (auto& [object, own] : map_) own.resend = true;
  check_all();
}

void OwnObjects::forget_acknowledgements_of(PeerId peer) {
  for (auto& [object, own] : map_) {
    own.delivery.acknowledged_by.erase(peer);
    own.delivery.unacknowledged_by.erase(peer);
  }
}

}  // namespace peerd::replication
