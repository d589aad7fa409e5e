#pragma once
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace peerd::formats {

// The sizes of a binary STL file's parts: 80 bytes that mean nothing and a count, then for each facet twelve binary32
// numbers and two bytes without a meaning.
inline constexpr std::size_t kStlHeader_bytes = 84, kStlFacet_bytes = 50;

// Returns the number at the front of `bytes`, wherever it is aligned.
template <class T>
[[nodiscard]] T little_endian(std::string_view bytes) {
  static_assert(std::endian::native == std::endian::little);
  assert(bytes.size() >= sizeof(T));
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));  // NOLINT(bugprone-suspicious-stringview-data-usage): asserted
  return value;
}

template <class T>
[[nodiscard]] T big_endian(std::string_view bytes) {
  assert(bytes.size() >= sizeof(T));
  std::array<char, sizeof(T)> reversed;
  for (std::size_t i = 0; i < sizeof(T); ++i) reversed[sizeof(T) - 1 - i] = bytes[i];
  return little_endian<T>({reversed.data(), reversed.size()});
}

}  // namespace peerd::formats
