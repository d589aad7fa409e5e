#include "peerd/daemon/log/line_limiter.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/must.hpp"

namespace peerd::line_limiter_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr HostTime kStart{std::chrono::hours(1)};

struct Case {
  const char *name, *text, *kind;
};
class Kind : public testing::TestWithParam<Case> {};
TEST_P(Kind, IsTheTextWithoutItsNumbers) { EXPECT_EQ(kind_of_line(GetParam().text), GetParam().kind); }
INSTANTIATE_TEST_SUITE_P(Table, Kind,
                         testing::Values(Case{"Empty", "", ""}, Case{"NoNumber", "peer a joined", "peer a joined"},
                                         Case{"Numbers", "peer a (id 17) joined after 2.5 s",
                                              "peer a (id #) joined after # s"},
                                         Case{"Thousands", "1,024 datagrams.", "# datagrams."},
                                         Case{"Address", "from 127.0.0.1:80", "from #:#"},
                                         Case{"AtTheEnd", "at 9.", "at #."}, Case{"Sign", "by -3", "by -#"}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(LineLimiter, LetsABurstThroughAndThenSoManyASecond) {
  LineLimiter limiter({.most = 3, .per_second = 2.0});
  int admitted = 0;
  for (int i = 0; i < 10; ++i) admitted += limiter.admits(kStart, "contact " + std::to_string(i)) ? 1 : 0;
  EXPECT_EQ(admitted, 3);
  EXPECT_FALSE(limiter.admits(kStart + milliseconds(499), "contact 11"));
  EXPECT_TRUE(limiter.admits(kStart + milliseconds(500), "contact 12"));
  EXPECT_FALSE(limiter.admits(kStart + milliseconds(501), "contact 13"));
  for (int i = 0; i < 10; ++i) admitted += limiter.admits(kStart + seconds(60), "contact") ? 1 : 0;
  EXPECT_EQ(admitted, 6) << "no more than a burst is saved up; and without its number it is another kind";
}

TEST(LineLimiter, AFloodOfOneKindHidesNoOther) {
  LineLimiter limiter({.most = 2, .per_second = 1.0});
  for (int i = 0; i < 1000; ++i) (void)limiter.admits(kStart, "contact " + std::to_string(i));
  EXPECT_TRUE(limiter.admits(kStart, "the disk is full"));
}

TEST(LineLimiter, CountsWhatItLeavesOutOnce) {
  LineLimiter limiter({.most = 1, .per_second = 0.001});
  for (int i = 0; i < 5; ++i) (void)limiter.admits(kStart, "a 1");
  for (int i = 0; i < 3; ++i) (void)limiter.admits(kStart + seconds(5), "b 1");
  EXPECT_TRUE(limiter.take_left_out(kStart + LineLimiter::kReportAfter - milliseconds(1)).empty());
  const auto first = only(limiter.take_left_out(kStart + LineLimiter::kReportAfter));
  EXPECT_EQ(first.kind, "a #");
  EXPECT_EQ(first.lines, 4u);
  const auto rest = only(limiter.take_all_left_out());
  EXPECT_EQ(rest.kind, "b #");
  EXPECT_EQ(rest.lines, 2u);
  EXPECT_TRUE(limiter.take_all_left_out().empty());
}

TEST(LineLimiter, ChangesItsLimitsMeanwhile) {
  LineLimiter limiter({.most = 1, .per_second = 0.001});
  EXPECT_TRUE(limiter.admits(kStart, "a"));
  EXPECT_FALSE(limiter.admits(kStart, "a"));
  limiter.limit({.most = 5, .per_second = 10.0});
  EXPECT_TRUE(limiter.admits(kStart + milliseconds(100), "a"));
}

// Whoever can cause lines with a name of their own can cause as many kinds.
TEST(LineLimiter, KeepsNoMoreKindsThanItsLimit) {
  LineLimiter limiter({.most = 1, .per_second = 0.001});
  std::size_t admitted = 0;
  const auto name = [](std::size_t i) { return std::string(1 + i / 26, 'x') + static_cast<char>('a' + i % 26); };
  for (std::size_t i = 0; i < 3 * LineLimiter::kKindsMax; ++i) admitted += limiter.admits(kStart, name(i)) ? 1 : 0;
  EXPECT_LE(admitted, LineLimiter::kKindsMax + 1);
  std::uint64_t left_out = 0;
  for (const auto& kind : limiter.take_all_left_out()) left_out += kind.lines;
  EXPECT_EQ(left_out, 3 * LineLimiter::kKindsMax - admitted);
}

}  // namespace
}  // namespace peerd::line_limiter_test
