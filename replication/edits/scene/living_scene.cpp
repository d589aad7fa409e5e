#include "replication/edits/scene/living_scene.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <limits>
#include <utility>
#include <variant>

#include "core/vrml/document.hpp"

namespace peerd::replication {
namespace {

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};

using Name = std::pair<std::string, ObjectId>;

// The object that the author of an operation saw under a path.
std::optional<ObjectId> meaning(const std::vector<Name>& names, std::string_view path) {
  const auto name = std::ranges::find(names, path, &Name::first);
  return name == names.end() ? std::nullopt : std::optional(name->second);
}

bool contains(const Scene& scene, NodeId node) {
  const vrml::Document& document = *scene.document;
  return document.ids.find(node, document.nodes.size()).has_value();
}

constexpr const char* kUndone = "its author has undone it";
constexpr const char* kGone = "it is not in the scene any more";

// A message that is longer changes no more than any other, but is delivered to nobody.
constexpr std::size_t kTopicMax_bytes = 256, kMessageMax_bytes = std::size_t{16} << 10;

std::expected<void, std::string> check(const SendMessage& message) {
  if (message.topic.empty() || message.topic.size() > kTopicMax_bytes) {
    return std::unexpected("a topic has 1 to " + std::to_string(kTopicMax_bytes) + " bytes, and this one " +
                           std::to_string(message.topic.size()));
  }
  if (message.text.size() > kMessageMax_bytes) {
    return std::unexpected("the text has " + std::to_string(message.text.size()) + " bytes, and may have " +
                           std::to_string(kMessageMax_bytes));
  }
  return {};
}

// No value has more nodes.
constexpr std::uint32_t kOfRefusedValue = ReadLimits{}.nodes;

}  // namespace

LivingScene::LivingScene(const Scene& file, RareBranches rare, OperationBodies bodies, WriterOf writer_of)
    : file_(std::shared_ptr<void>(), &file),
      begin_{file_, {}, std::make_shared<const NodeData>()},
      bodies_(std::move(bodies)),
      now_(begin_),
      conflicts_(
          [this](const Key& key) {
            const auto at = entries_.find(key);
            return at != entries_.end() && at->second.applied && !at->second.refused && !at->second.undone;
          },
          [this](const Key& key) { return bodies_(key); }),
      rare_(std::move(rare)),
      writer_of_(std::move(writer_of)) {}

bool LivingScene::add(Operation operation) {
  assert(operation.id.author != kNoAuthor);
  const Operation known{operation.id, operation.stamp, {}, std::move(operation.knows)};
  static_assert(std::variant_size_v<OperationBody> <= std::numeric_limits<std::uint8_t>::max());
  const auto [at, is_new] = entries_.try_emplace({operation.stamp, operation.id},
                                                 Entry{.kind = static_cast<std::uint8_t>(operation.body.index())});
  if (!is_new) return false;
  if (at->second.is<UndoOperation>()) undos_.insert(at->first);
  if (const auto* const lock = std::get_if<LockObject>(&operation.body)) {
    at->second.unlocks = lock->unlocks;
    lockings_.emplace(at->first, *lock);
  }
  bodies_.keep(at->first, std::move(operation.body));
  conflicts_.add(known);
  due_.insert(at->first);
  if (operation.stamp <= with_all_until_) with_all_.reset();
  return true;
}

ReadOptions LivingScene::reading() const {
  ReadOptions options;
  options.name = "operation";
  options.tessellation = file_->tessellation;
  options.only_vrml = true;
  return options;
}

std::expected<LivingScene::UsedIds, std::string> LivingScene::apply_to(Editing& editing, const OperationBody& body,
                                                                       AuthorId author, const Find& find) const {
  using Result = std::expected<UsedIds, std::string>;
  const auto done = [](const std::expected<void, std::string>& result) {
    return result ? Result(UsedIds{}) : Result(std::unexpect, result.error());
  };
  return std::visit(
      Overloaded{[&](const AddNodes& add) {
                   const SceneEditor::FirstIds first{ObjectId(add.first_object, author.value),
                                                     NodeId(add.first_node, author.value)};
                   const auto added = editing.editor().add(add.text, {add.parent, add.before}, first, reading(), find);
                   return added ? Result(UsedIds{added->objects, added->nodes}) : Result(std::unexpect, added.error());
                 },
                 [&](const RemoveObject& remove) { return done(editing.editor().remove(remove.object)); },
                 [&](const RemoveNode& remove) { return done(editing.editor().remove(remove.node)); },
                 [&](const MoveObject& move) {
                   return done(editing.editor().move(move.object, {move.parent, move.before}));
                 },
                 [&](const SetField& set) {
                   const auto nodes =
                       editing.editor().set(set.node, set.field, set.value, NodeId(set.first_node, author.value));
                   return nodes ? Result(UsedIds{0, *nodes}) : Result(std::unexpect, nodes.error());
                 },
                 [&](const ChangeRoute& route) {
                   SceneEditor& editor = editing.editor();
                   return done(route.removes
                                   ? editor.remove_route(route.from, route.event_out, route.to, route.event_in)
                                   : editor.add_route(route.from, route.event_out, route.to, route.event_in));
                 },
                 [&](const GiveObject& give) { return done(give_to(editing, give)); },
                 [&](const RequestObject& request) {
                   return editing.contains(request.object) ? Result(UsedIds{}) : Result(std::unexpect, kGone);
                 },
                 [](const RefuseRequest&) { return Result(UsedIds{}); },
                 [&](const PlaceObject& place) { return done(place_in(editing, place)); },
                 [&](const SetData& data) { return done(set_data(editing, data)); },
                 [&](const LockObject& lock) { return done(lock_in(editing, lock, author)); },
                 [&](const SendMessage& message) { return done(check(message)); },
                 [](const UndoOperation&) { return Result(UsedIds{}); }},  // it chooses what else is applied
      body);
}

std::expected<void, std::string> LivingScene::give_to(Editing& editing, const GiveObject& give) {
  if (!editing.contains(give.object)) return std::unexpected(kGone);
  const auto known = editing.state.owners.find(give.object);
  const PeerId owner = known == editing.state.owners.end() ? kNobody : known->second;
  if (owner != kNobody && owner != give.before) {
    return std::unexpected("peer " + std::to_string(owner.value) + " owns it by then");
  }
  if (give.placement) {
    const auto placed = editing.editor().set_placement(give.object, *give.placement);
    if (!placed) return placed;
  }
  editing.state.owners[give.object] = give.owner;
  return {};
}

std::expected<void, std::string> LivingScene::place_in(Editing& editing, const PlaceObject& place) {
  if (!editing.contains(place.object)) return std::unexpected(kGone);
  const auto placed = editing.editor().set_placement(place.object, place.placement);
  if (placed) editing.state.left[place.object] = {place.owner, place.at};
  return placed;
}

bool LivingScene::Editing::contains(NodeId node) {
  return scene ? scene->contains(node) : peerd::replication::contains(*state.scene, node);
}

std::expected<void, std::string> LivingScene::set_data(Editing& editing, const SetData& set) {
  if (!editing.contains(set.node)) return std::unexpected(kGone);
  if (set.value) return editing.data().set(set.node, set.key, *set.value);
  editing.data().remove(set.node, set.key);
  return {};
}

std::expected<LivingScene::State, std::string> LivingScene::finish(Editing editing) {
  if (!editing.scene) return std::move(editing.state);
  auto scene = editing.scene->finish();
  if (!scene) return std::unexpected(scene.error());
  editing.state.scene = std::make_shared<const Scene>(*std::move(scene));
  const auto is_gone = [&](const auto& each) { return !editing.state.scene->contains(each.first); };
  std::erase_if(editing.state.owners, is_gone);
  std::erase_if(editing.state.left, is_gone);
  std::erase_if(editing.state.locks, is_gone);
  const auto is_kept = [&](NodeId node) { return contains(*editing.state.scene, node); };
  if (!editing.state.data->are_all(is_kept)) editing.data().keep(is_kept);
  return std::move(editing.state);
}

LivingScene::Applied LivingScene::applied(const State& base, std::span<const Entries::const_iterator> entries,
                                          const Undone& undone) const {
  Applied all{base, {}};
  while (all.effects.size() < entries.size()) apply_run(entries.subspan(all.effects.size()), undone, all);
  return all;
}

LivingScene::Effect LivingScene::apply_one(Editing& editing, Entries::const_iterator at, const Undone& undone) const {
  assert(at != entries_.end());
  const Key& key = at->first;
  const OperationBody body = bodies_(key);
  if (const auto* const undo = std::get_if<UndoOperation>(&body)) {
    const auto locked = undone.locked.find(key);
    if (locked != undone.locked.end()) return Effect{locked->second, {}};
    return target_of(key, *undo) ? Effect{} : Effect{"its author has made no such edit", {}};
  }
  if (std::string why = why_locked(editing, body, key.second.author, {}); !why.empty())
    return Effect{std::move(why), {}};
  const auto* const add = std::get_if<AddNodes>(&body);
  const auto find = [&](std::string_view path) { return meaning(add->names, path); };
  RemovedIds removed;
  if (const auto* const remove = std::get_if<RemoveObject>(&body)) {
    SceneEditor::Below below = editing.editor().below(remove->object);
    removed = {std::move(below.objects), std::move(below.nodes)};
  } else if (const auto* const node = std::get_if<RemoveNode>(&body)) {
    removed.nodes.push_back(node->node);
  }
  const auto used = apply_to(editing, body, key.second.author, add != nullptr ? Find(find) : Find());
  const bool moves_nodes =
      add != nullptr || std::holds_alternative<RemoveObject>(body) || std::holds_alternative<MoveObject>(body);
  if (moves_nodes) editing.locked_nodes.clear();  // a SceneEditor that has set nodes is used for nothing else
  // A node that is used elsewhere, too, is not gone.
  std::erase_if(removed.nodes, [&](NodeId each) { return editing.contains(each); });
  return used ? Effect{{}, *used, std::move(removed)} : Effect{used.error(), {}};
}

void LivingScene::apply_run(std::span<const Entries::const_iterator> entries, const Undone& undone,
                            Applied& all) const {
  Editing editing{all.state};
  std::vector<Effect> effects;
  while (effects.size() < entries.size() && !(editing.scene && editing.scene->may_fail())) {
    const auto at = entries[effects.size()];
    if (undone.edits.contains(at->first)) {
      effects.push_back(Effect{{}, {}, {}, true});
    } else {
      effects.push_back(apply_one(editing, at, undone));
    }
  }
  if (std::ranges::any_of(effects, &std::string::empty, &Effect::refused)) {
    if (auto state = finish(std::move(editing))) {
      all.state = *std::move(state);
    } else if (effects.size() == 1) {
      effects[0].refused = state.error();
    } else {  // The last one makes something impossible: it is refused, and those before it are not.
      const std::size_t last = effects.size() - 1;
      apply_run(entries.first(last), undone, all);
      return apply_run(entries.subspan(last, 1), undone, all);
    }
  }
  std::ranges::move(effects, std::back_inserter(all.effects));
}

LivingScene::Checkpoint LivingScene::checkpoint_before(const Key& key) const {
  const auto after = std::ranges::lower_bound(checkpoints_, key, {}, &Checkpoint::last);
  return after == checkpoints_.begin() ? Checkpoint{{SimTime::min(), {}}, begin_, 0} : *std::prev(after);
}

std::optional<LivingScene::Key> LivingScene::first_to_apply(SimTime until) const {
  if (due_.empty() || due_.begin()->first > until) return anew_;
  return anew_ ? std::min(*anew_, *due_.begin()) : *due_.begin();
}

std::optional<LivingScene::Change> LivingScene::apply(SimTime until, SimTime known) {
  const auto first_anew = first_to_apply(until);
  if (!first_anew) return std::nullopt;
  const Key first = *first_anew;
  const SimTime last = std::max(first.first, std::min(known, until));
  Undone undone = undone_;
  const Key from = follow_undos(last, undone).value_or(first);
  std::erase_if(checkpoints_, [&](const Checkpoint& each) { return !(each.last < from); });
  if (rare_.take(RareBranch::kNoCheckpoint)) checkpoints_.clear();
  const Checkpoint base = checkpoint_before(from);
  std::vector<Entries::const_iterator> entries;
  for (auto at = entries_.upper_bound(base.last); at != entries_.end(); ++at) {
    if (at->first.first <= last || at->second.applied) entries.emplace_back(at);
  }
  Applied next = applied(base.state, entries, undone);
  assert(next.effects.size() == entries.size() && !entries.empty());
  undone_ = std::move(undone);
  anew_.reset();
  Change change{first.first, next.state.scene == now_.scene ? nullptr : next.state.scene};
  for (const auto& [object, owner] : next.state.owners) {
    const auto before = now_.owners.find(object);
    if (before == now_.owners.end() || before->second != owner) change.given.emplace_back(object, owner);
  }
  for (const auto& [object, left] : next.state.left) {
    const auto before = now_.left.find(object);
    if (before == now_.left.end() || before->second != left) change.left.emplace(object, left);
  }
  if (next.state.data != now_.data) change.data = next.state.data->changes_since(*now_.data);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    note_effect(entries_.find(entries[i]->first), std::move(next.effects[i]), change);
  }
  conflicts_.find(until == SimTime::max() ? entries.back()->first.first : until);
  now_ = std::move(next.state);
  if (last > with_all_until_) with_all_.reset();
  checkpoints_.push_back({entries.back()->first, now_, base.count + entries.size()});
  thin_checkpoints();
  assert(std::ranges::is_sorted(checkpoints_, {}, &Checkpoint::last));
  return change;
}

const std::string& LivingScene::reason_of(Entries::const_iterator at) const {
  static const std::string kNone;
  return at->second.refused ? reasons_.at(at->first) : kNone;
}

void LivingScene::set_reason(Entries::iterator at, std::string why) {
  at->second.refused = !why.empty();
  if (why.empty()) {
    reasons_.erase(at->first);
  } else {
    reasons_[at->first] = std::move(why);
  }
}

void LivingScene::note_effect(Entries::iterator at, Effect effect, Change& change) {
  const Key& key = at->first;
  Entry& entry = at->second;
  const bool is_new = !entry.applied, was_refused = entry.refused;
  entry.applied = true;
  due_.erase(key);
  const bool was_undone = std::exchange(entry.undone, effect.undone);
  if (effect.undone) {
    if (!was_undone) conflicts_.on_undone(key);
    if (is_new) set_reason(at, kUndone);
    if (is_new) change.outcomes.push_back({key.second, kUndone});
    return;
  }
  if (entry.is<SendMessage>() && is_new && effect.refused.empty()) {
    change.messages.push_back({key.second, key.first, bodies_(key)});
  }
  if (is_new && effect.refused.empty() && at->second.is<SetField>()) {
    change.fields.push_back(std::get<SetField>(bodies_(key)));
  }
  if (is_new || reason_of(at) != effect.refused) change.outcomes.push_back({key.second, effect.refused});
  set_reason(at, std::move(effect.refused));
  if (!entry.refused) {
    entry.has_done = true;
    if (effect.used.objects > 0 || effect.used.nodes > 0) {
      used_[key] = effect.used;
    } else {
      used_.erase(key);
    }
    const bool comes_into_force = is_new || was_refused || was_undone;
    conflicts_.on_in_force(key, effect.used.objects, std::move(effect.removed), comes_into_force);
  } else if (is_new || !was_refused || was_undone) {
    conflicts_.on_refused(key);
  }
}

// Keeps fewer, the older they are: each is half as old again as the next one, so that there are some log(n) of them and
// a late operation costs about twice as many applications as there are later ones.
void LivingScene::thin_checkpoints() {
  std::vector<Checkpoint> kept;
  const std::size_t newest = checkpoints_.back().count;
  for (auto at = checkpoints_.rbegin(); at != checkpoints_.rend(); ++at) {
    const bool is_needed = kept.size() < 2 || kept.back().count - at->count >= (newest - kept.back().count) / 2;
    if (is_needed) kept.push_back(std::move(*at));
  }
  std::ranges::reverse(kept);
  checkpoints_ = std::move(kept);
}

LivingScene::State LivingScene::all_until(SimTime until, const Key& first, const Undone& undone) const {
  const Checkpoint base = checkpoint_before(first);
  std::vector<Entries::const_iterator> rest;
  for (auto at = entries_.upper_bound(base.last); at != entries_.end() && at->first.first <= until; ++at) {
    rest.emplace_back(at);
  }
  return applied(base.state, rest, undone).state;
}

const LivingScene::State& LivingScene::with_all(SimTime until) {
  const auto first_due = [&](SimTime after) { return due_.upper_bound({after, {AuthorId{~0u}, ~0u}}); };
  const auto next = first_due(with_all_ ? with_all_until_ : SimTime::min());
  if (with_all_ && (next == due_.end() || next->first > until)) return *with_all_;
  with_all_until_ = until;
  const auto first_anew = first_to_apply(until);
  if (!first_anew) return with_all_.emplace(now_);
  Undone undone = undone_;
  const Key first = follow_undos(until, undone).value_or(*first_anew);
  return with_all_.emplace(all_until(until, first, undone));
}

std::expected<LivingScene::Draft, std::string> LivingScene::draft(OperationBody body, AuthorId author, SimTime until) {
  const State& all = with_all(until);
  const Scene& scene = *all.scene;
  Editing editing{all};
  std::vector<Name> names;
  if (std::string why = why_locked(editing, body, author, {}); !why.empty()) return std::unexpected(std::move(why));
  const auto used = apply_to(editing, body, author, [&](std::string_view path) {
    const auto found = scene.find(path);
    if (found) names.emplace_back(path, *found);
    return found;
  });
  if (!used) return std::unexpected(used.error());
  if (const auto finished = finish(std::move(editing)); !finished) return std::unexpected(finished.error());
  std::ranges::sort(names);
  names.erase(std::ranges::unique(names).begin(), names.end());
  if (auto* const add = std::get_if<AddNodes>(&body)) add->names = std::move(names);
  return Draft{std::move(body), used->objects, used->nodes};
}

// If an operation has never done what it says here, its text is read by itself.
LivingScene::NextIds LivingScene::next_ids(AuthorId author) const {
  NextIds next;
  for (const auto& [key, entry] : entries_) {
    if (key.second.author != author || !(entry.is<AddNodes>() || entry.is<SetField>())) continue;
    const auto known = used_.find(key);
    const UsedIds done = known == used_.end() ? UsedIds{} : known->second;
    const OperationBody body = bodies_(key);
    if (const auto* const add = std::get_if<AddNodes>(&body)) {
      const UsedIds used = entry.has_done ? done : ids_in(*add);
      next.object = std::max(next.object, add->first_object + used.objects);
      next.node = std::max(next.node, add->first_node + used.nodes);
    } else if (const auto* const set = std::get_if<SetField>(&body)) {
      next.node = std::max(next.node, set->first_node + (entry.has_done ? done.nodes : kOfRefusedValue));
    }
  }
  return next;
}

LivingScene::UsedIds LivingScene::ids_in(const AddNodes& add) const {
  ReadOptions options = reading();
  options.around.find = [&](std::string_view path) { return meaning(add.names, path); };
  const ReadResult text = read_world(add.text, options);
  if (!text.scene) return {};
  return {static_cast<std::uint32_t>(text.scene->instances.size()),
          static_cast<std::uint32_t>(text.scene->document->nodes.size())};
}

SimTime LivingScene::last_stamp(SimTime until) const {
  const auto after = entries_.upper_bound({until, {AuthorId{~0u}, ~0u}});
  return after == entries_.begin() ? SimTime::min() : std::prev(after)->first.first;
}

}  // namespace peerd::replication
