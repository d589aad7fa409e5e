#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "peerd/input/input_error.hpp"

namespace peerd::api {

// Where peers listen that nobody told where: $XDG_RUNTIME_DIR/peerd. None where that is not set.
[[nodiscard]] std::optional<std::filesystem::path> runtime_folder();

// The socket that a peer of that name listens on by default.
[[nodiscard]] std::optional<std::filesystem::path> default_socket(const std::string& peer);

// For `peerd ctl` without --control: the named peer's, or that of the only peer there is. The error names them.
[[nodiscard]] Result<std::filesystem::path> find_socket(const std::string& peer);

}  // namespace peerd::api
