#include "peerd/net/keys/identity.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/must.hpp"

namespace peerd::keys {
namespace {

const std::vector<std::uint8_t> kBytes{1, 2, 3};

TEST(Identity, SignsForOneUseAndOneTextAlone) {
  const Identity one = Identity::random(), other = Identity::random();
  const auto signature = one.sign("use", kBytes);
  EXPECT_TRUE(one.public_key().has_signed("use", kBytes, signature));
  EXPECT_FALSE(other.public_key().has_signed("use", kBytes, signature));
  EXPECT_FALSE(one.public_key().has_signed("us", std::vector<std::uint8_t>{'e', 1, 2, 3}, signature));
  EXPECT_FALSE(one.public_key().has_signed("use", std::vector<std::uint8_t>{1, 2}, signature));
  for (std::size_t i = 0; i < signature.size(); ++i) {
    auto forged = signature;
    forged[i] ^= 1;
    EXPECT_FALSE(one.public_key().has_signed("use", kBytes, forged)) << i;
  }
}

TEST(Identity, IsWhatItsTextSays) {
  const Identity one = Identity::random();
  EXPECT_EQ(must(Identity::of_text(one.text())).public_key(), one.public_key());
  const auto key = must(PublicKey::of_text(one.public_key().text()));
  EXPECT_EQ(key, one.public_key());
  EXPECT_TRUE(one.public_key().text().ends_with(key.text().substr(15)));
}

TEST(Identity, RefusesEveryOtherText) {
  const std::string text = Identity::random().text(), key = Identity::random().public_key().text();
  for (const std::string& bad : {std::string(), text.substr(1), text + "A", text.substr(0, text.size() - 1), key}) {
    EXPECT_FALSE(Identity::of_text(bad)) << bad;
  }
  for (const std::string& bad : {std::string(), key.substr(1), key + "A", key.substr(0, key.size() - 1), text}) {
    EXPECT_FALSE(PublicKey::of_text(bad)) << bad;
  }
}

}  // namespace
}  // namespace peerd::keys
