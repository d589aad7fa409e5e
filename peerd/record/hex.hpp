#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace peerd::record {

// Bytes as digits, two each, from 0 to f.
[[nodiscard]] std::string hex_of(std::span<const std::byte> bytes);
// None: these are no such digits.
[[nodiscard]] std::optional<std::vector<std::byte>> bytes_of_hex(std::string_view digits);

}  // namespace peerd::record
