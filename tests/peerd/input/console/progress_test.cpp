#include "peerd/input/console/progress.hpp"

#include <gtest/gtest.h>

#include <array>

namespace peerd::progress_test {

struct Case {
  const char* name;
  std::size_t run;
  std::optional<double> run_s;
  double took_s;
  const char* line;
};

class ProgressLine : public testing::TestWithParam<Case> {};

TEST_P(ProgressLine, SaysHowFarAndHowLong) {
  const std::array<double, 4> runs_s{30, 30, 30, 30};
  const Case& c = GetParam();
  EXPECT_EQ(progress_line({.run = c.run, .runs_s = runs_s, .run_s = c.run_s, .took_s = c.took_s}), c.line);
}
INSTANTIATE_TEST_SUITE_P(
    Table, ProgressLine,
    testing::Values(Case{"Joining", 0, {}, 0.1, "run 1 of 4: the peers are joining"},
                    Case{"NoTellingYet", 0, 1.0, 60.0, "run 1 of 4: 1 of 30 s simulated"},
                    Case{"TooSoon", 1, 0.0, 1.0, "run 2 of 4: 0 of 30 s simulated"},
                    Case{"Half", 2, 0.0, 40.0, "run 3 of 4: 0 of 30 s simulated, 40 s left"},
                    Case{"Minutes", 0, 12.0, 30.0, "run 1 of 4: 12 of 30 s simulated, 4 min 30 s left"},
                    Case{"Hours", 0, 12.0, 3000.0, "run 1 of 4: 12 of 30 s simulated, 7 h 30 min left"},
                    Case{"Lingering", 3, 31.5, 99.0, "run 4 of 4: 30 of 30 s simulated, 0 s left"}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(ProgressDisplay, ShowsNothingWhereThereIsNoTerminal) {
  testing::internal::CaptureStderr();
  {
    ProgressDisplay display(false);
    EXPECT_FALSE(display.due());
    display.clear();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ProgressDisplay, LeavesAnEmptyLineBehind) {
  testing::internal::CaptureStderr();
  {
    ProgressDisplay display(true);
    EXPECT_TRUE(display.due());
    EXPECT_FALSE(display.due()) << "not twice at once";
    display.show("line");
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "\rline\033[K\r\033[K");
}

}  // namespace peerd::progress_test
