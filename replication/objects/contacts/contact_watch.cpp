#include "replication/objects/contacts/contact_watch.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "replication/objects/contacts/decision.hpp"

namespace peerd::replication {

bool ContactWatch::searches(ObjectId a, ObjectId b) const {
  const bool mine = own_.contains(a) || own_.contains(b);
  if (!owners_.have_two(a, b)) return mine;
  if (config_.decisions.policy == DecisionPolicy::kId) return decider_by_id(owners_.of(a), owners_.of(b)) == config_.id;
  return mine || config_.is_decision_server();
}

bool ContactWatch::leaves(ObjectId a, ObjectId b) const {
  return (own_.contains(a) || own_.contains(b)) && owners_.have_two(a, b) && !searches(a, b);
}

void ContactWatch::set_rests(ObjectId a, ObjectId b, bool on) {
  if (on == rests(a, b)) return;
  on ? void(resting_.insert(std::minmax(a, b))) : void(resting_.erase(std::minmax(a, b)));
  for (const ObjectId object : {a, b}) follow(object);  // its other contacts count here, too
}

void ContactWatch::forget_rests_of(ObjectId object) {
  std::erase_if(resting_, [&](const auto& two) { return two.first == object || two.second == object; });
}

bool ContactWatch::is_partner(ObjectId object) const {
  if (own_.contains(object) || owners_.of(object) == kNobody) return false;
  return std::ranges::any_of(model_->pairs_of(object), [&](std::uint32_t number) {
    const CollisionPair& pair = model_->pairs[number];
    return searches(pair.collider, pair.collidee) || rests(pair.collider, pair.collidee);
  });
}

bool ContactWatch::note_partner(ObjectId object) {
  if (is_partner(object)) return partners_.insert(object).second;
  return partners_.erase(object) > 0;
}

void ContactWatch::follow_all() {
  if (!replica_.begun()) return;
  std::vector<std::uint32_t> all(model_->pairs.size());
  std::iota(all.begin(), all.end(), 0U);
  drop_rests(all);
  partners_.clear();
  for (const auto& [object, owner] : owners_) static_cast<void>(note_partner(object));
  follow(all);
}

void ContactWatch::follow(ObjectId object) {
  if (!replica_.begun()) return;
  const auto pairs = model_->pairs_of(object);
  drop_rests(pairs);
  static_cast<void>(note_partner(object));
  follow(pairs);
}

void ContactWatch::follow_owners_of(std::span<const ObjectId> objects) {
  if (!replica_.begun()) return;
  std::vector<std::uint32_t> theirs;
  std::set<ObjectId> ends(objects.begin(), objects.end());
  for (const ObjectId object : objects) {
    for (const std::uint32_t number : model_->pairs_of(object)) {
      theirs.push_back(number);
      ends.insert(model_->pairs[number].collider);
      ends.insert(model_->pairs[number].collidee);
    }
  }
  drop_rests(theirs);
  for (const ObjectId end : ends) {
    if (!note_partner(end)) continue;
    const auto of_end = model_->pairs_of(end);
    theirs.insert(theirs.end(), of_end.begin(), of_end.end());
  }
  std::ranges::sort(theirs);
  theirs.erase(std::ranges::unique(theirs).begin(), theirs.end());
  follow(theirs);
}

void ContactWatch::drop_rests(std::span<const std::uint32_t> pairs) {
  for (const std::uint32_t number : pairs) {
    if (resting_.empty()) return;
    const CollisionPair& pair = model_->pairs[number];
    if (!leaves(pair.collider, pair.collidee)) resting_.erase(std::minmax(pair.collider, pair.collidee));
  }
}

void ContactWatch::follow(std::span<const std::uint32_t> pairs) {
  std::unordered_map<ObjectId, bool> partners;
  const auto is_known_partner = [&](ObjectId object) {
    const auto [at, is_new] = partners.try_emplace(object, false);
    if (is_new) at->second = is_partner(object);
    return at->second;
  };
  for (const std::uint32_t number : pairs) {
    assert(number < model_->pairs.size());
    const CollisionPair& pair = model_->pairs[number];
    const ObjectId a = pair.collider, b = pair.collidee;
    const bool here = replica_.receives(a) && replica_.receives(b), mine = own_.contains(a) || own_.contains(b);
    const bool of_nobody = owners_.of(a) == kNobody && owners_.of(b) == kNobody;  // that is no prediction
    // In the truth only what is certain moves a scene object: not a remote one, before its owner has decided.
    const bool moves_scene =
        (scene_.answers(pair, a) && owners_.of(a) == kNobody) || (scene_.answers(pair, b) && owners_.of(b) == kNobody);
    const bool as_partner = moves_scene ? of_nobody : is_known_partner(a) || is_known_partner(b);
    const bool by_us = searches(a, b) || rests(a, b);
    replica_.truth().watch(number, here && (mine ? by_us : as_partner));
    replica_.ghosts().watch(number, here && (config_.policy.predict_collisions || of_nobody));
  }
}

}  // namespace peerd::replication
