#pragma once
#include <cstddef>
#include <expected>
#include <string>
#include <string_view>

namespace peerd {

[[nodiscard]] bool is_gzip(std::string_view bytes);

// Unpacks a gzip file (RFC 1952), all of its members, or says what is wrong with it: it is cut short, damaged, or
// larger than `max_bytes` unpacked; `advice` follows that sentence. Memory stays within twice what is unpacked so far.
[[nodiscard]] std::expected<std::string, std::string> gunzip(std::string_view bytes, std::size_t max_bytes,
                                                             std::string_view advice = "");

}  // namespace peerd
