#pragma once
#include <filesystem>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::seal {

// A relay needs this to be greeted in a sealed session, and has nothing else of it: a key that is derived from the
// session's one way, by which greetings are sealed. Nobody reads or makes a peer's datagram with it. Its text is one
// line of printable ASCII: "peerd-relay-1:" and the bits in base64 for URLs.
[[nodiscard]] std::string relay_key_text(const keys::SymmetricKey& session);

// The key in a file that relay_key_text() has written. A file that others may read or write is refused.
[[nodiscard]] Result<keys::SymmetricKey> read_relay_key(const std::filesystem::path& file);

}  // namespace peerd::seal
