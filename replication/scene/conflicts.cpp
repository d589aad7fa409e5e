#include "replication/scene/conflicts.hpp"

#include <algorithm>
#include <cassert>
#include <ranges>

namespace peerd::replication {

std::optional<Conflicts::Register> Conflicts::register_of(const OperationBody& body) {
  if (const auto* set = std::get_if<SetField>(&body))
    return Register{Register::Kind::kField, set->node.packed(), set->field};
  if (const auto* data = std::get_if<SetData>(&body))
    return Register{Register::Kind::kData, data->node.packed(), data->key};
  if (const auto* move = std::get_if<MoveObject>(&body)) return Register{Register::Kind::kPlace, move->object.packed()};
  return std::nullopt;
}

void Conflicts::add(const Operation& operation) { known_.add(operation); }

void Conflicts::on_in_force(const OperationKey& key, const OperationBody& body, std::uint32_t objects,
                            RemovedIds removed, bool is_new) {
  if (is_new) {
    found_.erase(key);  // it was refused before
    new_.push_back({key, &body});
  }
  if (const auto written = is_new ? register_of(body) : std::nullopt) {
    Writes& writes = writes_[*written];
    const auto at = std::ranges::lower_bound(writes, key);
    if (at == writes.end() || *at != key) writes.insert(at, key);
  }
  if (const auto* add = std::get_if<AddNodes>(&body); add != nullptr && objects > 0) {
    added_[ObjectId(add->first_object, key.second.author.value)] = {key, objects};
  }
  if (!removed.objects.empty() || !removed.nodes.empty()) {
    set_removal(key, std::move(removed));
    while (removed_ids_ > kRemovedIdsMax && removals_.size() > 1) erase_removal(removals_.begin()->first);
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

void Conflicts::on_refused(const OperationKey& key, const OperationBody& body) {
  const bool is_about_ownership = std::holds_alternative<GiveObject>(body) ||
                                  std::holds_alternative<RequestObject>(body) ||
                                  std::holds_alternative<PlaceObject>(body);
  const bool has_effect = !std::holds_alternative<SendMessage>(body) && !std::holds_alternative<UndoOperation>(body);
  if (!is_about_ownership && has_effect) refused_.emplace_back(key, cause_of(key, body));
}

void Conflicts::on_undone(const OperationKey& key) {
  std::erase_if(found_, [&](const auto& each) { return each.first == key || each.second.winner == key; });
}

void Conflicts::find(SimTime now) {
  assert(found_.size() <= kMax);
  now_ = std::max(now_, now);
  for (const auto& [key, cause] : std::exchange(refused_, {})) note(key, cause);
  for (const New& each : std::exchange(new_, {})) {
    const auto written = register_of(*each.body);
    if (written) find_overwritten(writes_.at(*written), each.key);
    find_removed_later(each, written);
    if (const auto own = removals_.find(each.key); own != removals_.end()) find_removed(each.key, own->second);
  }
}

// A new operation may have its place before a removal that is known already.
void Conflicts::find_removed_later(const New& operation, const std::optional<Register>& written) {
  for (const OperationKey& removal : removals_of(*operation.body)) {
    if (!(operation.key < removal) || !is_in_force_(removal) || knew(removal, operation.key)) continue;
    if (written) {
      find_removed_writes(removal, written->kind, written->id);
    } else {
      note(operation.key, removal);
    }
  }
}

// The operation has taken its place among the writes of one register: what it has overwritten, and itself.
void Conflicts::find_overwritten(const Writes& writes, const OperationKey& key) {
  const auto at = static_cast<std::size_t>(std::ranges::lower_bound(writes, key) - writes.begin());
  assert(at < writes.size() && writes[at] == key);
  find_lost(writes, at);
  for (std::size_t before = at; before > 0;) {
    if (!is_in_force_(writes[--before])) continue;
    find_lost(writes, before);
    break;
  }
}

// A write is lost if the next one did not know it, unless a later one did: that has gone on from it.
void Conflicts::find_lost(const Writes& writes, std::size_t at) {
  assert(at < writes.size());
  if (!is_in_force_(writes[at])) return;
  std::optional<OperationKey> next;
  for (std::size_t later = at + 1; later < writes.size(); ++later) {
    if (!is_in_force_(writes[later])) continue;
    if (knew(writes[later], writes[at])) return;
    if (!next) next = writes[later];
  }
  if (next) note(writes[at], next);
}

void Conflicts::find_removed_writes(const OperationKey& removal, Register::Kind kind, std::uint64_t id) {
  for (auto at = writes_.lower_bound({kind, id, {}});
       at != writes_.end() && at->first.kind == kind && at->first.id == id; ++at) {
    const Writes& writes = at->second;
    auto last = std::ranges::lower_bound(writes, removal);
    while (last != writes.begin() && !is_in_force_(*std::prev(last))) --last;
    if (last != writes.begin() && !knew(removal, *std::prev(last))) note(*std::prev(last), removal);
  }
}

// The changes and additions of others there that were unknown to the author of the removal.
void Conflicts::find_removed(const OperationKey& removal, const RemovedIds& ids) {
  for (const NodeId node : ids.nodes) {
    find_removed_writes(removal, Register::Kind::kField, node.packed());
    find_removed_writes(removal, Register::Kind::kData, node.packed());
  }
  for (const ObjectId object : ids.objects) {
    find_removed_writes(removal, Register::Kind::kPlace, object.packed());
    auto after = added_.upper_bound(object);
    if (object.origin == 0 || after == added_.begin()) continue;
    const auto& [first, addition] = *std::prev(after);
    const auto& [key, count] = addition;
    const bool is_of_it = first.origin == object.origin && object.number - first.number < count;
    if (is_of_it && key < removal && !knew(removal, key) && is_in_force_(key)) note(key, removal);
  }
}

std::vector<OperationKey> Conflicts::removals_of(const OperationBody& body) const {
  std::vector<OperationKey> all;
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
std::optional<OperationKey> Conflicts::cause_of(const OperationKey& refused, const OperationBody& body) const {
  for (const OperationKey& removal : std::views::reverse(removals_of(body))) {
    if (removal < refused && is_in_force_(removal) && !knew(refused, removal)) return removal;
  }
  if (!std::holds_alternative<MoveObject>(body)) return std::nullopt;
  std::optional<OperationKey> last;
  for (auto at = writes_.lower_bound({Register::Kind::kPlace, 0, {}}); at != writes_.end(); ++at) {
    for (auto write = std::ranges::lower_bound(at->second, refused); write != at->second.begin();) {
      --write;
      if (knew(refused, *write)) break;
      if (!is_in_force_(*write)) continue;
      last = std::max(last.value_or(*write), *write);
      break;
    }
  }
  return last;
}

void Conflicts::note(const OperationKey& loser, std::optional<OperationKey> winner) {
  assert(loser != winner);
  if (found_.contains(loser)) return;
  if (found_.size() >= kMax) {
    std::erase_if(found_, [&](const auto& each) { return each.second.found < now_ - kKept; });
  }
  if (found_.size() >= kMax) {
    const auto age = [](const auto& each) { return std::pair(each.second.found, each.first); };
    found_.erase(std::ranges::min_element(found_, {}, age));
    ++forgotten_;
  }
  found_.emplace(loser, Conflict{loser, winner, now_});
}

std::vector<Conflict> Conflicts::list(SimTime now) const {
  std::vector<Conflict> all;
  for (const auto& [loser, conflict] : found_) {
    if (conflict.found >= now - kKept) all.push_back(conflict);
  }
  return all;
}

}  // namespace peerd::replication
