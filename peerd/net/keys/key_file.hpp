#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/net/keys/identity.hpp"
#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::keys {

// The file of the key that this user's peers of a world share where nobody says another one: in XDG_CONFIG_HOME, else
// in ~/.config. None: this user has no home.
[[nodiscard]] std::optional<std::filesystem::path> default_key_file(const std::string& world);
// The file that somebody has said, else that one. The error says that there is neither.
[[nodiscard]] Result<std::filesystem::path> chosen_key_file(const std::filesystem::path& said,
                                                            const std::string& world);

// The key in a file, which has one line, SymmetricKey::text(). A file that others may read or write is refused.
[[nodiscard]] Result<SymmetricKey> read_key(const std::filesystem::path& file);
// The same; where there is no such file, makes one with a random key, which only this user may read. Of several that
// make it at once, all get one key.
[[nodiscard]] Result<SymmetricKey> read_or_make_key(const std::filesystem::path& file);
// Makes a file with that key. One that is there with another key stays, and is an error.
[[nodiscard]] Result<void> keep_key(const std::filesystem::path& file, const SymmetricKey& key);

// The file of who this user is: the one that somebody has said, else one beside the folder of keys.
[[nodiscard]] Result<std::filesystem::path> chosen_identity_file(const std::filesystem::path& said);
// These do what read_key() and read_or_make_key() do; the line is Identity::text().
[[nodiscard]] Result<Identity> read_identity(const std::filesystem::path& file);
[[nodiscard]] Result<Identity> read_or_make_identity(const std::filesystem::path& file);

}  // namespace peerd::keys
