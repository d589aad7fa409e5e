#pragma once
#include <filesystem>
#include <optional>

namespace peerd {

// This user's folder for programs' files of one kind, by the XDG Base Directory Specification: the variable's
// ("XDG_STATE_HOME"), else `in_home` below HOME. A path that is not absolute is ignored. None: this user has no home.
[[nodiscard]] std::optional<std::filesystem::path> user_folder(const char* variable,
                                                               const std::filesystem::path& in_home);

}  // namespace peerd
