#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace peerd {

// A text from the network, for a terminal: without control characters (C0, DEL, and C1 as UTF-8), each of which becomes
// "?", and no longer than `most` bytes, cut between characters of UTF-8.
[[nodiscard]] std::string printable(std::string_view text, std::size_t most);

// Whether it is UTF-8 and has none of these control characters, so that a terminal and a file's name can have it as it
// is.
[[nodiscard]] bool is_printable(std::string_view text);

// A number and its noun: "1 error", "2 errors". `plural` is for nouns that take no s.
[[nodiscard]] std::string counted(std::size_t count, const std::string& what, const std::string& plural = "");

}  // namespace peerd
