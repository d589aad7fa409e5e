#include "peerd/peer/config/node_pattern.hpp"

#include <cstdint>
#include <optional>
#include <utility>

#include "peerd/input/toml_input.hpp"
#include "peerd/peer/config/shown_path.hpp"

namespace peerd::config {

bool matches(std::string_view pattern, std::string_view text) {
  std::size_t p = 0, t = 0;
  std::size_t star = std::string_view::npos, taken = 0;  // last `*`; begin of the text behind what it matched
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = t;
    } else if (p < pattern.size() && (pattern[p] == text[t] || (pattern[p] == '?' && text[t] != '/'))) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos && text[taken] != '/') {
      p = star + 1;
      t = ++taken;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

Result<ObjectId> find_object(const Scene& scene, const std::string& path, const std::string& asked_by) {
  if (const auto id = scene.find(path)) return *id;
  std::vector<std::string> names;
  for (const Instance& instance : scene.instances) {
    if (!instance.def.empty()) names.emplace_back(instance.def);
  }
  std::string sentence = "error: " + asked_by + ": the world has no object " + shown(path);
  if (const auto meant = did_you_mean(path, names)) sentence += "; did you mean " + shown(*meant) + "?";
  return std::unexpected(InputError{sentence});
}

Result<std::vector<ObjectId>> find_objects(const Scene& scene, const NodePattern& pattern,
                                           const std::string& asked_by) {
  // A node's own name may hold wildcard characters.
  if (pattern.is_path() || scene.find(pattern.text)) {
    const auto object = find_object(scene, pattern.text, asked_by);
    if (!object) return std::unexpected(InputError{pattern.at + object.error().text});
    return std::vector{*object};
  }
  const bool by_name = pattern.text.find('/') == std::string::npos;
  std::vector<ObjectId> found;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    // Names inside of PROTOs and Inlines are private to them: only a whole path reaches them.
    const bool named = by_name && !instance.def.empty() && !instance.name_shadowed && !instance.inner_name;
    if (matches(pattern.text, named ? std::string(instance.def) : scene.path_of(scene.id_of(i)))) {
      found.push_back(scene.id_of(i));
    }
  }
  if (!found.empty()) return found;
  return std::unexpected(
      InputError{pattern.at + "error: " + asked_by + ": no object of the world is called like " + shown(pattern.text)});
}

}  // namespace peerd::config
