#include "core/writer/path_rewriter.hpp"

#include <algorithm>
#include <set>

#include "core/vrml/path_text.hpp"

namespace peerd::vrml {
namespace {

bool has_paths(const Node& node) {
  return node.type->role == NodeRole::kCollisionInterest || node.type->role == NodeRole::kKeySensor;
}

}  // namespace

PathRewriter::PathRewriter(const Scene& scene)
    : scene_(scene), first_instance_(scene.document->nodes.size(), Instance::kNone) {
  const Document& document = *scene.document;
  std::set<std::uint32_t> scopes;
  for (const Node& node : document.nodes) {
    if (!has_paths(node)) continue;
    has_paths_ = true;
    if (node.scope != 0) scopes.insert(node.scope);
  }
  for (const InnerName& inner : document.inner_names) {
    if (scopes.contains(inner.scope)) inner_nodes_.emplace(std::pair(inner.scope, inner.name), inner.node);
  }
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (first_instance_[instance.node] == Instance::kNone) first_instance_[instance.node] = i;
    if (instance.def.empty()) continue;
    const std::uint32_t scope = document.nodes[instance.node].scope;
    if (scope == 0) first_of_name_.emplace(instance.def, i);
    if (scopes.contains(scope)) inner_instances_.emplace(std::pair(scope, instance.def), i);
  }
}

std::optional<std::uint32_t> PathRewriter::first_in_world_scope(std::string_view name) const {
  const auto it = first_of_name_.find(name);
  return it == first_of_name_.end() ? std::nullopt : std::optional(it->second);
}

std::optional<std::uint32_t> PathRewriter::instance_of(std::string_view path, std::uint32_t scope) const {
  if (scope != 0) {
    if (const auto it = inner_nodes_.find({scope, path}); it != inner_nodes_.end()) {
      const std::uint32_t first = first_instance_[it->second];
      return first == Instance::kNone ? std::nullopt : std::optional(first);
    }
    if (const auto it = inner_instances_.find({scope, path}); it != inner_instances_.end()) return it->second;
  }
  if (const auto first = first_in_world_scope(path); first && !is_index(path)) return first;
  const auto id = paths_.find(path);
  return id ? std::optional(scene_.index_of(*id)) : std::nullopt;
}

bool PathRewriter::has_no_target(const Node& node) const {
  if (node.type->role != NodeRole::kCollisionInterest) return false;
  const Field* const path = node.find("objectPath");
  if (path == nullptr) return true;
  const std::string_view text = path->as<std::string_view>()[0];
  if (instance_of(text, node.scope)) return false;
  const auto parts = parts_of_pattern(text);
  return !parts || (!parts->below.empty() && !instance_of(parts->below, node.scope));
}

void PathRewriter::rename(const std::vector<std::string_view>& names, const std::vector<bool>& written) {
  if (!has_paths_) return;
  renamed_.instances = scene_.instances;
  auto& instances = renamed_.instances;
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    Instance& instance = instances[i];
    if (written[instance.node]) {
      instance.def = names[instance.node];
      instance.inner_name = false;
    }
    if (!instance.def.empty() && !instance.inner_name) first_renamed_.emplace(instance.def, i);
  }
  std::set<std::pair<std::int32_t, std::string_view>> siblings;
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    Instance& instance = instances[i];
    instance.name_shadowed = !instance.def.empty() && !siblings.emplace(instance.parent, instance.def).second;
    if (instance.parent < 0 && !instance.def.empty()) {
      const auto it = first_renamed_.find(instance.def);
      instance.name_shadowed |= it == first_renamed_.end() || it->second != i;
    }
  }
}

std::optional<std::uint32_t> PathRewriter::renamed_instance_of(std::string_view path) const {
  if (const auto it = first_renamed_.find(path); it != first_renamed_.end()) return it->second;
  const auto id = renamed_paths_.find(path);
  return id ? std::optional(renamed_.index_of(*id)) : std::nullopt;
}

std::optional<std::string> PathRewriter::rewritten(std::string_view path, std::uint32_t scope) const {
  const auto id = instance_of(path, scope);
  if (!id) {
    const auto pattern = parts_of_pattern(path);
    if (!pattern) return std::nullopt;
    if (pattern->below.empty()) return std::string(path);
    const auto below = rewritten(pattern->below, scope);
    return below ? std::optional(*below + '/' + std::string(pattern->path)) : std::nullopt;
  }
  if (renamed_instance_of(path) == id) return std::string(path);
  std::string by_names = renamed_.path_of(renamed_.id_of(*id));
  if (renamed_instance_of(by_names) == id) return by_names;
  // A name with a '/' in it may be mistaken for a path; numbers never are.
  std::string by_numbers;
  for (auto i = static_cast<std::int32_t>(*id); i >= 0; i = scene_.instances[static_cast<std::size_t>(i)].parent) {
    const std::string number = std::to_string(scene_.instances[static_cast<std::size_t>(i)].child_index);
    by_numbers = by_numbers.empty() ? number : number + '/' + by_numbers;
  }
  return by_numbers;
}

}  // namespace peerd::vrml
