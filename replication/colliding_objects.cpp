#include "replication/colliding_objects.hpp"

#include <algorithm>
#include <vector>

namespace peerd::replication {

void CollidingObjects::on_contact(const ContactEvent& contact) {
  const auto [lower, higher] = std::minmax(contact.collider, contact.collidee);
  if (!touching_.emplace(lower, higher).second) return;
  for (const ObjectId object : {lower, higher}) {
    if (partners_[object]++ == 0) events_.push_back({object, contact.at, false});
  }
}

bool CollidingObjects::touching(const Pair& pair, const StateOf& state_of) const {
  const auto is_of = [&](const CollisionPair& p) { return Pair(std::minmax(p.collider, p.collidee)) == pair; };
  const KinematicState a = state_of(pair.first), b = state_of(pair.second);
  return std::ranges::any_of(model_.pairs, [&](const CollisionPair& p) {
    return is_of(p) && collision::touching({*model_.body(pair.first), a}, {*model_.body(pair.second), b}, p.type);
  });
}

void CollidingObjects::part(const Pair& pair, SimTime t) {
  touching_.erase(pair);
  for (const ObjectId object : {pair.first, pair.second}) {
    const auto partners = partners_.find(object);
    if (--partners->second > 0) continue;
    partners_.erase(partners);
    events_.push_back({object, t, true});
  }
}

void CollidingObjects::update(const StateOf& state_of, SimTime t) {
  const std::vector<Pair> before(touching_.begin(), touching_.end());
  for (const Pair& pair : before) {
    if (!touching(pair, state_of)) part(pair, t);
  }
}

void CollidingObjects::forget(SimTime t) {
  while (!touching_.empty()) part(*touching_.begin(), t);
}

std::optional<NotColliding> CollidingObjects::poll() {
  if (events_.empty()) return std::nullopt;
  const NotColliding event = events_.front();
  events_.pop_front();
  return event;
}

}  // namespace peerd::replication
