#pragma once
#include <cstdint>

namespace peerd {

// Returns the bits of a number well mixed: each depends on all of its own (the finalizer of splitmix64; Steele, Lea and
// Flood 2014).
[[nodiscard]] constexpr std::uint64_t mixed_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58'476D'1CE4'E5B9;
  x = (x ^ (x >> 27)) * 0x94D0'49BB'1331'11EB;
  return x ^ (x >> 31);
}

}  // namespace peerd
