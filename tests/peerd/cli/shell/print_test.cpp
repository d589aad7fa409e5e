#include "peerd/cli/shell/print.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace peerd::print_test {

using testing::internal::CaptureStderr, testing::internal::CaptureStdout;
using testing::internal::GetCapturedStderr, testing::internal::GetCapturedStdout;

TEST(Print, AnErrorIsALineAndItsExitCode) {
  CaptureStderr();
  EXPECT_EQ(failed({"error: no", 3}), 3);
  EXPECT_EQ(failed({"w.wrl:1:1: error: several\nlines\n", 1}), 1);
  EXPECT_EQ(GetCapturedStderr(), "error: no\nw.wrl:1:1: error: several\nlines\n");
}

TEST(Print, WarningsGoToStandardError) {
  CaptureStdout();
  CaptureStderr();
  print_warnings(std::vector<std::string>{"warning: a", "warning: b"});
  EXPECT_EQ(GetCapturedStdout(), "");
  EXPECT_EQ(GetCapturedStderr(), "warning: a\nwarning: b\n");
}

}  // namespace peerd::print_test
