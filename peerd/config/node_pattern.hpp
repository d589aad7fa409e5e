#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/scene.hpp"
#include "peerd/input/input_error.hpp"

namespace peerd::config {

// Whether `text` is of the form of `pattern`, in which `*` stands for any characters but a slash, and `?` for one.
[[nodiscard]] bool matches(std::string_view pattern, std::string_view text);

// A path of the world's nodes, or a pattern over them, as somebody wrote it.
struct NodePattern {
  std::string text;
  std::string at;  // FILE:LINE:COLUMN: of it; empty where none is known

  NodePattern(std::string pattern, std::string place = {}) : text(std::move(pattern)), at(std::move(place)) {}
  NodePattern(const char* pattern) : text(pattern) {}
  [[nodiscard]] bool is_path() const { return text.find_first_of("*?") == std::string::npos; }
};

// The node of that path, or a sentence that names the closest one.
[[nodiscard]] Result<ObjectId> find_object(const Scene& scene, const std::string& path, const std::string& asked_by);

// The nodes that it names, by id: one by its path; or all whose paths from the top level, or where the pattern has no
// slash their names, are of its form. At least one; `asked_by` is the key that holds the pattern.
[[nodiscard]] Result<std::vector<ObjectId>> find_objects(const Scene& scene, const NodePattern& pattern,
                                                         const std::string& asked_by);

}  // namespace peerd::config
