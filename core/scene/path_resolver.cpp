#include "core/scene/path_resolver.hpp"

#include <algorithm>
#include <charconv>

namespace peerd::vrml {

const PathResolver::Siblings& PathResolver::children_of(std::int32_t parent) {
  const auto [it, is_new] = children_.try_emplace(parent);
  if (!is_new) return it->second;
  const auto& instances = scene_.instances;
  const std::uint32_t end = parent < 0 ? static_cast<std::uint32_t>(instances.size())
                                       : instances[static_cast<std::size_t>(parent)].subtree_end;
  for (auto i = static_cast<std::uint32_t>(parent + 1); i < end; i = instances[i].subtree_end) {
    it->second.in_order.push_back(i);
    if (!instances[i].def.empty() && it->second.by_name.find(instances[i].def) == nullptr) {
      it->second.by_name[instances[i].def] = i;
    }
  }
  return it->second;
}

// Finds the first sibling that has the component as its name or number: a name may be made of digits.
std::optional<std::uint32_t> PathResolver::child(std::int32_t parent, std::string_view component) {
  const Siblings& siblings = children_of(parent);
  std::optional<std::uint32_t> found;
  if (const std::uint32_t* named = siblings.by_name.find(component)) found = *named;
  std::uint32_t index = 0;
  const auto [end, error] = std::from_chars(component.data(), component.data() + component.size(), index);
  if (error != std::errc{} || end != component.data() + component.size()) return found;
  const auto index_of = [&](std::uint32_t i) { return scene_.instances[i].child_index; };
  const auto it = std::ranges::lower_bound(siblings.in_order, index, {}, index_of);
  if (it != siblings.in_order.end() && index_of(*it) == index && (!found || *it < *found)) found = *it;
  return found;
}

std::optional<ObjectId> PathResolver::by_name(std::string_view name) {
  if (name.empty()) return std::nullopt;
  if (!knows_names_) {
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      NameTable<std::uint32_t>& names = instance.inner_name ? inner_names_ : outer_names_;
      if (!instance.def.empty() && names.find(instance.def) == nullptr) names[instance.def] = i;
    }
    knows_names_ = true;
  }
  if (const std::uint32_t* outer = outer_names_.find(name)) return scene_.id_of(*outer);
  if (const std::uint32_t* inner = inner_names_.find(name)) return scene_.id_of(*inner);
  return std::nullopt;
}

std::optional<ObjectId> PathResolver::find(std::string_view path) {
  if (path.find('/') == std::string_view::npos) {
    if (const auto id = by_name(path)) return id;
  }
  std::int32_t parent = -1;
  for (std::string_view rest = path;;) {
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const std::optional<std::uint32_t> found = child(parent, rest.substr(0, slash));
    if (!found) return by_name(path);  // a DEF name may itself hold a '/'
    if (slash == rest.size()) return scene_.id_of(*found);
    rest.remove_prefix(slash + 1);
    parent = static_cast<std::int32_t>(*found);
  }
}

}  // namespace peerd::vrml
