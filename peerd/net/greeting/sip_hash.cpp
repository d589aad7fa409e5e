#include "peerd/net/greeting/sip_hash.hpp"

#include <array>
#include <bit>

#include <sodium/crypto_shorthash_siphash24.h>
#include <sodium/randombytes.h>

namespace peerd::net {

namespace {

static_assert(sizeof(SipKey) == crypto_shorthash_siphash24_KEYBYTES);

// The word whose bytes in memory are those of `word`, the lowest first; and the way back.
std::uint64_t little_endian(std::uint64_t word) {
  return std::endian::native == std::endian::little ? word : std::byteswap(word);
}

}  // namespace

SipKey random_key() {
  SipKey key;
  randombytes_buf(&key, sizeof key);
  return key;
}

std::uint64_t sip_hash(const SipKey& key, std::span<const std::byte> input) {
  const auto key_bytes =
      std::bit_cast<std::array<unsigned char, sizeof key>>(SipKey{little_endian(key.k0), little_endian(key.k1)});
  std::array<unsigned char, crypto_shorthash_siphash24_BYTES> hash;
  crypto_shorthash_siphash24(hash.data(), reinterpret_cast<const unsigned char*>(input.data()), input.size(),
                             key_bytes.data());
  return little_endian(std::bit_cast<std::uint64_t>(hash));
}

}  // namespace peerd::net
