#include "peerd/daemon/log/log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/has_members.hpp"

namespace peerd::log_test {
namespace {

// Returns what a log of these options writes of these lines.
std::string written(const Log::Options& options, const std::vector<LogLine>& lines) {
  testing::internal::CaptureStdout();
  {
    Log log("ada \"the first\"", options, [] { return HostTime{}; });
    for (const LogLine& line : lines) log(line);
  }
  return testing::internal::GetCapturedStdout();
}

TEST(Log, TextHasTimeLevelAndPeer) {
  EXPECT_THAT(written({}, {{LogLevel::kWarning, "it rains"}}),
              testing::ContainsRegex("^[0-9:.]+ warning ada \"the first\": it rains\n$"));
}

TEST(Log, JsonIsOneObjectForEachLine) {
  const std::string text =
      written({.format = LogFormat::kJson}, {{LogLevel::kError, "two\nlines of \"text\" {not a field} %v"}});
  EXPECT_EQ(std::ranges::count(text, '\n'), 1);
  const auto line = nlohmann::json::parse(text);
  EXPECT_THAT(line, HasMembers(R"(
    {"peer": "ada \"the first\"", "level": "error", "text": "two\nlines of \"text\" {not a field} %v"})"));
}

TEST(Log, TheJournalGetsPriorities) {
  EXPECT_EQ(
      written({.format = LogFormat::kJournal, .verbose = true},
              {{LogLevel::kError, "e"}, {LogLevel::kWarning, "w"}, {LogLevel::kInfo, "i"}, {LogLevel::kDebug, "d"}}),
      "<3>e\n<4>w\n<6>i\n<7>d\n");
}

TEST(Log, SaysHowManyLinesItLeftOut) {
  std::vector<LogLine> lines(7, {LogLevel::kInfo, "ball 8 hits ball 9"});
  EXPECT_EQ(
      written({.format = LogFormat::kJournal, .limits = {.most = 2, .per_second = 1.0}}, lines),
      "<6>ball 8 hits ball 9\n<6>ball 8 hits ball 9\n<4>5 lines like this one were left out: ball # hits ball #\n");
}

TEST(Log, LeavesNoDebugLineOutAndCountsNoneThatNobodyWants) {
  std::vector<LogLine> lines(5, {LogLevel::kDebug, "update"});
  const LineLimiter::Limits one{.most = 1, .per_second = 1.0};
  EXPECT_EQ(written({.format = LogFormat::kJournal, .verbose = true, .limits = one}, lines),
            "<7>update\n<7>update\n<7>update\n<7>update\n<7>update\n");
  EXPECT_EQ(written({.format = LogFormat::kJournal, .limits = one}, lines), "");
}

TEST(Log, ChangesWhileItIsUsed) {
  testing::internal::CaptureStdout();
  {
    Log log("a", {.format = LogFormat::kJournal, .limits = {.most = 1, .per_second = 1.0}}, [] { return HostTime{}; });
    log({LogLevel::kDebug, "before"});
    log.change(true, {.most = 5, .per_second = 1.0});
    log({LogLevel::kDebug, "after"});
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "<7>after\n");
}

}  // namespace
}  // namespace peerd::log_test
