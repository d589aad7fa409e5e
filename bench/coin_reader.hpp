#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace peerd::bench {

// Coin, the established reader of VRML97 in C++. To be called once before the others; reads no file but what it is
// given.
void start_coin();

// How many errors it has reported since, of reading and of other kinds.
[[nodiscard]] std::size_t coin_errors();

// Reads the text and frees what it read; false where it reads none.
bool read_with_coin(std::string_view text);

// The triangles that Coin draws of that world; nothing where it cannot read it without an error.
[[nodiscard]] std::optional<std::uint64_t> triangles_of_coin(std::string_view text);

}  // namespace peerd::bench
