#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace peerd::keys {

// Base64 for URLs without padding (RFC 4648, section 5). Its time says nothing of the bytes.
[[nodiscard]] std::string base64_of(std::span<const std::uint8_t> bytes);
// Writes the bytes of such a text to `out`, and returns how many there are. None: it is no such text, or too long.
[[nodiscard]] std::optional<std::size_t> read_base64(std::string_view text, std::span<std::uint8_t> out);

}  // namespace peerd::keys
