#include "replication/scene/living_scene.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>
#include <variant>

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

constexpr const char* kGone = "it is not in the scene any more";

// No value has more nodes.
constexpr std::uint32_t kOfRefusedValue = ReadLimits{}.nodes;

}  // namespace

LivingScene::LivingScene(const Scene& file) : file_(std::shared_ptr<void>(), &file), now_{file_, {}} {}

bool LivingScene::add(Operation operation) {
  assert(operation.id.author != kNoAuthor);
  const auto [at, is_new] =
      entries_.try_emplace({operation.stamp, operation.id}, Entry{std::move(operation.body), false, {}, {}});
  if (!is_new) return false;
  due_.insert(at->first);
  with_all_.reset();
  return true;
}

ReadOptions LivingScene::reading() const {
  ReadOptions options;
  options.name = "operation";
  options.tessellation = file_->tessellation;
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
                 [&](const PlaceObject& place) { return done(place_in(editing, place)); }},
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

std::expected<LivingScene::State, std::string> LivingScene::finish(Editing editing) {
  if (!editing.scene) return std::move(editing.state);
  auto scene = editing.scene->finish();
  if (!scene) return std::unexpected(scene.error());
  editing.state.scene = std::make_shared<const Scene>(*std::move(scene));
  const auto is_gone = [&](const auto& each) { return !editing.state.scene->contains(each.first); };
  std::erase_if(editing.state.owners, is_gone);
  std::erase_if(editing.state.left, is_gone);
  return std::move(editing.state);
}

LivingScene::Applied LivingScene::applied(const State& base, std::span<const Entries::const_iterator> entries) const {
  Applied all{base, {}};
  while (all.effects.size() < entries.size()) apply_run(entries.subspan(all.effects.size()), all);
  return all;
}

void LivingScene::apply_run(std::span<const Entries::const_iterator> entries, Applied& all) const {
  Editing editing{all.state};
  std::vector<Effect> effects;
  while (effects.size() < entries.size() && !(editing.scene && editing.scene->may_fail())) {
    const auto at = entries[effects.size()];
    const OperationBody& body = at->second.body;
    const auto* const add = std::get_if<AddNodes>(&body);
    const auto find = [&](std::string_view path) { return meaning(add->names, path); };
    const auto used = apply_to(editing, body, at->first.second.author, add != nullptr ? Find(find) : Find());
    effects.push_back(used ? Effect{{}, *used} : Effect{used.error(), {}});
  }
  if (std::ranges::any_of(effects, &std::string::empty, &Effect::refused)) {
    if (auto state = finish(std::move(editing))) {
      all.state = *std::move(state);
    } else if (effects.size() == 1) {
      effects[0].refused = state.error();
    } else {  // The last one makes something impossible: it is refused, and those before it are not.
      const std::size_t last = effects.size() - 1;
      apply_run(entries.first(last), all);
      return apply_run(entries.subspan(last, 1), all);
    }
  }
  std::ranges::move(effects, std::back_inserter(all.effects));
}

LivingScene::Checkpoint LivingScene::checkpoint_before(const Key& key) const {
  const auto after = std::ranges::lower_bound(checkpoints_, key, {}, &Checkpoint::last);
  return after == checkpoints_.begin() ? Checkpoint{{SimTime::min(), {}}, {file_, {}}, 0} : *std::prev(after);
}

std::optional<LivingScene::Change> LivingScene::apply(SimTime until, SimTime known) {
  if (due_.empty() || due_.begin()->first > until) return std::nullopt;
  const Key first = *due_.begin();
  const SimTime last = std::max(first.first, std::min(known, until));
  std::erase_if(checkpoints_, [&](const Checkpoint& each) { return !(each.last < first); });
  const Checkpoint base = checkpoint_before(first);
  std::vector<Entries::const_iterator> entries;
  for (auto at = entries_.upper_bound(base.last); at != entries_.end(); ++at) {
    if (at->first.first <= last || at->second.applied) entries.emplace_back(at);
  }
  Applied next = applied(base.state, entries);
  Change change{first.first, next.state.scene == now_.scene ? nullptr : next.state.scene};
  for (const auto& [object, owner] : next.state.owners) {
    const auto before = now_.owners.find(object);
    if (before == now_.owners.end() || before->second != owner) change.given.emplace_back(object, owner);
  }
  for (const auto& [object, left] : next.state.left) {
    const auto before = now_.left.find(object);
    if (before == now_.left.end() || before->second != left) change.left.emplace(object, left);
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto at = entries_.find(entries[i]->first);
    Entry& entry = at->second;
    Effect& effect = next.effects[i];
    if (!entry.applied || entry.refused != effect.refused)
      change.outcomes.push_back({at->first.second, effect.refused});
    if (effect.refused.empty()) entry.used = effect.used;
    entry = {std::move(entry.body), true, std::move(effect.refused), entry.used};
    due_.erase(at->first);
  }
  now_ = std::move(next.state);
  checkpoints_.push_back({entries.back()->first, now_, base.count + entries.size()});
  thin_checkpoints();
  assert(std::ranges::is_sorted(checkpoints_, {}, &Checkpoint::last));
  return change;
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

std::expected<LivingScene::Draft, std::string> LivingScene::draft(OperationBody body, AuthorId author) {
  if (!with_all_ && due_.empty()) with_all_ = now_;
  if (!with_all_) {
    const Checkpoint base = checkpoint_before(*due_.begin());
    std::vector<Entries::const_iterator> rest;
    for (auto at = entries_.upper_bound(base.last); at != entries_.end(); ++at) rest.emplace_back(at);
    with_all_ = applied(base.state, rest).state;
  }
  const Scene& scene = *with_all_->scene;
  Editing editing{*with_all_};
  std::vector<Name> names;
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
    if (key.second.author != author) continue;
    if (const auto* const add = std::get_if<AddNodes>(&entry.body)) {
      const UsedIds used = entry.used ? *entry.used : ids_in(*add);
      next.object = std::max(next.object, add->first_object + used.objects);
      next.node = std::max(next.node, add->first_node + used.nodes);
    } else if (const auto* const set = std::get_if<SetField>(&entry.body)) {
      next.node = std::max(next.node, set->first_node + (entry.used ? entry.used->nodes : kOfRefusedValue));
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
