#pragma once
#include <cstddef>
#include <expected>
#include <string>
#include <string_view>

namespace peerd {

// Compresses bytes to one frame of zstd (RFC 8878) that says how long they are.
[[nodiscard]] std::string compress(std::string_view bytes);
// The bytes of such a frame. Hostile input: the error says in a few words what is wrong, and where the bytes would be
// more than `most`, nothing is unpacked.
[[nodiscard]] std::expected<std::string, std::string> decompress(std::string_view frame, std::size_t most);

}  // namespace peerd
