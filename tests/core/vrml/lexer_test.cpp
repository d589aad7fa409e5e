#include "core/vrml/lexer.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace peerd::vrml::lexer_test {

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> out;
  Lexer lexer(text);
  for (Token t = lexer.next(); t.kind != TokenKind::kEnd; t = lexer.next()) out.emplace_back(t.text);
  return out;
}

std::vector<TokenKind> kinds(std::string_view text) {
  std::vector<TokenKind> out;
  Lexer lexer(text);
  for (Token t = lexer.next(); t.kind != TokenKind::kEnd; t = lexer.next()) out.push_back(t.kind);
  return out;
}

using testing::ElementsAre;
using enum TokenKind;

TEST(Lexer, CutsATypicalNode) {
  EXPECT_THAT(words("DEF A Box{size 1 -2.5e3,+.5}#end"),
              ElementsAre("DEF", "A", "Box", "{", "size", "1", "-2.5e3", "+.5", "}"));
}

TEST(Lexer, TreatsCommasAndCommentsAsWhiteSpace) {
  EXPECT_THAT(words(",,1,2# 3 } \" \r4,"), ElementsAre("1", "2", "4"));
}

TEST(Lexer, LetsNamesHoldWhatTheStandardAllows) {
  EXPECT_THAT(kinds("a+b-c:d/e(f)|g \xC3\xA4 _0"), ElementsAre(kWord, kWord, kWord));
}

TEST(Lexer, SeparatesRouteEnds) {
  EXPECT_THAT(kinds("ROUTE a.b TO c.d"), ElementsAre(kWord, kWord, kPeriod, kWord, kWord, kWord, kPeriod, kWord));
}

TEST(Lexer, KeepsABadNumberInOnePiece) {
  EXPECT_THAT(words("12abc 1.2.3 1e+ -1.#IND 1.#QNAN 2#3"),
              ElementsAre("12abc", "1.2.3", "1e+", "-1.#IND", "1.#QNAN", "2"));
}

TEST(Lexer, FindsTheEndOfStrings) {
  EXPECT_THAT(words(R"("a \" b" "c\\" "d#e")"), ElementsAre(R"(a \" b)", R"(c\\)", "d#e"));
  EXPECT_EQ(unescaped(R"(a \" b\\ \n)"), "a \" b\\ \\n");
  EXPECT_THAT(kinds("1 \"open }"), ElementsAre(kNumber, kUnterminatedString));
}

TEST(Lexer, GathersBytesThatNoTokenContains) {
  const std::string_view text("a '\\\x01\x7f b\0c", 10);
  EXPECT_THAT(kinds(text), ElementsAre(kWord, kInvalid, kWord, kInvalid, kWord));
}

TEST(Lexer, KnowsWhereItsTokensStand) {
  Lexer lexer("a\nb\r\nc\rd \xC3\xA4 e \"x\ny\" f");
  for (const std::uint32_t offset : {0u, 2u, 5u, 7u, 9u, 12u, 14u, 20u}) EXPECT_EQ(lexer.next().offset, offset);
  const Token end = lexer.next();
  EXPECT_EQ(end.kind, kEnd);
  EXPECT_EQ(end.offset, 21u);
}

TEST(Lexer, GoesOnFromAnOffset) {
  const std::string_view text = "a\n  b c";
  Lexer lexer(text, 1);
  EXPECT_EQ(lexer.next().text, "b");
  Lexer copy = lexer;
  EXPECT_EQ(copy.next().text, "c");
  EXPECT_EQ(lexer.next().text, "c");
  lexer.go_to(0);
  EXPECT_EQ(lexer.next().text, "a");
  lexer.stop();
  EXPECT_EQ(lexer.next().kind, kEnd);
}

// Annex A.3: what a name may begin with and hold.
TEST(Lexer, JudgesEveryByteOfANameAsTheStandardDoes) {
  for (int c = 0; c < 256; ++c) {
    const std::string byte(1, static_cast<char>(c));
    const bool never = c <= 0x20 || c == 0x7f || std::string_view("\"'#,.[\\]{}").find(byte) != std::string_view::npos;
    const bool not_first = never || (c >= '0' && c <= '9') || c == '+' || c == '-';
    EXPECT_EQ(Lexer(byte + "a").next().text == byte + "a" && Lexer(byte + "a").next().kind == kWord, !not_first) << c;
    EXPECT_EQ(Lexer("a" + byte + "a").next().text == "a" + byte + "a", !never) << c;
  }
}

TEST(Lexer, CountsNumbersUpToTheBracket) {
  EXPECT_EQ(Lexer(" 1 2,3\n4 ] 5").count_numbers().numbers, 4u);
  EXPECT_EQ(Lexer(" 1 2,3\n4 ] 5").count_numbers().end, 9u);
  EXPECT_EQ(Lexer("").count_numbers().numbers, 0u);
  EXPECT_EQ(Lexer("1 2").count_numbers().end, 3u);
}

struct HeaderCase {
  const char* text;
  const char* problem;  // part of it; nullptr: good
};
class Header : public testing::TestWithParam<HeaderCase> {};
TEST_P(Header, IsJudged) {
  const auto result = read_header(GetParam().text);
  if (GetParam().problem == nullptr) {
    EXPECT_TRUE(result.has_value());
  } else {
    ASSERT_FALSE(result.has_value());
    EXPECT_THAT(result.error().why, testing::HasSubstr(GetParam().problem));
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, Header,
    testing::Values(HeaderCase{"#VRML V2.0 utf8", nullptr}, HeaderCase{"#VRML V2.0 utf8 comment\r\nGroup{}", nullptr},
                    HeaderCase{"#VRML V2.0 utf8\t\n", nullptr},
                    HeaderCase{"#VRML V1.0 ascii\nSeparator {}", "VRML 1.0"}, HeaderCase{"#X3D V3.0 utf8\n", nullptr},
                    HeaderCase{"#X3D V4.0 utf8x\n", "none of X3D"}, HeaderCase{"#X3D V2.0 utf8\n", "none of X3D"},
                    HeaderCase{"#X3D V3. utf8\n", "none of X3D"}, HeaderCase{"<?xml version='1.0'?><X3D/>", nullptr},
                    HeaderCase{"#VRML V2.0 utf8\rGroup{}", nullptr}, HeaderCase{"#VRML V2.0 UTF8\n", "must begin with"},
                    HeaderCase{"#VRML V2.1 utf8\n", "must begin with"},

                    HeaderCase{" #VRML V2.0 utf8\n", "must begin with"}, HeaderCase{"#VRML V1.0 utf8\n", "VRML 1.0"},
                    HeaderCase{"", "empty"}, HeaderCase{"# VRML V2.0 utf8\n", "must begin with"},
                    HeaderCase{"#VRML V2.0 utf8x\n", "must begin with"}, HeaderCase{"Group {}", "must begin with"}));

TEST(ReadHeader, RemarksOnWhatIsHarmless) {
  EXPECT_EQ(read_header("#VRML V2.0 utf8 #generator\nGroup { }")->remark, "");
  EXPECT_EQ(read_header("#VRML V2.0 utf8 #generator\nGroup { }")->end, 26u);
  EXPECT_EQ(read_header("#VRML V2.0 utf8")->end, 15u);
  EXPECT_THAT(read_header("#VRML  V2.0\tutf8\n")->remark, testing::HasSubstr("one blank apart"));
  EXPECT_THAT(read_header("\xEF\xBB\xBF#VRML V2.0 utf8\r\n")->remark, testing::HasSubstr("byte order mark"));
  EXPECT_EQ(read_header("\xEF\xBB\xBF#VRML V2.0 utf8\r\n")->end, 18u);
}

TEST(ReadFloat, TakesUnderflowForZeroAndRefusesOverflow) {
  for (const char* tiny : {"1e-60", "-1e-60", "1e-400", "0.0e-99999999999999999999", "0e999", "0.000001e-399"}) {
    ASSERT_TRUE(read_float(tiny).has_value()) << tiny;
    EXPECT_EQ(*read_float(tiny), 0.0f) << tiny;
  }
  for (const char* huge : {"1e39", "-1e400", "3.5e38", "1e99999999999999999999", "1000000e399"}) {
    ASSERT_FALSE(read_float(huge).has_value()) << huge;
    EXPECT_EQ(read_float(huge).error(), NumberError::kOverflow) << huge;
  }
}

TEST(ReadFloat, RefusesWhatIsNoNumber) {
  for (const char* text : {"", "-", "+", "+-1", "++1", "1.2.3", "12abc", "0x10", "1e", "1.#QNAN"}) {
    ASSERT_FALSE(read_float(text).has_value()) << text;
    EXPECT_EQ(read_float(text).error(), NumberError::kSyntax) << text;
  }
  for (const char* text : {"-nan", "-inf", "-INF", "-Infinity"}) {
    ASSERT_FALSE(read_float(text).has_value()) << text;
    EXPECT_EQ(read_float(text).error(), NumberError::kNotFinite) << text;
  }
}

TEST(ReadInt32, TakesDecimalAndHexadecimal) {
  EXPECT_EQ(read_int32("-2147483648"), std::numeric_limits<std::int32_t>::min());
  EXPECT_EQ(read_int32("+7"), 7);
  EXPECT_EQ(read_int32("0xFF"), 255);
  EXPECT_EQ(read_int32("0XfFfFfFfF"), -1);
  for (const char* text : {"2147483648", "-2147483649", "0x100000000", "99999999999"}) {
    EXPECT_EQ(read_int32(text).error(), NumberError::kOverflow) << text;
  }
  for (const char* text : {"1.0", "1e3", "0x", "-", "--1", "x"}) {
    EXPECT_EQ(read_int32(text).error(), NumberError::kSyntax) << text;
  }
}

}  // namespace peerd::vrml::lexer_test
