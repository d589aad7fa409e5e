#pragma once
#include <filesystem>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/input/secret_text.hpp"

namespace peerd::keys {

// The error of a file with a secret: "error: the key FILE is no file". `what` it is: "key".
[[nodiscard]] InputError wrong_secret(const std::filesystem::path& file, const std::string& what,
                                      const std::string& predicate, int code);

// Reads what is in a file that only this user may read and write, without the end of its last line.
[[nodiscard]] Result<SecretText> read_private_line(const std::filesystem::path& file, const std::string& what);
// Makes the file with that line. One that is there stays as it is.
[[nodiscard]] Result<void> make_private_line(const std::filesystem::path& file, const std::string& what,
                                             std::string line);

}  // namespace peerd::keys
