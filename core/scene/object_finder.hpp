#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/scene/around.hpp"
#include "core/scene/path_resolver.hpp"
#include "core/scene/scene.hpp"
#include "core/vrml/diagnostics.hpp"
#include "core/vrml/document.hpp"
#include "core/vrml/name_table.hpp"

namespace peerd::vrml {

// An ObjectFinder finds the instances that CollisionInterests and KeySensors of a world name. All parameters outlive
// it; the instances of the scene are complete.
class ObjectFinder {
 public:
  // `around` finds what a path means that names nothing in the document. `name_numbers` numbers the names of instances;
  // `first_of_name` has the first instance of each that is named so outside of PROTOs and Inlines, or Instance::kNone.
  ObjectFinder(const Document& document, const Scene& scene, const NameTable<std::uint32_t>& name_numbers,
               const std::vector<std::uint32_t>& first_of_name, Problems& problems, const Around& around);

  // Finds the instance of a path that stands at `at` in a node of that scope. A name inside of a PROTO or an Inline
  // means a node in there first. Reports a path that names nothing, unless the name was lost in an error.
  [[nodiscard]] std::optional<ObjectId> find(std::string_view path, std::uint32_t scope, Position at);
  // The same without a report.
  [[nodiscard]] std::optional<ObjectId> find(std::string_view path, std::uint32_t scope);

 private:
  void gather_inner_names();

  const Document& document_;
  const Scene& scene_;
  const NameTable<std::uint32_t>& name_numbers_;
  const std::vector<std::uint32_t>& first_of_name_;
  Problems& problems_;
  const Around& around_;
  PathResolver paths_;
  std::unordered_set<std::string_view> unreadable_names_;
  bool gathered_ = false;  // inner_names_ are complete
  std::map<std::pair<std::uint32_t, std::string_view>, std::uint32_t> inner_names_;
};

}  // namespace peerd::vrml
