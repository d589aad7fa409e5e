#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::seal {

inline constexpr std::size_t kNonceSealAdded_bytes = 24 + 16;  // to each text: the nonce and the tag

// Seals a text by a nonce drawn at random (XChaCha20-Poly1305), for texts without a number that never comes twice. Its
// first `clear_bytes` stay readable, and can't be changed either.
[[nodiscard]] std::vector<std::byte> seal_by_nonce(std::span<const std::uint8_t> text, std::size_t clear_bytes,
                                                   const keys::SymmetricKey& key);
// The text. None: the key does not open it.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> open_by_nonce(std::span<const std::byte> sealed,
                                                                     std::size_t clear_bytes,
                                                                     const keys::SymmetricKey& key);

}  // namespace peerd::seal
