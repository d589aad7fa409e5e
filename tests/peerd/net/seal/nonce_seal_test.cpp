#include "peerd/net/seal/nonce_seal.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace peerd::seal::nonce_seal_test {

TEST(NonceSeal, OpensWhatItSealed) {
  const keys::SymmetricKey key = keys::SymmetricKey::random();
  std::vector<std::uint8_t> text(40);
  std::iota(text.begin(), text.end(), std::uint8_t{1});
  for (const std::size_t clear : {0, 1, 40}) {
    const auto sealed = seal_by_nonce(text, clear, key);
    EXPECT_EQ(sealed.size(), text.size() + kNonceSealAdded_bytes);
    for (std::size_t i = 0; i < clear; ++i) EXPECT_EQ(std::to_integer<std::uint8_t>(sealed.at(i)), text.at(i));
    EXPECT_EQ(open_by_nonce(sealed, clear, key), text);
    EXPECT_NE(seal_by_nonce(text, clear, key), sealed) << "each time by another nonce";
    EXPECT_FALSE(open_by_nonce(sealed, clear, keys::SymmetricKey::random()));
  }
}

TEST(NonceSeal, DoesNotOpenWhatWasChangedOrCut) {
  const keys::SymmetricKey key = keys::SymmetricKey::random();
  const auto sealed = seal_by_nonce(std::vector<std::uint8_t>(9, 7), 3, key);
  for (std::size_t i = 0; i < sealed.size(); ++i) {
    auto changed = sealed;
    changed.at(i) ^= std::byte{1};
    EXPECT_FALSE(open_by_nonce(changed, 3, key)) << i;
    EXPECT_FALSE(open_by_nonce(std::span(sealed).first(i), 3, key)) << i;
  }
  EXPECT_FALSE(open_by_nonce(sealed, 2, key));
}

}  // namespace peerd::seal::nonce_seal_test
