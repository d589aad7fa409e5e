#include "peerd/lab/cluster/tool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd::cluster::tool_test {

using testing::ElementsAre, testing::HasSubstr, testing::IsEmpty;

TEST(Tool, SaysWhatItWroteAndHowItEnded) {
  const auto end = must(run_tool({"sh", "-c", "echo out; echo err >&2; exit 7"}));
  EXPECT_EQ(end.exit_code, 7);
  EXPECT_EQ(end.out, "out\n");
  EXPECT_EQ(end.err, "err\n");
  EXPECT_EQ(run_tool({"sh", "-c", "kill -9 $$"})->exit_code, 137);
  EXPECT_EQ(run_tool({"sh", "-c", "yes | head -c 100000"})->out.size(), 100'000U);
}

TEST(Tool, ThatIsMissingIsNamed) {
  EXPECT_THAT(error_of(run_tool({"no-such-program-here"})),
              IsError(3, HasSubstr("no-such-program-here can't be started: No such file")));
}

TEST(Words, AreSplitAsByAShell) {
  EXPECT_THAT(*split_words("  "), IsEmpty());
  EXPECT_THAT(*split_words("--partition=short  --time 10\t-q"), ElementsAre("--partition=short", "--time", "10", "-q"));
  EXPECT_THAT(*split_words(R"(--comment="two words" 'a "b" $c' \"d\ e "")"),
              ElementsAre("--comment=two words", "a \"b\" $c", "\"d e", ""));
  EXPECT_EQ(split_words("--comment='x").error().exit_code, 2);
}

}  // namespace peerd::cluster::tool_test
