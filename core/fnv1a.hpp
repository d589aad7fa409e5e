#pragma once
#include <cstdint>

namespace peerd {

// Returns the FNV-1a 64 hash (Fowler, Noll and Vo 1991) that goes on from `hash` with the bytes of a number, the lowest
// first.
[[nodiscard]] constexpr std::uint64_t fnv1a(std::uint64_t hash, std::uint64_t number) {
  for (int byte = 0; byte < 8; ++byte) hash = (hash ^ (number >> (8 * byte) & 0xFF)) * 0x100000001B3;
  return hash;
}

}  // namespace peerd
