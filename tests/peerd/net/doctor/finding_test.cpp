#include "peerd/net/doctor/finding.hpp"

#include <gtest/gtest.h>

namespace peerd::doctor::finding_test {

const Finding kGoodOne{"mtu", Level::kGood, "whole"}, kHintOne{"clock", Level::kHint, "unsteered", "steer it"},
    kWarningOne{"reach", Level::kWarning, "alone"}, kProblemOne{"reach", Level::kProblem, "none"};

TEST(Finding, TheWorstOneDecidesTheExitCode) {
  EXPECT_EQ(exit_code_of({}), 0);
  EXPECT_EQ(exit_code_of(std::vector{kGoodOne, kHintOne}), 0);
  EXPECT_EQ(exit_code_of(std::vector{kWarningOne, kHintOne}), 1);
  EXPECT_EQ(exit_code_of(std::vector{kProblemOne, kWarningOne}), 3);
}

TEST(Finding, IsALineOfText) {
  EXPECT_EQ(as_text(std::vector{kGoodOne, kHintOne}),
            "mtu             whole\nclock           hint: unsteered; steer it\n");
}

TEST(Finding, IsAnObject) {
  EXPECT_EQ(as_json(std::vector{kHintOne}).dump(),
            R"([{"name":"clock","level":"hint","sentence":"unsteered","advice":"steer it"}])");
}

}  // namespace peerd::doctor::finding_test
