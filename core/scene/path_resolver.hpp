#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/vrml/name_table.hpp"

namespace peerd::vrml {

// PathResolver is Scene::find() for a world that names many paths. It visits each instance at most twice, however many
// paths are asked for, where find() visits all siblings on the way of each; and it visits none that no path leads by.
class PathResolver {
 public:
  explicit PathResolver(const Scene& scene) : scene_(scene) {}  // the scene outlives it and stays as it is

  [[nodiscard]] std::optional<ObjectId> find(std::string_view path);  // the result of scene.find(path)

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
