#include "peerd/lab/report/markup.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace peerd::report::markup_test {

TEST(Markup, EscapesWhatMarkupMeans) {
  EXPECT_EQ(markup_text("a < b > c & \"d\" 'e'"), "a &lt; b &gt; c &amp; &quot;d&quot; 'e'");
}

TEST(Markup, ControlCharactersBecomeBlanks) { EXPECT_EQ(markup_text(std::string_view("a\0b\tc\n", 6)), "a b c "); }

TEST(Markup, KeepsUtf8AndReplacesOtherBytes) {
  EXPECT_EQ(markup_text("\xc3\xa4"), "\xc3\xa4");
  EXPECT_EQ(markup_text("\xe4<"), "\xef\xbf\xbd&lt;");
}

}  // namespace peerd::report::markup_test
