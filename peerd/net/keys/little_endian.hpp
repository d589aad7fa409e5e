#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace peerd::keys {

// The lowest bytes of a number, the least significant one first, as many as there is room for.
inline void put(std::uint64_t number, std::span<std::uint8_t> at) {
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = static_cast<std::uint8_t>(number >> (8 * i));
}
// The number of at most 8 such bytes.
[[nodiscard]] inline std::uint64_t get(std::span<const std::uint8_t> at) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < at.size(); ++i) number |= std::uint64_t{at[i]} << (8 * i);
  return number;
}

inline std::span<std::uint8_t> as_octets(std::span<std::byte> bytes) {
  return {reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size()};
}
inline std::span<const std::uint8_t> as_octets(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

}  // namespace peerd::keys
