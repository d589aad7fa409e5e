// Locks of a LivingScene: what they keep from being done, and from being undone.
#include <algorithm>
#include <cassert>
#include <utility>

#include "replication/edits/scene/living_scene.hpp"

namespace peerd::replication {

const Writer& LivingScene::writer(AuthorId author) const {
  auto known = writers_.find(author);
  if (known == writers_.end()) known = writers_.emplace(author, writer_of_(author)).first;
  return known->second;
}

std::string LivingScene::name_of_writer(AuthorId author) const {
  const std::string& name = writer(author).name;
  return name.empty() ? "author " + std::to_string(author.value) : name;
}

void LivingScene::follow_writers() {
  bool differs = false;
  for (auto& [author, known] : writers_) {
    Writer next = writer_of_(author);
    differs |= next != known;
    known = std::move(next);
  }
  const bool has_locks = !lockings_.empty() && entries_.at(lockings_.begin()->first).applied;
  if (!differs || !has_locks) return;
  anew_ = anew_ ? std::min(*anew_, lockings_.begin()->first) : lockings_.begin()->first;
  with_all_.reset();
}

std::expected<void, std::string> LivingScene::lock_in(Editing& editing, const LockObject& lock, AuthorId author) const {
  if (!editing.contains(lock.object)) return std::unexpected("it is not in the scene any more");
  Locks& locks = editing.state.locks;
  if (!writer(author).may_lock) return std::unexpected("administrators alone lock and unlock");
  if (lock.unlocks) {
    return locks.erase(lock.object) > 0 ? std::expected<void, std::string>() : std::unexpected("it is not locked");
  }
  if (locks.contains(lock.object)) return std::unexpected("it is locked already");
  if (locks.size() >= kLocksMax) {
    return std::unexpected("no more than " + std::to_string(kLocksMax) + " objects are locked at once");
  }
  locks.emplace(lock.object, author);
  return {};
}

bool LivingScene::is_inside(Editing& editing, ObjectId locked, NodeId node) {
  auto known = editing.locked_nodes.find(locked);
  if (known == editing.locked_nodes.end()) {
    known = editing.locked_nodes.emplace(locked, editing.structure().below(locked).nodes).first;
  }
  return std::ranges::binary_search(known->second, node);
}

bool LivingScene::touches(Editing& editing, ObjectId locked, const OperationBody& body, AuthorId author,
                          const UsedIds& added) {
  const auto is_in = [&](ObjectId object) { return editing.structure().is_within(object, locked); };
  const auto is_around = [&](ObjectId object) {
    return is_in(object) || editing.structure().is_within(locked, object);
  };
  if (const auto* const add = std::get_if<AddNodes>(&body)) {
    if (add->parent && is_in(*add->parent)) return true;
    for (std::uint32_t i = 0; i < added.objects; ++i) {
      if (is_around(ObjectId(add->first_object + i, author.value))) return true;
    }
    return false;
  }
  if (const auto* const move = std::get_if<MoveObject>(&body)) {
    return is_in(move->object) || (move->parent && is_in(*move->parent));
  }
  if (const auto* const route = std::get_if<ChangeRoute>(&body)) {
    return is_inside(editing, locked, route->from) || is_inside(editing, locked, route->to);
  }
  if (const auto* const remove = std::get_if<RemoveObject>(&body)) return is_around(remove->object);
  if (const auto* const remove = std::get_if<RemoveNode>(&body)) return is_inside(editing, locked, remove->node);
  if (const auto* const set = std::get_if<SetField>(&body)) return is_inside(editing, locked, set->node);
  if (const auto* const set = std::get_if<SetData>(&body)) return is_inside(editing, locked, set->node);
  if (const auto* const give = std::get_if<GiveObject>(&body)) return is_in(give->object);
  if (const auto* const request = std::get_if<RequestObject>(&body)) return is_in(request->object);
  if (const auto* const place = std::get_if<PlaceObject>(&body)) return is_in(place->object);
  if (const auto* const lock = std::get_if<LockObject>(&body)) return !lock->unlocks && is_around(lock->object);
  return false;
}

std::string LivingScene::why_locked(Editing& editing, const OperationBody& body, AuthorId author,
                                    const UsedIds& added) const {
  if (editing.state.locks.empty() || writer(author).overrules) return {};
  for (const auto& [object, by] : editing.state.locks) {
    if (is_one_writer(by, author) || !touches(editing, object, body, author, added)) continue;
    return "it is locked by " + name_of_writer(by);
  }
  return {};
}

std::optional<ObjectId> LivingScene::lock_around(ObjectId object) const {
  if (now_.locks.empty()) return std::nullopt;
  const Scene& scene = *now_.scene;
  const auto index = scene.ids.find(object, scene.instances.size());
  for (std::int64_t at = index ? std::int64_t{*index} : -1; at >= 0;) {
    const auto place = static_cast<std::uint32_t>(at);
    if (now_.locks.contains(scene.id_of(place))) return scene.id_of(place);
    at = scene.instances[place].parent;
  }
  return std::nullopt;
}

std::string LivingScene::why_locked(ObjectId object, AuthorId author) const {
  if (now_.locks.empty()) return {};
  Editing editing{now_};
  return why_locked(editing, RequestObject{object, {}, {}}, author, {});
}

// Whether a lock by another writer may be in force there. False is certain; true where it takes the scene to say.
bool LivingScene::may_be_locked(const Key& at, const Undone& undone) const {
  const Writer& own = writer(at.second.author);
  if (own.overrules) return false;
  std::map<ObjectId, bool> locked;
  for (const auto& [key, lock] : lockings_) {
    if (!(key < at)) break;
    const Writer& by = writer(key.second.author);
    if (!by.may_lock || undone.edits.contains(key)) continue;
    bool& by_another = locked[lock.object];
    by_another = !lock.unlocks && (by_another || by.user != own.user);
  }
  return std::ranges::any_of(locked, &std::pair<const ObjectId, bool>::second);
}

// An undone thing may be gone, and a redone one not there yet: both scenes are asked.
std::string LivingScene::why_undo_locked(const Key& target, const State& before, const State& after) const {
  if (lockings_.empty()) return {};
  const OperationBody body = bodies_(target);
  UsedIds added;
  if (const auto* const add = std::get_if<AddNodes>(&body)) {
    const auto used = used_.find(target);
    added = used == used_.end() ? ids_in(*add) : used->second;
  }
  for (const State* const state : {&before, &after}) {
    Editing editing{*state};
    if (std::string why = why_locked(editing, body, target.second.author, added); !why.empty()) return why;
  }
  return {};
}

// The outcome of all operations before a key.
LivingScene::State LivingScene::all_before(const Key& end, SimTime until, const Key& first,
                                           const Undone& undone) const {
  const auto [was, is] = std::ranges::mismatch(undone_.edits, undone.edits);
  Key from = first;  // what is before it is as in the checkpoints
  if (was != undone_.edits.end()) from = std::min(from, *was);
  if (is != undone.edits.end()) from = std::min(from, *is);
  const Checkpoint base = checkpoint_before(from);
  std::vector<Entries::const_iterator> rest;
  for (auto at = entries_.upper_bound(base.last); at != entries_.end() && at->first < end; ++at) {
    if (at->first.first <= until || at->second.applied) rest.emplace_back(at);
  }
  return applied(base.state, rest, undone).state;
}

// An undo counts where no lock that is in force before it keeps its author from what it changes. That depends on the
// scene before it, which depends on the undos before it: so they are followed one after the other, from the first
// operation on that is new.
void LivingScene::follow_checked_undos(SimTime until, const Key& first, Undone& undone) const {
  const auto begin = undos_.lower_bound(first);
  const auto target_at = [&](const Key& key, bool& redoes) {
    const auto undo = std::get<UndoOperation>(bodies_(key));
    redoes = undo.redoes;
    return target_of(key, undo);
  };
  bool redoes = false;
  if (std::any_of(begin, undos_.end(), [&](const Key& key) { return entries_.at(key).applied; })) {
    undone.edits.clear();
    for (auto key = undos_.begin(); key != begin; ++key) {
      if (!entries_.at(*key).applied || undone.locked.contains(*key)) continue;
      if (const auto target = target_at(*key, redoes)) (void)undone.follow(*target, redoes);
    }
  }
  undone.locked.erase(undone.locked.lower_bound(first), undone.locked.end());
  for (auto key = begin; key != undos_.end(); ++key) {
    if (key->first > until && !entries_.at(*key).applied) continue;
    const auto target = target_at(*key, redoes);
    if (!target || undone.edits.contains(*target) != redoes) continue;
    if (may_be_locked(*key, undone)) {
      const State before = all_before(*key, until, first, undone);
      (void)undone.follow(*target, redoes);
      std::string why = why_undo_locked(*target, before, all_before(*key, until, first, undone));
      if (why.empty()) continue;
      (void)undone.follow(*target, !redoes);
      undone.locked.emplace(*key, std::move(why));
    } else {
      (void)undone.follow(*target, redoes);
    }
  }
}

}  // namespace peerd::replication
