#include "peerd/cli/shell/number_checks.hpp"

#include <gtest/gtest.h>

#include <string>

namespace peerd::number_checks_test {

// What the check makes of a word; empty: it refuses it.
std::string taken(const CLI::Validator& check, std::string word) { return check(word).empty() ? word : ""; }

TEST(NumberChecks, TakeFiniteNumbersOfTheRange) {
  const CLI::Validator check = number_in({-1.5, 2.0});
  for (const char* good : {"0", "-1.5", "2", "1e-3"}) EXPECT_NE(taken(check, good), "") << good;
  for (const char* bad : {"2.1", "-1.6", "nan", "inf", "0x1", "1,5", "", "one", "1 "}) {
    EXPECT_EQ(taken(check, bad), "") << bad;
  }
}

TEST(NumberChecks, WholeNumbersAreDecimal) {
  const CLI::Validator check = whole_number_in(0, 100);
  EXPECT_EQ(std::stoi(taken(check, "010"), nullptr, 0), 10) << "no octal number";
  EXPECT_EQ(std::stoi(taken(check, "100"), nullptr, 0), 100);
  for (const char* bad : {"-1", "101", "1.5", "18446744073709551615", ""}) EXPECT_EQ(taken(check, bad), "") << bad;
}

}  // namespace peerd::number_checks_test
