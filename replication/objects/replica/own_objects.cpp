#include "replication/objects/replica/own_objects.hpp"

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
    OwnObject& own = begin(e.object);
    own.driven = e.driven;
    own.launch = e.launch;
  }
  build_index();
}

void OwnObjects::adopt(ObjectId object) {
  assert(!contains(object));
  begin(object).adopted = true;
  build_index();
}

OwnObject& OwnObjects::begin(ObjectId object) {
  assert(model_->scene->contains(object));
  OwnObject& own = map_[object];
  if (const auto last = sequences_.find(object); last != sequences_.end()) own.sequence = last->second;
  if (surface_error_) own.bounding_radius_m = bounding_radius_m(*model_->scene, object);
  assert(own.bounding_radius_m >= 0.0);
  return own;
}

void OwnObjects::build_index() {
  index_.clear();
  checks_ = Schedule(map_.size());
  for (std::uint32_t index = 0; const auto& [object, own] : map_) index_.set(object, index++);
  check_all();
}

void OwnObjects::remove(std::span<const ObjectId> objects) {
  const std::size_t before = map_.size();
  for (const ObjectId object : objects) {
    const auto at = map_.find(object);
    if (at == map_.end()) continue;
    sequences_[object] = at->second.sequence;
    map_.erase(at);
  }
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
