#include "core/vrml/token_stream.hpp"

#include <gmock/gmock.h>

namespace peerd::vrml::token_stream_test {

using testing::ElementsAre;
using testing::IsEmpty;

struct Stream {
  explicit Stream(std::string_view text) : tokens(text, problems.open({"t", text, nullptr}).value(), 0, problems) {}
  std::vector<std::string> messages() {
    std::vector<std::string> out;
    for (const Diagnostic& d : problems.take().diagnostics) out.push_back(d.message);
    return out;
  }
  Problems problems;
  TokenStream tokens;
};

TEST(TokenStream, LooksOneTokenAheadAndAnotherOnRequest) {
  Stream s("Group { 12 }");
  EXPECT_TRUE(s.tokens.at_word("Group"));
  EXPECT_EQ(s.tokens.kind_after(), TokenKind::kOpenBrace);
  EXPECT_EQ(s.tokens.take().text, "Group");
  EXPECT_FALSE(s.tokens.accept(TokenKind::kCloseBrace));
  EXPECT_TRUE(s.tokens.accept(TokenKind::kOpenBrace));
  EXPECT_EQ(s.tokens.peek().text, "12");
  EXPECT_EQ(s.tokens.position(), 8u);
}

TEST(TokenStream, ReportsBytesThatNoTokenContainsAndGoesOn) {
  Stream s("Group \x01\x02 { \"open");
  s.tokens.take();
  EXPECT_TRUE(s.tokens.at(TokenKind::kOpenBrace));
  s.tokens.take();
  EXPECT_TRUE(s.tokens.at(TokenKind::kEnd));
  EXPECT_THAT(s.messages(), ElementsAre("'?\?' cannot stand here: no VRML token contains it",
                                        "this string is never closed: a '\"' is missing"));
}

TEST(TokenStream, TakesPlainNumbersAndStopsAtOthers) {
  Stream s("[ 1 2.5 nan ]");
  EXPECT_EQ(s.tokens.count_numbers(), 3u);
  s.tokens.take();
  std::vector<float> numbers;
  s.tokens.take_numbers<float>([&](float x) { numbers.push_back(x); });
  EXPECT_THAT(numbers, ElementsAre(1.0f, 2.5f));
  EXPECT_TRUE(s.tokens.at_word("nan"));
}

TEST(TokenStream, CountsNoListInsideAListTwice) {
  Stream s("[ [ 1 2");
  EXPECT_GT(s.tokens.count_numbers(), 0u);
  s.tokens.take();
  EXPECT_EQ(s.tokens.count_numbers(), 0u);
}

TEST(TokenStream, SkipsToThePartnerOfABraceAndGivesTheNamesInside) {
  Stream s("{ DEF A Group { children [ DEF B Shape { } ] } ] } End");
  EXPECT_THAT(s.tokens.skip_balanced(), ElementsAre("A", "B"));
  EXPECT_THAT(s.messages(), IsEmpty());
}

TEST(TokenStream, ReportsOnceThatSomethingIsNeverClosed) {
  Stream s("{ DEF A [");
  EXPECT_THAT(s.tokens.skip_balanced(), ElementsAre("A"));
  s.tokens.report_unclosed(0, "Group", '}');
  EXPECT_THAT(s.messages(), ElementsAre("this '{' is never closed"));
}

TEST(TokenStream, EndsWhenThereAreTooManyErrors) {
  Stream s("a b c d");
  for (std::size_t i = 0; i < Problems::kLimit; ++i) s.tokens.error(0, std::to_string(i));
  s.tokens.take();
  EXPECT_TRUE(s.tokens.at(TokenKind::kEnd));
}

TEST(Described, NamesTokensInMessages) {
  EXPECT_EQ(described({TokenKind::kEnd, 0, ""}), "the end of the file");
  EXPECT_EQ(described({TokenKind::kWord, 0, "Box"}), "'Box'");
  EXPECT_EQ(described({TokenKind::kString, 0, "x y"}), "the string \"x y'");
}

}  // namespace peerd::vrml::token_stream_test
