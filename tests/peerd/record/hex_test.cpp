#include "peerd/record/hex.hpp"

#include <gtest/gtest.h>

namespace peerd::record {
namespace {

TEST(Hex, IsWhatItsBytesSay) {
  std::vector<std::byte> all;
  for (int i = 0; i < 256; ++i) all.push_back(static_cast<std::byte>(i));
  const std::string digits = hex_of(all);
  EXPECT_EQ(digits.substr(0, 6), "000102");
  EXPECT_EQ(digits.substr(510), "ff");
  EXPECT_EQ(bytes_of_hex(digits), all);
  EXPECT_EQ(bytes_of_hex(""), std::vector<std::byte>());
}

TEST(Hex, RefusesAllElse) {
  for (const char* const bad : {"0", "0g", "AB", " 0", "0x"}) EXPECT_FALSE(bytes_of_hex(bad)) << bad;
}

}  // namespace
}  // namespace peerd::record
