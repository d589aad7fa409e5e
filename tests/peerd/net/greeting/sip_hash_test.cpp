#include "peerd/net/greeting/sip_hash.hpp"

#include <gtest/gtest.h>

#include <array>

namespace peerd::net::sip_hash_test {

// The bytes 00, 01, 02 and so on.
std::array<std::byte, 16> counting() {
  std::array<std::byte, 16> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i);
  return bytes;
}
const SipKey kKey{.k0 = 0x0706050403020100, .k1 = 0x0f0e0d0c0b0a0908};

// The vectors are from appendix A of the paper (15 bytes) and from its authors' reference vectors (empty input).
TEST(SipHash, IsThatOfThePaper) {
  const auto bytes = counting();
  EXPECT_EQ(sip_hash(kKey, std::span(bytes).first(15)), 0xa129ca6149be45e5u);
  EXPECT_EQ(sip_hash(kKey, {}), 0x726fdb47dd0e0e31u);
}

TEST(SipHash, DependsOnEveryByteAndOnTheKey) {
  const auto bytes = counting();
  const std::uint64_t hash = sip_hash(kKey, bytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto changed = bytes;
    changed[i] ^= std::byte{0x80};
    EXPECT_NE(sip_hash(kKey, changed), hash) << i;
  }
  EXPECT_NE(sip_hash({kKey.k0 ^ 1, kKey.k1}, bytes), hash);
  EXPECT_NE(sip_hash({kKey.k0, kKey.k1 ^ 1}, bytes), hash);
}

TEST(SipKey, RandomOnesDiffer) {
  const SipKey a = random_key(), b = random_key();
  EXPECT_TRUE(a.k0 != b.k0 && a.k1 != b.k1 && a.k0 != a.k1);
}

}  // namespace peerd::net::sip_hash_test
