#include "peerd/input/number.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace peerd::number_test {

constexpr NumberRange kSmall{-10.0, 10.0};
constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();

TEST(WhyRefused, NamesTheRange) {
  EXPECT_EQ(why_refused(10.0, kSmall), std::nullopt);
  EXPECT_EQ(why_refused(10.5, kSmall), "10.5 is out of range: -10 to 10");
  EXPECT_EQ(why_refused(std::nan(""), kSmall), "nan is out of range: -10 to 10");
  EXPECT_EQ(why_refused(std::numeric_limits<double>::infinity(), {0.0, 1e308}), "inf is out of range: 0 to 1e+308");
}

TEST(ParseNumber, TakesFiniteNumbersOfTheRange) {
  EXPECT_EQ(parse_number("-1.5", kSmall), -1.5);
  EXPECT_EQ(parse_number("+2", kSmall), 2.0);
  EXPECT_EQ(parse_number("1e1", kSmall), 10.0);
  for (const char* text : {"nan", "-nan", "inf", "-inf", "infinity", "x", "1x", " 1", "1 ", "0x10", "+-1", "1,5"}) {
    EXPECT_EQ(parse_number(text, kSmall), std::unexpected(std::string(text) + " is no finite number"));
  }
  EXPECT_EQ(parse_number("", kSmall), std::unexpected("an empty text is no finite number"));
  for (const char* text : {"10.01", "1e400", "-1e400", "1e300"}) {
    EXPECT_EQ(parse_number(text, kSmall), std::unexpected(std::string(text) + " is out of range: -10 to 10"));
  }
}

TEST(ParseWholeNumber, TakesWholeNumbersOfTheRange) {
  EXPECT_EQ(parse_whole_number("010", 0, 20), 10);
  EXPECT_EQ(parse_whole_number("0x1F", 0, 40), 31);
  EXPECT_EQ(parse_whole_number("9223372036854775807", 0, kMost), kMost);
  for (const char* text : {"1.5", "1e3", "nan", "x", "0x", "0x-1", "3x", "--1"}) {
    EXPECT_EQ(parse_whole_number(text, 0, 20), std::unexpected(std::string(text) + " is no whole number"));
  }
  for (const char* text : {"-1", "21", "99999999999999999999", "-99999999999999999999", "0xffffffffffffffffff"}) {
    EXPECT_EQ(parse_whole_number(text, 0, 20), std::unexpected(std::string(text) + " is out of range: 0 to 20"));
  }
}

}  // namespace peerd::number_test
