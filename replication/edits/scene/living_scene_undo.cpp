// Undo and redo of a LivingScene.
#include <algorithm>
#include <cassert>

#include "core/writer/writer.hpp"
#include "replication/edits/scene/living_scene.hpp"

namespace peerd::replication {
namespace {

// Others' edits may have made all of so many meaningless; nobody means what lies behind.
constexpr std::size_t kPassedOverMax = 16;

// By the index of its body.
bool can_be_undone(std::uint8_t kind) {
  return kind == kIndexOf<AddNodes> || kind == kIndexOf<RemoveObject> || kind == kIndexOf<RemoveNode> ||
         kind == kIndexOf<MoveObject> || kind == kIndexOf<SetField> || kind == kIndexOf<ChangeRoute> ||
         kind == kIndexOf<SetData> || kind == kIndexOf<LockObject>;
}

// Whether the scene looks to people as one of that text does, which a file of it would have.
bool is_alike(const Scene& scene, const std::optional<std::string>& text) {
  const auto own = write_world(scene);
  return own && text && own->text == *text;
}

}  // namespace

std::optional<LivingScene::Key> LivingScene::target_of(const Key& key, const UndoOperation& undo) const {
  const Key target{undo.stamp, {key.second.author, undo.number}};
  const auto at = entries_.find(target);
  if (!(target < key) || at == entries_.end() || !can_be_undone(at->second.kind)) return std::nullopt;
  // Others' work since would be void if it were locked again from then on.
  if (at->second.is<LockObject>() && (at->second.unlocks || undo.redoes)) return std::nullopt;
  return target;
}

// Undos of one operation are all by its author, so that they come, and are due, in the order of its log.
std::optional<LivingScene::Key> LivingScene::follow_undos(SimTime until, Undone& undone) const {
  std::optional<Key> first = first_to_apply(until);
  const bool is_checked = !lockings_.empty() && !undos_.empty() && lockings_.begin()->first < *undos_.rbegin();
  if (first && is_checked) {
    const std::set<Key> before = undone.edits;
    follow_checked_undos(until, *first, undone);
    const auto [was, is] = std::ranges::mismatch(before, undone.edits);
    if (was != before.end()) first = std::min(*first, *was);
    if (is != undone.edits.end()) first = std::min(*first, *is);
    return first;
  }
  for (auto key = due_.begin(); key != due_.end() && key->first <= until; ++key) {
    if (!entries_.at(*key).is<UndoOperation>()) continue;
    const auto undo = std::get<UndoOperation>(bodies_(*key));
    const auto target = target_of(*key, undo);
    if (!target) continue;
    if (undone.follow(*target, undo.redoes)) first = std::min(*first, *target);
  }
  return first;
}

std::optional<OperationBody> LivingScene::find(const OperationKey& key) const {
  return entries_.contains(key) ? std::optional(bodies_(key)) : std::nullopt;
}

// Returns the author's edits that can be undone or redone, the last one first.
std::vector<LivingScene::Key> LivingScene::undo_candidates(AuthorId author, bool redoes, const Undone& all) const {
  std::vector<Key> done, undone;
  for (const auto& [key, entry] : entries_) {
    if (key.second.author != author || all.locked.contains(key) || entry.unlocks) continue;
    if (entry.is<UndoOperation>()) {
      const auto undo = std::get<UndoOperation>(bodies_(key));
      const auto target = target_of(key, undo);
      if (!target) continue;
      std::erase(undo.redoes ? undone : done, *target);
      (undo.redoes ? done : undone).push_back(*target);
    } else if (can_be_undone(entry.kind)) {
      done.push_back(key);
      undone.clear();
    }
  }
  std::vector<Key>& chosen = redoes ? undone : done;
  if (redoes) std::erase_if(chosen, [&](const Key& key) { return entries_.at(key).is<LockObject>(); });
  if (!redoes) std::ranges::sort(chosen);  // what was redone counts as old as it is
  std::ranges::reverse(chosen);
  assert(std::ranges::all_of(chosen, [&](const Key& key) { return key.second.author == author; }));
  return chosen;
}

// Returns why an undo or redo that leads from the one state to the other is none; empty: it is one.
std::string LivingScene::why_not_undo(const Key& target, bool redoes, const State& before,
                                      const std::optional<std::string>& text_before, const State& after) const {
  const Entry& entry = entries_.at(target);
  assert(can_be_undone(entry.kind) && before.scene && after.scene);
  const bool removes = redoes ? entry.is<RemoveObject>() : entry.is<AddNodes>();
  if (!removes) {
    for (std::uint32_t i = 0; i < before.scene->instances.size(); ++i) {
      if (!after.scene->contains(before.scene->id_of(i))) return "where it stood is not in the scene any more";
    }
  }
  const bool same_data = after.data->changes_since(*before.data).empty() && after.locks == before.locks;
  return same_data && is_alike(*after.scene, text_before) ? "others have changed since what it had changed" : "";
}

std::expected<LivingScene::Undoing, std::string> LivingScene::next_undo(AuthorId author, bool redoes, SimTime until) {
  const State before = with_all(until);
  Undone all_undone = undone_;
  const auto first_due = follow_undos(until, all_undone);
  std::string why = redoes ? "this peer has undone nothing since its last edit" : "this peer has no edit to undo";
  std::size_t tries = 0;
  const auto written = write_world(*before.scene);
  const std::optional<std::string> text_before = written ? std::optional(written->text) : std::nullopt;
  for (const Key& target : undo_candidates(author, redoes, all_undone)) {
    if (++tries > kPassedOverMax) break;
    Undone undone = all_undone;
    (void)undone.follow(target, redoes);
    const State after = all_until(until, first_due ? std::min(*first_due, target) : target, undone);
    const std::string refused = why_not_undo(target, redoes, before, text_before, after);
    if (refused.empty()) {
      // Not passed over: who undoes means this edit, and can have that once it is unlocked.
      std::string locked = why_undo_locked(target, before, after);
      if (!locked.empty()) return std::unexpected(std::move(locked));
      return Undoing{{target.second.number, target.first, redoes}, bodies_(target)};
    }
    if (tries == 1) why = refused;
  }
  return std::unexpected(why);
}

}  // namespace peerd::replication
