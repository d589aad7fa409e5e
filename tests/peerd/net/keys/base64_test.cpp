#include "peerd/net/keys/base64.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace peerd::keys::base64_test {
namespace {

// RFC 4648, section 10, without padding, and the two digits that are others in URLs.
TEST(Base64, IsThatOfTheStandardForUrls) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", ""},           {"f", "Zg"},          {"fo", "Zm8"},          {"foo", "Zm9v"},
      {"foob", "Zm9vYg"}, {"fooba", "Zm9vYmE"}, {"foobar", "Zm9vYmFy"}, {"\xfb\xff", "-_8"}};
  for (const auto& [bytes, text] : cases) {
    EXPECT_EQ(base64_of(std::vector<std::uint8_t>(bytes.begin(), bytes.end())), text);
    std::array<std::uint8_t, 6> out{};
    const auto size = read_base64(text, out);
    ASSERT_TRUE(size) << text;
    EXPECT_EQ(std::string(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(*size)), bytes);
  }
}

// All texts of two characters are tried.
TEST(Base64, EachTextIsOfOtherBytes) {
  int read = 0;
  for (int pair = 0; pair < 1 << 16; ++pair) {
    const std::string text{static_cast<char>(pair & 0xff), static_cast<char>(pair >> 8)};
    std::array<std::uint8_t, 1> out{};
    if (!read_base64(text, out)) continue;
    EXPECT_EQ(base64_of(out), text);
    ++read;
  }
  EXPECT_EQ(read, 256);
}

TEST(Base64, NothingElseIsRead) {
  std::array<std::uint8_t, 2> out{};
  for (const char* const text : {"Zg==", "Zh", "Z", "Zm9v", "+_8", " Zg", "Zg ", "Zg\n"}) {
    EXPECT_FALSE(read_base64(text, out)) << text;
  }
}

}  // namespace
}  // namespace peerd::keys::base64_test
