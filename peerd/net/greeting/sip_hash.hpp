#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace peerd::net {

// 128 secret bits: bytes 0 to 7 and 8 to 15 of the key, little-endian.
struct SipKey {
  std::uint64_t k0 = 0, k1 = 0;
};

// 128 random bits of the kernel, for one start of a process.
[[nodiscard]] SipKey random_key();

// SipHash-2-4 (Aumasson and Bernstein, "SipHash: a fast short-input PRF", 2012). Without the key, the hashes of any
// inputs do not help to predict the hash of another input.
[[nodiscard]] std::uint64_t sip_hash(const SipKey& key, std::span<const std::byte> input);

}  // namespace peerd::net
