#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "peerd/input/input_error.hpp"

namespace peerd::store {

// The folder in which this user's programs keep such folders, by world and peer: in XDG_STATE_HOME, else in
// ~/.local/state. None: this user has no home.
[[nodiscard]] std::optional<std::filesystem::path> state_folder();

// The folder of the store of this user's peer of a name in a world, where nobody says another one: in
// state_folder(). Each of several peers of one name that run at once has a folder of its own. None: this user
// has no home.
[[nodiscard]] std::optional<std::filesystem::path> default_folder(std::uint64_t genesis, const std::string& peer);

// Puts the store in a folder aside, where there is one: that folder gets another name, with all that is in it, which is
// returned. The error says that it cannot be, or that another process has it.
[[nodiscard]] Result<std::optional<std::filesystem::path>> put_aside(const std::filesystem::path& folder);

}  // namespace peerd::store
