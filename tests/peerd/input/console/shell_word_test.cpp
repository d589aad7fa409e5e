#include "peerd/input/console/shell_word.hpp"

#include <gtest/gtest.h>

#include "peerd/lab/cluster/tool.hpp"

namespace peerd::shell_word_test {

TEST(ShellWord, IsOneWordOfAShell) {
  for (const std::string word : {"", "plain", "a b", "it's", "$HOME `x` \"\\", "*\n?", "/a/b.toml", "x=[1,2]"}) {
    EXPECT_EQ(cluster::run_tool({"sh", "-c", "printf %s. " + shell_word(word)})->out, word + ".");
  }
}

TEST(ShellWord, IsNotQuotedWithoutNeed) {
  EXPECT_EQ(shell_word("configs/a-b_c.toml"), "configs/a-b_c.toml");
  EXPECT_EQ(shell_word("a b"), "'a b'");
}

}  // namespace peerd::shell_word_test
