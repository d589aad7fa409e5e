#pragma once
#include <filesystem>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::keys {

// A KeyChoice says by which key a session is to be sealed: one of the files is named, or neither.
struct KeyChoice {
  std::filesystem::path key_file;
  std::filesystem::path password_file;  // "-": the password is in standard input
};
[[nodiscard]] Result<void> check(const KeyChoice& choice);

struct SessionKey {
  SymmetricKey key;
  std::string by;  // what a log says of it: "the key FILE", or "a password"
};
enum class IfMissing { kMake, kFail };
// The key of a world's session. Where nobody has said anything it is this user's own of that world, which is made where
// there is none and `if_missing` says so. It takes most of a second where a password makes it.
[[nodiscard]] Result<SessionKey> session_key(const KeyChoice& choice, const std::string& world, IfMissing if_missing);

}  // namespace peerd::keys
