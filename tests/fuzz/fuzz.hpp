#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

namespace peerd::fuzz {

// Unlike assert(), this check is on in every build.
inline void require(bool condition) {
  if (!condition) std::abort();
}

// Calls take(line) for the first `most` lines of the input.
template <class Take>
void for_each_line(std::string_view input, int most, const Take& take) {
  for (int i = 0; i < most && !input.empty(); ++i) {
    const std::size_t end = std::min(input.find('\n'), input.size());
    take(input.substr(0, end));
    input.remove_prefix(std::min(end + 1, input.size()));
  }
}

// Calls take(extra, datagram) for the first `most` datagrams of the input. Each has a header of three bytes: its length
// (little-endian), then a byte for the target's own use, such as a pause. Where the length is too large, the rest of
// the input is the datagram.
template <class Take>
void for_each_datagram(std::span<const std::byte> input, int most, const Take& take) {
  for (int i = 0; i < most && input.size() > 3; ++i) {
    const auto length = std::to_integer<std::size_t>(input[0]) | std::to_integer<std::size_t>(input[1]) << 8;
    const auto extra = std::to_integer<std::uint8_t>(input[2]);
    input = input.subspan(3);
    const auto datagram = input.first(std::min(length, input.size()));
    take(extra, datagram);
    input = input.subspan(datagram.size());
  }
}

}  // namespace peerd::fuzz
