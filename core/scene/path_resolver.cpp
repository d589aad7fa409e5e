#include "core/scene/path_resolver.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "core/vrml/path_text.hpp"

namespace peerd::vrml {
namespace {

// Whether the name is what the pattern stands for, by the last '*' to which it can go back.
bool matches(std::string_view name, std::string_view pattern) {
  std::size_t n = 0, p = 0, star = pattern.size(), from = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      from = n;
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++n;
      ++p;
    } else if (star < pattern.size()) {
      p = star + 1;
      n = ++from;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

}  // namespace

std::optional<PatternParts> parts_of_pattern(std::string_view path) {
  if (path == "all") return PatternParts{{}, "*"};
  const std::size_t star = find_star(path);
  if (star == std::string_view::npos) return std::nullopt;
  std::size_t begin = 0;  // of the name with the star
  for (std::size_t end = component_end(path); end < star; end = begin + component_end(path.substr(begin)))
    begin = end + 1;
  if (begin == 0) return PatternParts{{}, path};
  return PatternParts{path.substr(0, begin - 1), path.substr(begin)};
}

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

// Finds the first sibling that has the component as its name or number.
std::optional<std::uint32_t> PathResolver::child(std::int32_t parent, std::string_view component) {
  const Siblings& siblings = children_of(parent);
  std::optional<std::uint32_t> found;
  if (const auto name = unquoted(component)) {
    if (const std::uint32_t* named = siblings.by_name.find(*name)) return *named;
  }
  const std::uint32_t* const named = is_index(component) ? nullptr : siblings.by_name.find(component);
  if (named != nullptr) found = *named;
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
  if (component_end(path) == path.size() && !is_index(path)) {
    const auto name = unquoted(path);
    if (const auto id = name ? by_name(*name) : by_name(path)) return id;
  }
  std::int32_t parent = -1;
  for (std::string_view rest = path;;) {
    const std::size_t slash = component_end(rest);
    const std::optional<std::uint32_t> found = child(parent, rest.substr(0, slash));
    if (!found) return by_name(path);  // a DEF name may itself hold a '/'
    if (slash == rest.size()) return scene_.id_of(*found);
    rest.remove_prefix(slash + 1);
    parent = static_cast<std::int32_t>(*found);
  }
}

std::vector<ObjectId> PathResolver::find_all(const NamePattern& pattern) {
  std::vector<std::uint32_t> found;
  const auto add_below = [&](std::int32_t parent, std::string_view component) {
    if (find_star(component) == std::string_view::npos) {
      if (const auto one = child(parent, component)) found.push_back(*one);
      return;
    }
    for (const std::uint32_t i : children_of(parent).in_order) {
      const std::string_view def = scene_.instances[i].def;
      if (component == "*" || (!def.empty() && matches(def, component))) found.push_back(i);
    }
  };
  bool is_first = true;
  for (std::string_view rest = pattern.path;; is_first = false) {
    const std::size_t slash = component_end(rest);
    const std::string_view component = rest.substr(0, slash);
    if (!is_first) {
      for (const std::uint32_t parent : std::exchange(found, {})) {
        add_below(static_cast<std::int32_t>(parent), component);
      }
    } else if (pattern.below) {
      if (scene_.contains(*pattern.below)) {
        add_below(static_cast<std::int32_t>(scene_.index_of(*pattern.below)), component);
      }
    } else if (component == "*") {
      add_below(-1, component);
    } else {
      for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
        const Instance& instance = scene_.instances[i];
        if (!instance.def.empty() && matches(instance.def, component)) found.push_back(i);
      }
    }
    if (slash == rest.size()) break;
    rest.remove_prefix(slash + 1);
  }
  std::ranges::sort(found);  // one may be below another that was found, too
  found.erase(std::ranges::unique(found).begin(), found.end());
  std::vector<ObjectId> ids;
  for (const std::uint32_t i : found) ids.push_back(scene_.id_of(i));
  return ids;
}

}  // namespace peerd::vrml
