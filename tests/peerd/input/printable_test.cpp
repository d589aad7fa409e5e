#include "peerd/input/printable.hpp"

#include <gtest/gtest.h>

namespace peerd::printable_test {

struct Case {
  const char* text;
  std::size_t most;
  const char* shown;
};

TEST(Printable, HasNoControlCharacters) {
  const Case cases[] = {
      {"plain", 10, "plain"},
      {"a\tb\x1b[2J\x7f", 20, "a?b?[2J?"},  // C0 and DEL
      {"a\xc2\x9b"
       "2Jb",
       20, "a?2Jb"},  // CSI, a C1 control as UTF-8
      {"\xc3\xa4\xe2\x82\xac", 20, "\xc3\xa4\xe2\x82\xac"},
      {"", 5, ""},
  };
  for (const Case& c : cases) EXPECT_EQ(printable(c.text, c.most), c.shown);
}

TEST(Printable, IsCutBetweenCharacters) {
  const Case cases[] = {
      {"abcdef", 3, "abc"},
      {"a\xe2\x82\xac", 3, "a"},  // the euro sign has three bytes
      {"a\xe2\x82\xac", 4, "a\xe2\x82\xac"},
      {"abc", 0, ""},
  };
  for (const Case& c : cases) EXPECT_EQ(printable(c.text, c.most), c.shown) << c.text << " " << c.most;
}

TEST(Printable, SaysWhatATerminalCanHaveAsItIs) {
  for (const char* const good : {"", "town", "\u00f6/..", "\u4e16\u754c"}) EXPECT_TRUE(is_printable(good)) << good;
  for (const char* const bad : {"a\n", "\x1b[2J", "\x7f", "a\u009b1m", "\xff"}) EXPECT_FALSE(is_printable(bad)) << bad;
}

TEST(Counted, HasAnSButOfOne) {
  EXPECT_EQ(counted(0, "error"), "0 errors");
  EXPECT_EQ(counted(1, "error"), "1 error");
  EXPECT_EQ(counted(2, "error"), "2 errors");
  EXPECT_EQ(counted(2, "child", "children"), "2 children");
  EXPECT_EQ(counted(1, "child", "children"), "1 child");
}

}  // namespace peerd::printable_test
