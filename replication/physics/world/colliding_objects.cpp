#include "replication/physics/world/colliding_objects.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

namespace peerd::replication {

void CollidingObjects::on_contact(const ContactEvent& contact) {
  const Pair pair(std::minmax(contact.collider, contact.collidee));
  if (touching_.contains(pair) || !model_->are_paired(pair.first, pair.second)) return;
  touching_.insert(pair);
  checked_.insert(pair);
  for (const ObjectId object : {pair.first, pair.second}) {
    if (partners_[object]++ == 0) events_.push_back({object, contact.at, false});
  }
}

void CollidingObjects::part(const Pair& pair, SimTime t) {
  touching_.erase(pair);
  checked_.erase(pair);
  raise(pair);
  for (const ObjectId object : {pair.first, pair.second}) {
    const auto partners = partners_.find(object);
    assert(partners != partners_.end() && partners->second > 0);
    if (--partners->second > 0) continue;
    partners_.erase(partners);
    events_.push_back({object, t, true});
  }
}

void CollidingObjects::lay(const Pair& pair) {
  checked_.erase(pair);
  lying_.insert({pair.first, pair});
  lying_.insert({pair.second, pair});
}

void CollidingObjects::raise(const Pair& pair) {
  lying_.erase({pair.first, pair});
  lying_.erase({pair.second, pair});
}

void CollidingObjects::wake(ObjectId object) {
  if (lying_.empty()) return;
  for (auto at = lying_.lower_bound({object, Pair{}}); at != lying_.end() && at->first == object;
       at = lying_.lower_bound({object, Pair{}})) {
    const Pair pair = at->second;
    raise(pair);
    checked_.insert(pair);
  }
}

void CollidingObjects::update(const Touch& touch, const Lies& lies, SimTime t) {
  const std::vector<Pair> before(checked_.begin(), checked_.end());
  for (const Pair& pair : before) {
    if (!touch(pair.first, pair.second)) {
      part(pair, t);
    } else if (lies(pair.first) && lies(pair.second)) {
      lay(pair);
    }
  }
  assert(2 * (touching_.size() - checked_.size()) == lying_.size());
}

void CollidingObjects::change_scene(const WorldModel& next, SimTime t) {
  const std::vector<Pair> before(touching_.begin(), touching_.end());
  for (const Pair& pair : before) {
    if (!next.are_paired(pair.first, pair.second)) part(pair, t);
  }
}

void CollidingObjects::forget(SimTime t) {
  while (!touching_.empty()) {
    const Pair pair = *touching_.begin();  // which part() erases
    part(pair, t);
  }
  assert(partners_.empty());
}

void CollidingObjects::forget(ObjectId object, SimTime t) {
  const std::vector<Pair> before(touching_.begin(), touching_.end());
  for (const Pair& pair : before) {
    if (pair.first == object || pair.second == object) part(pair, t);
  }
}

std::optional<NotColliding> CollidingObjects::poll() {
  if (events_.empty()) return std::nullopt;
  const NotColliding event = events_.front();
  events_.pop_front();
  return event;
}

}  // namespace peerd::replication
