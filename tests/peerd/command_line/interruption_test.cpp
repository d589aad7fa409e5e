#include "peerd/command_line/interruption.hpp"

#include <gtest/gtest.h>

namespace peerd::interruption_test {

TEST(Interruption, IsRequestedBySigint) {
  const Interruption interruption;
  EXPECT_FALSE(interruption.requested());
  ASSERT_EQ(std::raise(SIGINT), 0);
  EXPECT_TRUE(interruption.requested());
}

TEST(InterruptionDeathTest, TheSecondOneEndsTheProgram) {
  EXPECT_EXIT(
      {
        const Interruption interruption;
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      testing::KilledBySignal(SIGINT), "");
}

TEST(Interruption, LeavesTheSignalAsItWas) {
  const auto before = std::signal(SIGINT, SIG_IGN);
  {
    const Interruption interruption;
    ASSERT_EQ(std::raise(SIGINT), 0);
    EXPECT_FALSE(interruption.requested()) << "a program in the background ignores Ctrl-C";
  }
  EXPECT_EQ(std::signal(SIGINT, before), SIG_IGN);
}

}  // namespace peerd::interruption_test
