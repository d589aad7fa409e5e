#include "peerd/net/os/os_clock.hpp"

#include <gtest/gtest.h>
#include <sys/timex.h>

namespace peerd::net::os_clock_test {

// Whether the kernel states an error bound for its clock.
bool steered() {
  timex asked{};
  const int state = ntp_adjtime(&asked);
  return state != -1 && state != TIME_ERROR && state != TIME_OOP && (asked.status & STA_UNSYNC) == 0;
}

TEST(OsClock, IsReadWhereTheKernelKnowsItsErrorBound) {
  const HostClock clock;
  const bool before = steered();
  const auto read = read_os_clock(clock);
  if (before != steered()) GTEST_SKIP() << "the clock's state has just changed";
  EXPECT_EQ(read.has_value(), before);
  if (!read) return;
  EXPECT_GT(read->error, Duration{0});
  EXPECT_LT(read->error, std::chrono::seconds(17)) << "the kernel's maxerror ends at 16 s";
  EXPECT_NEAR(to_seconds(read->minus_host), to_seconds(-clock.minus_wall()), 0.05);
}

TEST(OsClock, IsAheadOfAHostClockThatIsBehind) {
  if (!steered()) GTEST_SKIP() << "nothing steers this computer's clock";
  const HostClock host, behind(std::chrono::seconds(-5));
  const auto of_host = read_os_clock(host), of_behind = read_os_clock(behind);
  ASSERT_TRUE(of_host && of_behind);
  EXPECT_NEAR(to_seconds(of_behind->minus_host - of_host->minus_host), 5.0, 0.05);
}

}  // namespace peerd::net::os_clock_test
