#include "replication/scene/living_scene.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace peerd::replication {
namespace {

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};

LivingScene::Draft unchanged(const OperationBody& body) { return {body, 0, 0}; }

}  // namespace

LivingScene::LivingScene(const Scene& file) : file_(std::shared_ptr<void>(), &file), scene_(file_) {}

bool LivingScene::add(Operation operation) {
  assert(operation.id.author != kNoAuthor);
  const auto [at, is_new] =
      entries_.try_emplace({operation.stamp, operation.id}, Entry{std::move(operation.body), false, {}});
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

// Returns what the paths in a text mean that name nothing in it: where the scene has it.
std::vector<std::pair<std::string, ObjectId>> LivingScene::names_in(std::string_view text, const Scene& scene) const {
  std::vector<std::pair<std::string, ObjectId>> names;
  ReadOptions options = reading();
  options.around.find = [&](std::string_view path) {
    const auto found = scene.find(path);
    if (found) names.emplace_back(path, *found);
    return found;
  };
  (void)read_world(text, options);  // what is wrong with it, the editor says
  std::ranges::sort(names);
  names.erase(std::ranges::unique(names).begin(), names.end());
  return names;
}

// Applies one operation to the editor, or says why it cannot be. The draft has the body with what the editor has found.
std::expected<LivingScene::Draft, std::string> LivingScene::apply_to(SceneEditor& editor, const OperationBody& body,
                                                                     AuthorId author) const {
  const auto done = [&](const std::expected<void, std::string>& result) -> std::expected<Draft, std::string> {
    if (!result) return std::unexpected(result.error());
    return unchanged(body);
  };
  return std::visit(
      Overloaded{[&](const AddNodes& add) -> std::expected<Draft, std::string> {
                   const auto find = [&](std::string_view path) -> std::optional<ObjectId> {
                     const auto name = std::ranges::find(add.names, path, &std::pair<std::string, ObjectId>::first);
                     return name == add.names.end() ? std::nullopt : std::optional(name->second);
                   };
                   const SceneEditor::FirstIds first{ObjectId(add.first_object, author.value),
                                                     NodeId(add.first_node, author.value)};
                   const auto added = editor.add(add.text, {add.parent, add.before}, first, reading(), find);
                   if (!added) return std::unexpected(added.error());
                   return Draft{body, added->objects, added->nodes};
                 },
                 [&](const RemoveObject& remove) { return done(editor.remove(remove.object)); },
                 [&](const RemoveNode& remove) { return done(editor.remove(remove.node)); },
                 [&](const MoveObject& move) {
                   return done(editor.move(move.object, {move.parent, move.before}));
                 },
                 [&](const SetField& set) -> std::expected<Draft, std::string> {
                   const auto nodes = editor.set(set.node, set.field, set.value, NodeId(set.first_node, author.value));
                   if (!nodes) return std::unexpected(nodes.error());
                   return Draft{body, 0, *nodes};
                 },
                 [&](const ChangeRoute& route) {
                   return done(route.removes
                                   ? editor.remove_route(route.from, route.event_out, route.to, route.event_in)
                                   : editor.add_route(route.from, route.event_out, route.to, route.event_in));
                 }},
      body);
}

LivingScene::Applied LivingScene::applied(const std::shared_ptr<const Scene>& base,
                                          std::span<const Entries::const_iterator> entries) const {
  const auto apply_one = [&](SceneEditor& editor, Entries::const_iterator at) {
    const auto result = apply_to(editor, at->second.body, at->first.second.author);
    return result ? std::string() : result.error();
  };
  Applied all{base, {}};
  SceneEditor editor(*base);
  for (const auto at : entries) all.refused.push_back(apply_one(editor, at));
  if (std::ranges::none_of(all.refused, &std::string::empty)) return all;
  if (auto scene = editor.finish()) {
    all.scene = std::make_shared<const Scene>(*std::move(scene));
    return all;
  }
  // Together they make something impossible: one at a time finds which.
  for (std::size_t i = 0; i < entries.size(); ++i) {
    SceneEditor single(*all.scene);
    all.refused[i] = apply_one(single, entries[i]);
    if (!all.refused[i].empty()) continue;
    if (auto next = single.finish()) {
      all.scene = std::make_shared<const Scene>(*std::move(next));
    } else {
      all.refused[i] = next.error();
    }
  }
  return all;
}

LivingScene::Checkpoint LivingScene::checkpoint_before(const Key& key) const {
  const auto after = std::ranges::lower_bound(checkpoints_, key, {}, &Checkpoint::last);
  return after == checkpoints_.begin() ? Checkpoint{{SimTime::min(), {}}, file_, 0} : *std::prev(after);
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
  Applied next = applied(base.scene, entries);
  Change change{first.first, next.scene == scene_ ? nullptr : next.scene, {}};
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto at = entries_.find(entries[i]->first);
    Entry& entry = at->second;
    if (!entry.applied || entry.refused != next.refused[i])
      change.outcomes.push_back({at->first.second, next.refused[i]});
    entry = {std::move(entry.body), true, std::move(next.refused[i])};
    due_.erase(at->first);
  }
  scene_ = std::move(next.scene);
  checkpoints_.push_back({entries.back()->first, scene_, base.count + entries.size()});
  thin_checkpoints();
  assert(std::ranges::is_sorted(checkpoints_, {}, &Checkpoint::last));
  return change;
}

// Keeps fewer, the older they are: a late operation costs as many applications as it is old, and there are no more than
// some log2(n) checkpoints.
void LivingScene::thin_checkpoints() {
  std::vector<Checkpoint> kept;
  const std::size_t newest = checkpoints_.back().count;
  for (auto at = checkpoints_.rbegin(); at != checkpoints_.rend(); ++at) {
    const std::size_t age = newest - at->count;
    if (kept.size() < 2 || kept.back().count - at->count >= (newest - kept.back().count) / 2 || age == 0) {
      kept.push_back(std::move(*at));
    }
  }
  std::ranges::reverse(kept);
  checkpoints_ = std::move(kept);
}

std::expected<LivingScene::Draft, std::string> LivingScene::draft(OperationBody body, AuthorId author) {
  if (!with_all_ && due_.empty()) with_all_ = scene_;
  if (!with_all_) {
    const Checkpoint base = checkpoint_before(*due_.begin());
    std::vector<Entries::const_iterator> rest;
    for (auto at = entries_.upper_bound(base.last); at != entries_.end(); ++at) rest.emplace_back(at);
    with_all_ = applied(base.scene, rest).scene;
  }
  const Scene& scene = **with_all_;
  if (auto* const add = std::get_if<AddNodes>(&body)) add->names = names_in(add->text, scene);
  SceneEditor editor(scene);
  auto result = apply_to(editor, body, author);
  if (!result) return result;
  if (const auto finished = editor.finish(); !finished) return std::unexpected(finished.error());
  return result;
}

SimTime LivingScene::last_stamp(SimTime until) const {
  const auto after = entries_.upper_bound({until, {AuthorId{~0u}, ~0u}});
  return after == entries_.begin() ? SimTime::min() : std::prev(after)->first.first;
}

}  // namespace peerd::replication
