#pragma once
#include <expected>
#include <filesystem>
#include <string>
#include <string_view>

#include "collision/scene/scene_query.hpp"

namespace peerd::config {

// The files that a world's `hierarchyFile`s name: within the folder of the world, or below it, and nowhere else, since
// a world is no reason to write somewhere.

// Maps them. `world` is the world's own path.
[[nodiscard]] collision::HierarchyLoader mapped_hierarchies(const std::filesystem::path& world);

// Writes one, in one step: a reader sees the old file or the new one. What is there already is replaced only if it is a
// hierarchy file. The path that was written, or why none was.
[[nodiscard]] std::expected<std::filesystem::path, std::string> write_hierarchy_file(const std::filesystem::path& world,
                                                                                     std::string_view url,
                                                                                     std::string_view bytes);

}  // namespace peerd::config
