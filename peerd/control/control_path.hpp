#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "peerd/input/input_error.hpp"

namespace peerd::api {

// The folder of default sockets: $XDG_RUNTIME_DIR/peerd. None where the variable is not set.
[[nodiscard]] std::optional<std::filesystem::path> runtime_folder();

// The default socket of a peer of that name.
[[nodiscard]] std::optional<std::filesystem::path> default_socket(const std::string& peer);

// Finds the socket for `peerd ctl` without --control: that of the named peer or, with an empty name, of the only peer.
// The error names the peers where there are several.
[[nodiscard]] Result<std::filesystem::path> find_socket(const std::string& peer);

}  // namespace peerd::api
