#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/input/secret_text.hpp"
#include "peerd/seal/symmetric_key.hpp"

namespace peerd::seal {

// The file of the key that this user's peers of a world share where nobody says another one: in XDG_CONFIG_HOME, else
// in
// ~/.config. None: this user has no home.
[[nodiscard]] std::optional<std::filesystem::path> default_key_file(const std::string& world);
// The file that somebody has said, else that one. The error says that there is neither.
[[nodiscard]] Result<std::filesystem::path> chosen_key_file(const std::filesystem::path& said,
                                                            const std::string& world);

// What is in a file that only this user may read and write, without the end of its last line; `what` it is, for errors.
[[nodiscard]] Result<SecretText> read_private_line(const std::filesystem::path& file, const std::string& what);

// The key in a file, which has one line, SymmetricKey::text(). A file that others may read or write is refused.
[[nodiscard]] Result<SymmetricKey> read_key(const std::filesystem::path& file);
// The same; where there is no such file, makes one with a random key, which only this user may read. Of several that
// make it at once, all get one key.
[[nodiscard]] Result<SymmetricKey> read_or_make_key(const std::filesystem::path& file);
// Makes a file with that key. One that is there with another key stays, and is an error.
[[nodiscard]] Result<void> keep_key(const std::filesystem::path& file, const SymmetricKey& key);

}  // namespace peerd::seal
