#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/scene/reader.hpp"
#include "peerd/input/input_error.hpp"

namespace peerd::config {

// The path that a URL names, %-escapes resolved, or nothing where it names no file of this machine.
[[nodiscard]] std::optional<std::filesystem::path> local_path(std::string_view url);

// Reads the files behind the URLs of Inlines and EXTERNPROTOs: regular files of this machine, by relative or absolute
// path or file: URL, %-escapes resolved. Anything else is refused by name; nothing is fetched over a network.
[[nodiscard]] FileLoader local_files();

// A world and all that it includes. A world with errors is a result too; no file at all is none.
struct WorldFile {
  std::string text;  // ReadResult::sources may point into it
  ReadResult result;
};
[[nodiscard]] Result<std::unique_ptr<const WorldFile>> read_world_file(const std::filesystem::path& path,
                                                                       ReadOptions options = {});

}  // namespace peerd::config
