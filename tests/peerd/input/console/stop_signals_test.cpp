#include "peerd/input/console/stop_signals.hpp"

#include <gtest/gtest.h>

#include <csignal>

namespace peerd::stop_signals_test {

TEST(StopSignals, NotesTheFirstSignal) {
  StopSignals signals("at once");
  signals.note_from_now_on("second");
  EXPECT_EQ(signals.signal(), 0);
  std::raise(SIGTERM);
  EXPECT_EQ(signals.signal(), SIGTERM);
  EXPECT_EQ(signals.signal_name(), "SIGTERM");
  EXPECT_EQ(signals.exit_code(), 143);
}

TEST(StopSignals, GivesTheSignalsBack) {
  struct sigaction before {
  }, after{};
  sigaction(SIGINT, nullptr, &before);
  { const StopSignals signals("at once"); }
  sigaction(SIGINT, nullptr, &after);
  EXPECT_EQ(before.sa_handler, after.sa_handler);
}

TEST(StopSignals, LeavesAnIgnoredSignalIgnored) {
  const auto before = std::signal(SIGINT, SIG_IGN);
  {
    StopSignals signals("at once");
    signals.note_from_now_on("second");
    ASSERT_EQ(std::raise(SIGINT), 0);
    EXPECT_EQ(signals.signal(), 0) << "a program in the background ignores Ctrl-C";
  }
  EXPECT_EQ(std::signal(SIGINT, before), SIG_IGN);
}

TEST(StopSignalsDeathTest, EndAtOnceWhileNothingCanBeSaved) {
  EXPECT_EXIT(
      {
        const StopSignals signals("nothing is written");
        std::raise(SIGINT);
      },
      testing::ExitedWithCode(130), "nothing is written");
}

TEST(StopSignalsDeathTest, TheSecondSignalEndsAtOnce) {
  EXPECT_EXIT(
      {
        StopSignals signals("first");
        signals.note_from_now_on("not complete");
        std::raise(SIGINT);
        std::raise(SIGTERM);
      },
      testing::ExitedWithCode(143), "not complete");
}

}  // namespace peerd::stop_signals_test
