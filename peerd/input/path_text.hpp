#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace peerd {

[[nodiscard]] bool is_utf8(std::string_view text);

// A path as a text for configurations and JSON, which hold UTF-8 alone: itself, or, where a name has other bytes, a URI
// such as "file:///home/anna/caf%E9.wrl". The path has to be absolute then.
[[nodiscard]] std::string path_text(const std::filesystem::path& path);
[[nodiscard]] std::filesystem::path path_of_text(const std::string& text);

}  // namespace peerd
