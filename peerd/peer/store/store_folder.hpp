#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/peer/store/folder_lock.hpp"

namespace peerd::store {

// The folder in which this user's programs keep such folders, by world and peer: in XDG_STATE_HOME, else in
// ~/.local/state. None: this user has no home.
[[nodiscard]] std::optional<std::filesystem::path> state_folder();

// The folder of the store of this user's peer of a name in a world, where nobody says another one: in
// state_folder(). None: this user has no home.
[[nodiscard]] std::optional<std::filesystem::path> default_folder(std::uint64_t genesis, const std::string& peer);

// Locks the folder, which is made where it is missing. The error says that it cannot be, or that another process has
// it.
[[nodiscard]] Result<FolderLock> lock_folder(const std::filesystem::path& folder);
// Locks the first of `folder`, `folder`.2, `folder`.3 and so on that no other process has: each of several peers of one
// name that run at once, or start at once, has a folder of its own.
[[nodiscard]] Result<FolderLock> lock_first_free(const std::filesystem::path& folder);

// Puts the store in a locked folder aside, where there is one: that folder gets another name, with all that is in it,
// which is returned, and the lock ends. None: the folder is empty, and stays. A folder that has anything but the files
// of one store stays, too: the error names what it has.
[[nodiscard]] Result<std::optional<std::filesystem::path>> put_aside(FolderLock folder);

}  // namespace peerd::store
