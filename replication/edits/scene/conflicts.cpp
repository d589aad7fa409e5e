#include "replication/edits/scene/conflicts.hpp"

#include <algorithm>
#include <cassert>
#include <ranges>

namespace peerd::replication {
namespace {

bool is_in(const ObjectId& first, std::uint32_t count, const ObjectId& object) {
  return first.origin == object.origin && object.number - first.number < count;
}

// Whether an operation that changes nothing has lost an effect.
bool has_effect(const OperationBody& body) {
  const bool is_about_ownership = std::holds_alternative<GiveObject>(body) ||
                                  std::holds_alternative<RequestObject>(body) ||
                                  std::holds_alternative<PlaceObject>(body);
  return !is_about_ownership && !std::holds_alternative<SendMessage>(body) &&
         !std::holds_alternative<UndoOperation>(body);
}

}  // namespace

std::optional<Conflicts::Register> Conflicts::register_of(const OperationBody& body) {
  if (const auto* set = std::get_if<SetField>(&body))
    return Register{Register::Kind::kField, set->node.packed(), set->field};
  if (const auto* data = std::get_if<SetData>(&body))
    return Register{Register::Kind::kData, data->node.packed(), data->key};
  if (const auto* move = std::get_if<MoveObject>(&body)) return Register{Register::Kind::kPlace, move->object.packed()};
  return std::nullopt;
}

void Conflicts::add(const Operation& operation) { known_.add(operation); }

void Conflicts::on_in_force(const OperationKey& key, std::uint32_t objects, RemovedIds removed, bool is_new) {
  refused_.erase(key);
  if (is_new) {
    changed_.insert(key);
    index(key, body_of_(key), objects);
  }
  const auto known = removals_.find(key);
  const bool is_same =
      known == removals_.end() ? removed.objects.empty() && removed.nodes.empty() : known->second == removed;
  if (is_same) return;
  if (known != removals_.end()) spread_removal(key);  // also of what it does not remove any more
  changed_.insert(key);
  set_removal(key, std::move(removed));
  while (removed_ids_ > kRemovedIdsMax && removals_.size() > 1) erase_removal(removals_.begin()->first);
}

void Conflicts::on_refused(const OperationKey& key) {
  refused_.insert(key);
  changed_.insert(key);
}

void Conflicts::on_undone(const OperationKey& key) {
  refused_.erase(key);
  changed_.insert(key);
}

void Conflicts::index(const OperationKey& key, const OperationBody& body, std::uint32_t objects) {
  if (const auto written = register_of(body)) {
    Keys& writes = writes_[*written];
    const auto at = std::ranges::lower_bound(writes, key);
    if (at == writes.end() || *at != key) writes.insert(at, key);
  } else if (const auto* add = std::get_if<AddNodes>(&body)) {
    if (objects > 0) {
      added_[ObjectId(add->first_object, key.second.author.value)] = {key, objects};
    } else if (add->parent) {
      added_below_[*add->parent].insert(key);
    }
  } else if (const auto* route = std::get_if<ChangeRoute>(&body)) {
    routes_of_[route->from].insert(key);
    routes_of_[route->to].insert(key);
  }
}

void Conflicts::set_removal(const OperationKey& removal, RemovedIds ids) {
  if (removals_.contains(removal)) erase_removal(removal);
  for (const ObjectId object : ids.objects) removals_of_object_[object].push_back(removal);
  for (const NodeId node : ids.nodes) removals_of_node_[node].push_back(removal);
  removed_ids_ += ids.objects.size() + ids.nodes.size();
  removals_.emplace(removal, std::move(ids));
}

void Conflicts::erase_removal(const OperationKey& removal) {
  const OperationKey key = removal;  // it may be part of what is erased
  const auto erase_from = [&](auto& removals_of, const auto& ids) {
    for (const auto id : ids) {
      const auto at = removals_of.find(id);
      assert(at != removals_of.end());
      std::erase(at->second, key);
      if (at->second.empty()) removals_of.erase(at);
    }
  };
  const RemovedIds& ids = removals_.at(key);
  erase_from(removals_of_object_, ids.objects);
  erase_from(removals_of_node_, ids.nodes);
  removed_ids_ -= ids.objects.size() + ids.nodes.size();
  removals_.erase(key);
}

void Conflicts::find(SimTime now) {
  assert(found_.size() <= kMax);
  now_ = std::max(now_, now);
  for (const OperationKey& key : std::exchange(changed_, {})) spread(key);
  for (const OperationKey& key : std::exchange(marked_, {})) {
    if (const auto loss = loss_of(key)) {
      note(key, loss->winner);
    } else {
      forget(key);
    }
  }
}

void Conflicts::spread(const OperationKey& changed) {
  const OperationBody body = body_of_(changed);
  marked_.insert(changed);
  if (const auto written = register_of(body)) spread_write(*written, changed);
  if (removals_.contains(changed)) spread_removal(changed);
  const bool may_cause = std::holds_alternative<RemoveObject>(body) || std::holds_alternative<RemoveNode>(body) ||
                         std::holds_alternative<MoveObject>(body);
  if (may_cause) marked_.insert(refused_.upper_bound(changed), refused_.end());
}

// The write before it has another next one. What it has gone on from is not lost, and may be where it is not in force.
void Conflicts::spread_write(const Register& written, const OperationKey& changed) {
  const auto writes = writes_.find(written);
  if (writes == writes_.end()) return;  // it never was in force
  const auto end = std::ranges::lower_bound(writes->second, changed);
  const auto before = std::make_reverse_iterator(end), none = writes->second.rend();
  if (const auto last = std::find_if(before, none, std::ref(is_in_force_)); last != none) marked_.insert(*last);
  if (is_in_force_(changed)) {
    const auto lost = lost_writes_.find(written);
    if (lost == lost_writes_.end()) return;
    for (const OperationKey& each : lost->second) {
      if (each < changed && knew(changed, each)) marked_.insert(each);
    }
  } else {
    std::copy_if(before, none, std::inserter(marked_, marked_.end()),
                 [&](const OperationKey& each) { return knew(changed, each); });
  }
}

void Conflicts::spread_removal(const OperationKey& removal) {
  const RemovedIds& ids = removals_.at(removal);
  const auto mark = [&](const auto& by_id, const auto& id) {
    if (const auto at = by_id.find(id); at != by_id.end()) marked_.insert(at->second.begin(), at->second.end());
  };
  for (const NodeId node : ids.nodes) {
    mark_writes_before(removal, Register::Kind::kField, node.packed());
    mark_writes_before(removal, Register::Kind::kData, node.packed());
    mark(routes_of_, node);
  }
  for (const ObjectId object : ids.objects) {
    mark_writes_before(removal, Register::Kind::kPlace, object.packed());
    mark(added_below_, object);
    const auto after = added_.upper_bound(object);
    if (after == added_.begin()) continue;
    const auto& [first, addition] = *std::prev(after);
    if (is_in(first, addition.second, object)) marked_.insert(addition.first);
  }
}

// The last write in force before a removal may be lost by it.
void Conflicts::mark_writes_before(const OperationKey& removal, Register::Kind kind, std::uint64_t id) {
  for (auto at = writes_.lower_bound({kind, id, {}});
       at != writes_.end() && at->first.kind == kind && at->first.id == id; ++at) {
    const auto before = std::make_reverse_iterator(std::ranges::lower_bound(at->second, removal));
    const auto last = std::find_if(before, at->second.rend(), std::ref(is_in_force_));
    if (last != at->second.rend()) marked_.insert(*last);
  }
}

std::optional<Conflicts::Loss> Conflicts::loss_of(const OperationKey& key) const {
  const OperationBody body = body_of_(key);
  if (refused_.contains(key)) return has_effect(body) ? std::optional(Loss{cause_of(key, body)}) : std::nullopt;
  if (!is_in_force_(key)) return std::nullopt;
  if (const auto written = register_of(body)) {
    const Keys& writes = writes_.at(*written);
    const auto next = std::find_if(std::ranges::upper_bound(writes, key), writes.end(), std::ref(is_in_force_));
    if (next != writes.end()) return loss_by_next(writes, next, key);
  }
  return loss_by_removal(key, removals_of_effect(key, body));
}

// A write is lost if the next one did not know it, unless a later one did that did not know the next one: that has gone
// on from it.
std::optional<Conflicts::Loss> Conflicts::loss_by_next(const Keys& writes, Keys::const_iterator next,
                                                       const OperationKey& key) const {
  if (knew(*next, key)) return std::nullopt;
  const bool goes_on = std::any_of(std::next(next), writes.end(), [&](const OperationKey& later) {
    return knew(later, key) && !knew(later, *next) && is_in_force_(later);
  });
  return goes_on ? std::nullopt : std::optional(Loss{*next});
}

// The first removal of what the operation has done whose author did not know it has won.
std::optional<Conflicts::Loss> Conflicts::loss_by_removal(const OperationKey& key, const Keys& removals) const {
  Winner first;
  for (const OperationKey& removal : removals) {
    const bool counts = key < removal && is_in_force_(removal) && !knew(removal, key);
    if (counts) first = std::min(first.value_or(removal), removal);
  }
  return first ? std::optional(Loss{first}) : std::nullopt;
}

Conflicts::Keys Conflicts::removals_of_effect(const OperationKey& key, const OperationBody& body) const {
  Keys all;
  const auto add_of = [&](const auto& removals_of, const auto& id) {
    const auto at = removals_of.find(id);
    if (at != removals_of.end()) all.insert(all.end(), at->second.begin(), at->second.end());
  };
  if (const auto* set = std::get_if<SetField>(&body)) {
    add_of(removals_of_node_, set->node);
  } else if (const auto* data = std::get_if<SetData>(&body)) {
    add_of(removals_of_node_, data->node);
  } else if (const auto* move = std::get_if<MoveObject>(&body)) {
    add_of(removals_of_object_, move->object);
  } else if (const auto* route = std::get_if<ChangeRoute>(&body)) {
    add_of(removals_of_node_, route->from);
    add_of(removals_of_node_, route->to);
  } else if (const auto* add = std::get_if<AddNodes>(&body)) {
    const ObjectId first(add->first_object, key.second.author.value);
    const auto added = added_.find(first);
    const bool has_objects = added != added_.end() && added->second.first == key;
    if (!has_objects && add->parent) add_of(removals_of_object_, *add->parent);
    if (!has_objects) return all;
    for (auto at = removals_of_object_.lower_bound(first);
         at != removals_of_object_.end() && is_in(first, added->second.second, at->first); ++at) {
      all.insert(all.end(), at->second.begin(), at->second.end());
    }
  }
  return all;
}

Conflicts::Keys Conflicts::removals_of(const OperationBody& body) const {
  Keys all;
  const auto object = [&](const std::optional<ObjectId>& id) {
    const auto at = id ? removals_of_object_.find(*id) : removals_of_object_.end();
    if (at != removals_of_object_.end()) all.insert(all.end(), at->second.begin(), at->second.end());
  };
  const auto node = [&](NodeId id) {
    const auto at = removals_of_node_.find(id);
    if (at != removals_of_node_.end()) all.insert(all.end(), at->second.begin(), at->second.end());
  };
  if (const auto* add = std::get_if<AddNodes>(&body)) {
    object(add->parent);
    object(add->before);
  } else if (const auto* remove_object = std::get_if<RemoveObject>(&body)) {
    object(remove_object->object);
  } else if (const auto* remove_node = std::get_if<RemoveNode>(&body)) {
    node(remove_node->node);
  } else if (const auto* move = std::get_if<MoveObject>(&body)) {
    object(move->object);
    object(move->parent);
    object(move->before);
  } else if (const auto* set = std::get_if<SetField>(&body)) {
    node(set->node);
  } else if (const auto* route = std::get_if<ChangeRoute>(&body)) {
    node(route->from);
    node(route->to);
  } else if (const auto* data = std::get_if<SetData>(&body)) {
    node(data->node);
  }
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  return all;
}

// The last removal of what it needs; else, of a move, the last other one: that may have made its own place part of it.
Conflicts::Winner Conflicts::cause_of(const OperationKey& refused, const OperationBody& body) const {
  for (const OperationKey& removal : std::views::reverse(removals_of(body))) {
    if (removal < refused && is_in_force_(removal) && !knew(refused, removal)) return removal;
  }
  if (!std::holds_alternative<MoveObject>(body)) return std::nullopt;
  Winner last;
  for (auto at = writes_.lower_bound({Register::Kind::kPlace, 0, {}}); at != writes_.end(); ++at) {
    for (auto write = std::ranges::lower_bound(at->second, refused); write != at->second.begin();) {
      --write;
      if (!is_in_force_(*write)) continue;  // whether it ever was depends on the order in which this peer heard
      if (knew(refused, *write)) break;
      last = std::max(last.value_or(*write), *write);
      break;
    }
  }
  return last;
}

void Conflicts::note(const OperationKey& loser, Winner winner) {
  assert(loser != winner);
  if (const auto known = found_.find(loser); known != found_.end()) {
    known->second.winner = winner;
    return;
  }
  const auto forget_if = [&](const auto& is_old) {
    std::vector<OperationKey> old;
    for (const auto& [key, conflict] : found_) {
      if (is_old(conflict)) old.push_back(key);
    }
    for (const OperationKey& key : old) forget(key);
  };
  if (found_.size() >= kMax) forget_if([&](const Conflict& each) { return each.found < now_ - kKept; });
  if (found_.size() >= kMax) {
    const auto age = [](const auto& each) { return std::pair(each.second.found, each.first); };
    const OperationKey oldest = std::ranges::min_element(found_, {}, age)->first;
    forget(oldest);
    ++forgotten_;
  }
  found_.emplace(loser, Conflict{loser, winner, now_});
  if (const auto written = register_of(body_of_(loser))) lost_writes_[*written].insert(loser);
}

void Conflicts::forget(const OperationKey& loser) {
  if (found_.erase(loser) == 0) return;
  const auto written = register_of(body_of_(loser));
  const auto lost = written ? lost_writes_.find(*written) : lost_writes_.end();
  if (lost == lost_writes_.end()) return;
  lost->second.erase(loser);
  if (lost->second.empty()) lost_writes_.erase(lost);
}

std::vector<Conflict> Conflicts::list(SimTime now) const {
  std::vector<Conflict> all;
  for (const auto& [loser, conflict] : found_) {
    if (conflict.found >= now - kKept) all.push_back(conflict);
  }
  return all;
}

}  // namespace peerd::replication
