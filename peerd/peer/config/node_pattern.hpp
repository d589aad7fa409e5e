#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/scene.hpp"
#include "peerd/input/input_error.hpp"

namespace peerd::config {

// Whether `text` matches `pattern`, in which `*` stands for any characters except a slash, and `?` for one of them.
[[nodiscard]] bool matches(std::string_view pattern, std::string_view text);

// A path of a node of the world, or a pattern over such paths, as the author wrote it.
struct NodePattern {
  std::string text;
  std::string at;  // FILE:LINE:COLUMN: of the text; empty: unknown

  // NOLINTBEGIN(google-explicit-constructor): settings are assigned, and tests write patterns, as text
  NodePattern(std::string pattern, std::string place = {}) : text(std::move(pattern)), at(std::move(place)) {}
  NodePattern(const char* pattern) : text(pattern) {}
  // NOLINTEND(google-explicit-constructor)
  [[nodiscard]] bool is_path() const { return text.find_first_of("*?") == std::string::npos; }
};

// Finds the node with that path. The error names the closest path; `asked_by` is the key that holds the path.
[[nodiscard]] Result<ObjectId> find_object(const Scene& scene, const std::string& path, const std::string& asked_by);

// Finds the nodes that a pattern names, by id: the node with that path, or all nodes whose paths from the top level
// match; a pattern without a slash is compared with names instead of paths. The result is never empty; `asked_by` is
// the key that holds the pattern.
[[nodiscard]] Result<std::vector<ObjectId>> find_objects(const Scene& scene, const NodePattern& pattern,
                                                         const std::string& asked_by);

}  // namespace peerd::config
