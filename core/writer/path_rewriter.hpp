#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/scene/path_resolver.hpp"
#include "core/scene/scene.hpp"
#include "core/vrml/document.hpp"

namespace peerd::vrml {

// PathRewriter finds what the paths of CollisionInterests and KeySensors mean where they stand in PROTOs and Inlines,
// and how to name the same instances where all names are those of the world.
class PathRewriter {
 public:
  explicit PathRewriter(const Scene& scene);
  PathRewriter(const PathRewriter&) = delete;
  PathRewriter& operator=(const PathRewriter&) = delete;

  // Returns the instance that the reader finds: a name inside of a PROTO or an Inline means a node in there first.
  [[nodiscard]] std::optional<std::uint32_t> instance_of(std::string_view path, std::uint32_t scope) const;
  // Returns whether the node is a CollisionInterest whose object is in no scene: it does nothing, and could not be read
  // again.
  [[nodiscard]] bool has_no_target(const Node& node) const;
  // Returns the first instance that has the name outside of PROTOs and Inlines.
  [[nodiscard]] std::optional<std::uint32_t> first_in_world_scope(std::string_view name) const;

  // Renames the nodes: from here on `names` has the name of each node, all in the scope of the world; where `written`
  // has none the node stays as it is.
  void rename(const std::vector<std::string_view>& names, const std::vector<bool>& written);
  [[nodiscard]] std::optional<std::string> rewritten(std::string_view path, std::uint32_t scope) const;

 private:
  [[nodiscard]] std::optional<std::uint32_t> renamed_instance_of(std::string_view path) const;

  const Scene& scene_;
  std::vector<std::uint32_t> first_instance_;  // indexed by node
  std::unordered_map<std::string_view, std::uint32_t> first_of_name_;
  // The names in the scopes that have a CollisionInterest or a KeySensor.
  std::map<std::pair<std::uint32_t, std::string_view>, std::uint32_t> inner_nodes_, inner_instances_;
  bool has_paths_ = false;
  Scene renamed_;  // only the instances are set
  std::unordered_map<std::string_view, std::uint32_t> first_renamed_;
  mutable PathResolver paths_{scene_}, renamed_paths_{renamed_};  // mutable since they cache lookups
};

}  // namespace peerd::vrml
