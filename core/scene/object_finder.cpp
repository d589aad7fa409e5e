#include "core/scene/object_finder.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/suggestion.hpp"
#include "core/vrml/path_text.hpp"

namespace peerd::vrml {

ObjectFinder::ObjectFinder(const Document& document, const Scene& scene, const NameTable<std::uint32_t>& name_numbers,
                           const std::vector<std::uint32_t>& first_of_name, Problems& problems, const Around& around)
    : document_(document),
      scene_(scene),
      name_numbers_(name_numbers),
      first_of_name_(first_of_name),
      problems_(problems),
      around_(around),
      paths_(scene),
      unreadable_names_(document.unreadable_names.begin(), document.unreadable_names.end()) {}

// Gathers the names inside PROTOs and Inlines: the first instance of each name in each scope.
void ObjectFinder::gather_inner_names() {
  std::vector<std::uint32_t> first_of_node(document_.nodes.size(), Instance::kNone);
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const Instance& instance = scene_.instances[i];
    if (first_of_node[instance.node] == Instance::kNone) first_of_node[instance.node] = i;
    const std::uint32_t scope = document_.nodes[instance.node].scope;
    if (!instance.def.empty() && scope != 0) inner_names_.try_emplace({scope, instance.def}, i);
  }
  for (const InnerName& inner : document_.inner_names) {
    if (first_of_node[inner.node] != Instance::kNone)
      inner_names_[{inner.scope, inner.name}] = first_of_node[inner.node];
  }
}

std::optional<ObjectId> ObjectFinder::find(std::string_view path, std::uint32_t scope) {
  const std::optional<std::string> in_quotes = unquoted(path);
  const std::string_view name = in_quotes ? std::string_view(*in_quotes) : path;
  if (scope != 0) {
    if (!std::exchange(gathered_, true)) gather_inner_names();
    if (const auto it = inner_names_.find({scope, name}); it != inner_names_.end()) return scene_.id_of(it->second);
  }
  if (const std::uint32_t* number = name_numbers_.find(name);
      number != nullptr && (in_quotes || !is_index(path)) && first_of_name_[*number] != Instance::kNone) {
    return scene_.id_of(first_of_name_[*number]);
  }
  if (const auto id = paths_.find(path)) return id;
  return around_.find ? around_.find(path) : std::nullopt;
}

std::optional<ObjectId> ObjectFinder::find(std::string_view path, std::uint32_t scope, Position at) {
  if (problems_.full()) return std::nullopt;
  if (const auto id = find(path, scope)) return id;
  const std::string_view first = path.substr(0, path.find('/'));
  if (unreadable_names_.contains(first)) return std::nullopt;
  const auto named = std::ranges::find(document_.nodes, path, &Node::def);
  if (named != document_.nodes.end() && !path.empty()) {
    problems_.error(at,
                    quoted(path) + " is a " + std::string(named->type->name) + ", not a group or Shape of the scene");
    return std::nullopt;
  }
  Suggestion suggestion(path);
  if (first_of_name_.size() <= kMaxSuggestionNames) {
    for (const auto& [name, number] : name_numbers_) suggestion.consider(name);
  }
  problems_.error(at, "no node of the scene is named " + quoted(path) + did_you_mean(suggestion));
  return std::nullopt;
}

}  // namespace peerd::vrml
