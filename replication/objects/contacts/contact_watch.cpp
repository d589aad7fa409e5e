#include "replication/objects/contacts/contact_watch.hpp"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

#include "replication/objects/contacts/decision.hpp"

namespace peerd::replication {

bool ContactWatch::searches(const Standing& a, const Standing& b) const {
  const bool mine = a.is_own || b.is_own;
  const bool have_two = a.owner != kNobody && b.owner != kNobody && a.owner != b.owner;
  if (!have_two) return mine;
  if (config_.decisions.policy == DecisionPolicy::kId) return decider_by_id(a.owner, b.owner) == config_.id;
  return mine || config_.is_decision_server();
}

bool ContactWatch::searches(ObjectId a, ObjectId b) const { return searches(standing_of(a), standing_of(b)); }

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
  std::vector<ObjectId> partners;
  std::erase_if(resting_, [&](const auto& two) {
    if (two.first != object && two.second != object) return false;
    partners.push_back(two.first == object ? two.second : two.first);
    return true;
  });
  if (!is_up_to_date()) return;
  note_sought(object);
  for (const ObjectId partner : partners) {
    if (note_partner(partner)) watch_anew(partner);
  }
}

void ContactWatch::forget_ended_rests() {
  assert(std::ranges::all_of(resting_, [](const auto& two) { return two.first < two.second; }));
  std::vector<ObjectId> ends;
  std::erase_if(resting_, [&](const auto& two) {
    if (leaves(two.first, two.second)) return false;
    ends.insert(ends.end(), {two.first, two.second});
    return true;
  });
  for (const ObjectId end : ends) {
    if (note_partner(end)) watch_anew(end);
  }
}

bool ContactWatch::is_partner(ObjectId object) const {
  const Standing own = standing_of(object);
  if (own.is_own || own.owner == kNobody) return false;
  const auto sought = sought_of_.find(object);
  if (sought != sought_of_.end() && sought->second > 0) return true;
  const bool rests =
      std::ranges::any_of(resting_, [&](const auto& two) { return two.first == object || two.second == object; });
  if (rests) return true;
  const ModelNode* const node = model_->node(object);
  if (node == nullptr) return false;
  const auto stretches = model_->node_pairs.stretches_of(model_->index_of(object));
  return std::ranges::any_of(stretches, [&](const PairNumbers::Stretch& stretch) {
    const auto sides = sides_.find(stretch.group);
    if (stretch.group == nullptr || sides == sides_.end()) return false;
    const bool meets_collidees = stretch.member.row != kNoNode;
    const bool is_among_them = meets_collidees && stretch.member.column != kNoNode;
    return std::ranges::any_of(meets_collidees ? sides->second.collidees : sides->second.colliders,
                               [&](const auto& others) {
                                 const auto& [standing, count] = others;
                                 if (count == 1 && is_among_them && standing == own) return false;  // that is itself
                                 return searches(own, standing);
                               });
  });
}

bool ContactWatch::note_partner(ObjectId object) {
  if (is_partner(object)) return partners_.insert(object).second;
  return partners_.erase(object) > 0;
}

void ContactWatch::note_sought(std::uint32_t number, const CollisionPair& pair) {
  const ObjectId a = pair.collider, b = pair.collidee;
  const bool is_sought = searches(a, b) || rests(a, b);
  if (is_sought == sought_.contains(number)) return;
  is_sought ? void(sought_.insert(number)) : void(sought_.erase(number));
  for (const ObjectId end : {a, b}) {
    assert(is_sought || sought_of_[end] > 0);
    is_sought ? ++sought_of_[end] : --sought_of_[end];
  }
  assert(sought_.size() <= model_->pairs.size());
}

void ContactWatch::note_sought(ObjectId object) {
  if (model_->node(object) == nullptr) return;
  for (const std::uint32_t number : model_->node_pairs.listed_of(model_->index_of(object))) {
    note_sought(number, model_->pairs[number]);
  }
}

bool ContactWatch::note_standing(ObjectId object) {
  if (model_->node(object) == nullptr) return false;
  const auto stretches = model_->node_pairs.stretches_of(model_->index_of(object));
  if (stretches.empty()) return false;
  const auto [known, is_new] = standings_.try_emplace(object);
  const Standing before = known->second, now = standing_of(object);
  if (!is_new && before == now) return false;
  known->second = now;
  bool others_may_be = false;
  const auto count = [&](std::map<Standing, std::uint32_t>& side) {
    if (!is_new) {
      const auto left = side.find(before);
      assert(left != side.end() && left->second > 0);
      if (--left->second <= 1) others_may_be = true;
      if (left->second == 0) side.erase(left);
    }
    if (++side[now] <= 2) others_may_be = true;
  };
  for (const PairNumbers::Stretch& stretch : stretches) {
    if (stretch.group == nullptr) continue;
    GroupSides& sides = sides_[stretch.group];
    if (stretch.member.row != kNoNode) count(sides.colliders);
    if (stretch.member.column != kNoNode) count(sides.collidees);
  }
  return others_may_be;
}

void ContactWatch::follow_all() {
  if (!replica_.begun()) return;
  followed_ = model_.revision();
  forget_ended_rests();
  sought_.clear();
  sought_of_.clear();
  model_->pairs.for_each_listed([&](std::uint32_t number, const CollisionPair& pair) { note_sought(number, pair); });
  standings_.clear();
  sides_.clear();
  for (const PairGroup& group : model_->groups) {
    for (const PairGroup::Member& member : group.members()) {
      static_cast<void>(note_standing(model_->nodes[member.node].object));
    }
  }
  partners_.clear();
  for (const auto& [object, owner] : owners_) static_cast<void>(note_partner(object));
  replica_.truth().watch_by([this](const CollisionPair& pair) { return is_watched_in_truth(pair); });
  replica_.ghosts().watch_by([this](const CollisionPair& pair) { return is_watched_in_ghosts(pair); });
}

void ContactWatch::follow(ObjectId object) {
  if (!is_up_to_date()) return follow_all();
  forget_ended_rests();
  note_sought(object);
  if (note_standing(object)) return follow_all();
  static_cast<void>(note_partner(object));
  watch_anew(object);
}

void ContactWatch::follow_owners_of(std::span<const ObjectId> objects) {
  if (!is_up_to_date()) return follow_all();
  forget_ended_rests();
  std::vector<ObjectId> owned(objects.begin(), objects.end());
  std::ranges::sort(owned);
  std::vector<ObjectId> ends = owned;
  bool others_may_be = false;
  for (const ObjectId object : objects) {
    note_sought(object);
    others_may_be = note_standing(object) || others_may_be;
    if (model_->node(object) == nullptr) continue;
    for (const std::uint32_t number : model_->node_pairs.listed_of(model_->index_of(object))) {
      const CollisionPair pair = model_->pairs[number];
      ends.push_back(pair.collider);
      ends.push_back(pair.collidee);
    }
  }
  if (others_may_be) return follow_all();
  std::ranges::sort(ends);
  ends.erase(std::ranges::unique(ends).begin(), ends.end());
  for (const ObjectId end : ends) {
    if (note_partner(end) || std::ranges::binary_search(owned, end)) watch_anew(end);
  }
}

void ContactWatch::watch_anew(ObjectId object) {
  assert(is_up_to_date());
  replica_.truth().watch_anew(object);
  replica_.ghosts().watch_anew(object);
}

bool ContactWatch::is_watched_in_truth(const CollisionPair& pair) const {
  assert(followed_ && "the rule is given once all has been followed");
  const ObjectId a = pair.collider, b = pair.collidee;
  if (!replica_.receives(a) || !replica_.receives(b)) return false;
  if (own_.contains(a) || own_.contains(b)) return searches(a, b) || rests(a, b);
  // In the truth only what is certain moves a scene object: not a remote one, before its owner has decided.
  const bool moves_scene =
      (scene_.answers(pair, a) && owners_.of(a) == kNobody) || (scene_.answers(pair, b) && owners_.of(b) == kNobody);
  if (moves_scene) return owners_.of(a) == kNobody && owners_.of(b) == kNobody;
  return partners_.contains(a) || partners_.contains(b);
}

bool ContactWatch::is_watched_in_ghosts(const CollisionPair& pair) const {
  const ObjectId a = pair.collider, b = pair.collidee;
  if (!replica_.receives(a) || !replica_.receives(b)) return false;
  const bool of_nobody = owners_.of(a) == kNobody && owners_.of(b) == kNobody;  // that is no prediction
  return config_.policy.predict_collisions || of_nobody;
}

}  // namespace peerd::replication
