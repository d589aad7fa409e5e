#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/vrml/name_table.hpp"

namespace peerd::vrml {

// The parts of a path with a '*' in it: the names before the one with the first '*', and the rest. "all" is a "*".
struct PatternParts {
  std::string_view below, path;
};
[[nodiscard]] std::optional<PatternParts> parts_of_pattern(std::string_view path);  // nothing where there is no '*'

// PathResolver is Scene::find() for a world that names many paths. It visits each instance at most twice, however many
// paths are asked for, where find() visits all siblings on the way of each; and it visits none that no path leads by.
class PathResolver {
 public:
  explicit PathResolver(const Scene& scene) : scene_(scene) {}  // the scene outlives it and stays as it is

  [[nodiscard]] std::optional<ObjectId> find(std::string_view path);  // the result of scene.find(path)
  // Returns all instances that the pattern finds, in the order of the scene. Each name of its path leads to children,
  // "*" to all of them. A path that begins with "*" leads to the top level, and one that begins with another name with
  // a '*' to all instances of such DEF names, wherever they stand.
  [[nodiscard]] std::vector<ObjectId> find_all(const NamePattern& pattern);
  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  struct Siblings {
    std::vector<std::uint32_t> in_order;
    NameTable<std::uint32_t> by_name;  // the first of each name
  };
  const Siblings& children_of(std::int32_t parent);
  std::optional<std::uint32_t> child(std::int32_t parent, std::string_view component);
  std::optional<ObjectId> by_name(std::string_view name);

  const Scene& scene_;
  std::unordered_map<std::int32_t, Siblings> children_;  // -1: the top level
  bool knows_names_ = false;
  NameTable<std::uint32_t> outer_names_, inner_names_;  // the first instance of each
};

}  // namespace peerd::vrml
