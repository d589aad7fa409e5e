#pragma once
#include <filesystem>
#include <system_error>

namespace peerd::store {

// Waits until the contents of this file, or the names in this folder, outlast a power cut. The error says why they do
// not.
[[nodiscard]] std::error_code synchronise(const std::filesystem::path& path);

// Gives a file that has been written under another name, in the same folder, its own: what has that name is whole then,
// or as it was before, also after a power cut.
[[nodiscard]] std::error_code put_in_place(const std::filesystem::path& unfinished, const std::filesystem::path& file);

// Makes the folder and those that lead to it, each with its name on the disk.
[[nodiscard]] std::error_code make_folders(const std::filesystem::path& folder);

}  // namespace peerd::store
