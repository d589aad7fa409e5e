#include "peerd/input/secret_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <new>

namespace peerd {
namespace {

TEST(SecretTexts, AreWipedWhereTheyEnd) {
  constexpr std::string_view kSecret = "correct horse battery staple";
  alignas(SecretText) std::array<char, sizeof(SecretText)> place{};
  auto* const text = new (place.data()) SecretText;
  for (const char c : kSecret) ASSERT_TRUE(text->append(c));
  EXPECT_EQ(text->view(), kSecret);
  const auto has_it = [&] { return !std::ranges::search(place, kSecret.substr(0, 4)).empty(); };
  EXPECT_TRUE(has_it());
  std::destroy_at(text);
  EXPECT_FALSE(has_it());
}

TEST(SecretTexts, HaveARoomOfTheirOwn) {
  SecretText text;
  for (std::size_t i = 0; i < SecretText::kBytesMax; ++i) ASSERT_TRUE(text.append('a'));
  EXPECT_FALSE(text.append('b'));
  EXPECT_EQ(text.view(), std::string(SecretText::kBytesMax, 'a'));
}

}  // namespace
}  // namespace peerd
