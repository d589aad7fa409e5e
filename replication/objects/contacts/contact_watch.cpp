#include "replication/objects/contacts/contact_watch.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

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
  assert(!on || leaves(a, b));
  on ? void(resting_.insert(std::minmax(a, b))) : void(resting_.erase(std::minmax(a, b)));
  for (const ObjectId object : {a, b}) follow(object);  // its other contacts count here, too
}

void ContactWatch::forget_rests_of(ObjectId object) {
  std::erase_if(resting_, [&](const auto& two) { return two.first == object || two.second == object; });
  if (is_up_to_date()) note_sought(model_->pairs_of(object));
}

bool ContactWatch::is_partner(ObjectId object) const {
  if (own_.contains(object) || owners_.of(object) == kNobody) return false;
  const auto sought = sought_of_.find(object);
  return sought != sought_of_.end() && sought->second > 0;
}

bool ContactWatch::note_partner(ObjectId object) {
  if (is_partner(object)) return partners_.insert(object).second;
  return partners_.erase(object) > 0;
}

void ContactWatch::note_sought(const PairNumbers& pairs) {
  assert(is_sought_.size() == model_->pairs.size());
  for (const std::uint32_t number : pairs) {
    assert(number < is_sought_.size());
    const CollisionPair pair = model_->pairs[number];
    const ObjectId a = pair.collider, b = pair.collidee;
    if (!resting_.empty() && !leaves(a, b)) resting_.erase(std::minmax(a, b));
    const bool is_sought = searches(a, b) || rests(a, b);
    if (is_sought == is_sought_[number]) continue;
    is_sought_[number] = is_sought;
    for (const ObjectId end : {a, b}) {
      assert(is_sought || sought_of_[end] > 0);
      is_sought ? ++sought_of_[end] : --sought_of_[end];
    }
  }
}

void ContactWatch::follow_all() {
  if (!replica_.begun()) return;
  followed_ = model_.revision();
  const PairNumbers all = PairNumbers::all_below(model_->pairs.size());
  is_sought_.assign(all.size(), false);
  sought_of_.clear();
  note_sought(all);
  partners_.clear();
  for (const auto& [object, owner] : owners_) static_cast<void>(note_partner(object));
  follow(all);
}

void ContactWatch::follow(ObjectId object) {
  if (!is_up_to_date()) return follow_all();
  const PairNumbers pairs = model_->pairs_of(object);
  note_sought(pairs);
  static_cast<void>(note_partner(object));
  follow(pairs);
}

void ContactWatch::follow_owners_of(std::span<const ObjectId> objects) {
  if (!is_up_to_date()) return follow_all();
  std::vector<std::uint32_t> pairs;
  std::vector<ObjectId> ends(objects.begin(), objects.end());
  for (const ObjectId object : objects) {
    for (const std::uint32_t number : model_->pairs_of(object)) {
      const CollisionPair pair = model_->pairs[number];
      pairs.push_back(number);
      ends.push_back(pair.collider);
      ends.push_back(pair.collidee);
    }
  }
  note_sought(PairNumbers(pairs));
  std::ranges::sort(ends);
  ends.erase(std::ranges::unique(ends).begin(), ends.end());
  for (const ObjectId end : ends) {
    if (!note_partner(end)) continue;
    std::ranges::copy(model_->pairs_of(end), std::back_inserter(pairs));
  }
  std::ranges::sort(pairs);
  pairs.erase(std::ranges::unique(pairs).begin(), pairs.end());
  follow(PairNumbers(pairs));
}

void ContactWatch::follow(const PairNumbers& pairs) {
  assert(is_up_to_date());
  for (const std::uint32_t number : pairs) {
    assert(number < model_->pairs.size());
    const CollisionPair& pair = model_->pairs[number];
    const ObjectId a = pair.collider, b = pair.collidee;
    const bool here = replica_.receives(a) && replica_.receives(b), mine = own_.contains(a) || own_.contains(b);
    const bool of_nobody = owners_.of(a) == kNobody && owners_.of(b) == kNobody;  // that is no prediction
    // In the truth only what is certain moves a scene object: not a remote one, before its owner has decided.
    const bool moves_scene =
        (scene_.answers(pair, a) && owners_.of(a) == kNobody) || (scene_.answers(pair, b) && owners_.of(b) == kNobody);
    const bool as_partner = moves_scene ? of_nobody : is_partner(a) || is_partner(b);
    replica_.truth().watch(number, here && (mine ? is_sought_[number] : as_partner));
    replica_.ghosts().watch(number, here && (config_.policy.predict_collisions || of_nobody));
  }
}

}  // namespace peerd::replication
