#pragma once
#include <expected>
#include <filesystem>
#include <string>
#include <string_view>

#include "collision/scene/scene_query.hpp"

namespace peerd {

// These functions reach the files that a world's `hierarchyFile`s name, and only in or below the world's folder: a
// world's text is no reason to write anywhere else.

// The loader maps such files into memory. `world` is the path of the world itself.
[[nodiscard]] collision::HierarchyLoader mapped_hierarchies(const std::filesystem::path& world);

// Writes a hierarchy file in one step, so that a reader sees the old file or the new one. An existing file is replaced
// only if it is a hierarchy file. The result is the path that was written, or the reason why none was.
[[nodiscard]] std::expected<std::filesystem::path, std::string> write_hierarchy_file(const std::filesystem::path& world,
                                                                                     std::string_view url,
                                                                                     std::string_view bytes);

}  // namespace peerd
