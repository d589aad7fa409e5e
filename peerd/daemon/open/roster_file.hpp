#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "peerd/input/input_error.hpp"
#include "peerd/net/keys/roster.hpp"

namespace peerd {

// The file of a world's roster: the one that somebody has said, else the one beside this user's own key of the world.
// None: this user has no home.
[[nodiscard]] std::optional<std::filesystem::path> chosen_roster_file(const std::filesystem::path& said,
                                                                      const std::string& world);

// The roster in a file; none: there is no such file. The error says that it is damaged, or can't be read.
[[nodiscard]] Result<std::optional<keys::Roster>> read_roster(const std::filesystem::path& file);
// Reads the ones that save_roster() has replaced, which are FILE.EPOCH, ascending.
[[nodiscard]] std::vector<keys::Roster> read_earlier_rosters(const std::filesystem::path& file);
// Puts the roster in place of the one that is there, which it must follow; that one stays as FILE.EPOCH.
[[nodiscard]] Result<void> save_roster(const std::filesystem::path& file, const keys::Roster& roster);

}  // namespace peerd
