#include "peerd/input/path_text.hpp"

#include <gtest/gtest.h>

namespace peerd::path_text_test {

TEST(PathText, IsThePathWhereThatIsUtf8) {
  for (const char* const path : {"/a/b c.wrl", "caf\xC3\xA9.wrl", "", "/100%25.wrl"}) {
    EXPECT_EQ(path_text(path), path);
    EXPECT_EQ(path_of_text(path), std::filesystem::path(path));
  }
}

TEST(PathText, KeepsAnyByte) {
  std::string all = "/";
  for (int byte = 1; byte < 256; ++byte) all += static_cast<char>(byte);
  EXPECT_TRUE(is_utf8(path_text(all)));
  EXPECT_EQ(path_of_text(path_text(all)).native(), all);
  EXPECT_EQ(path_text("/caf\xE9.wrl"), "file:///caf%E9.wrl");
}

TEST(Utf8, HasNoOtherBytes) {
  for (const char* const good : {"", "a", "\xC3\xA9", "\xE2\x82\xAC", "\xF0\x9F\x98\x80", "\xED\x9F\xBF"}) {
    EXPECT_TRUE(is_utf8(good)) << good;
  }
  for (const char* const bad : {"\xFF", "\xC3", "\x80", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80",
                                "\xF0\x8F\xBF\xBF", "a\xE2\x82", "\xF5\x80\x80\x80"}) {
    EXPECT_FALSE(is_utf8(bad)) << bad;
  }
}

}  // namespace peerd::path_text_test
