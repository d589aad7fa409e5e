#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "peerd/input/input_error.hpp"
#include "peerd/input/secret_text.hpp"
#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::keys {

// Whoever records one datagram can try passwords on it for as long as they like, so that a short one is no secret.
inline constexpr std::size_t kPasswordMin_bytes = 8;

// The password in a file that only this user may read, which is its one line. "-": it is a line of standard input, for
// which a terminal is asked.
[[nodiscard]] Result<SecretText> read_password(const std::filesystem::path& file);

// The key that a password makes for a world of that name, the same on every computer: Argon2id 1.3 (RFC 9106) with one
// lane, three passes and 256 MiB, which takes most of a second. Its salt is BLAKE2b of the name, of 16 bytes and keyed
// with the text "peerd password 1": keys of frequent passwords have to be looked for anew for each world. The error
// says that there is too little memory.
[[nodiscard]] Result<SymmetricKey> key_of_password(std::string_view password, const std::string& world);

}  // namespace peerd::keys
