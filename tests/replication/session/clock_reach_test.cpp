#include "replication/session/clock_reach.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::clock_reach_test {

using namespace test;

const HostTime kStart{std::chrono::seconds(1'893'456'000)};  // 2030
constexpr Duration kAhead = 10min;

class Reach : public testing::Test {
 protected:
  ClockReach reach{kAhead};
};

TEST_F(Reach, ANewcomerIsFree) {
  EXPECT_TRUE(reach.is_free(kStart, true));
  EXPECT_EQ(reach.preferred(kStart, {}).most, kAhead);
  EXPECT_EQ(reach.preferred(kStart, 1h).most, 1h + kAhead) << "the later one of its clocks counts";
  EXPECT_EQ(reach.preferred(kStart, -1h).most, kAhead);
  EXPECT_EQ(reach.at(kStart, {}).most, ClockReach::kFreeAhead);
  EXPECT_GT(reach.at(HostTime{1h}, {}).most, kStart.time_since_epoch()) << "1970 is surely wrong";
}

TEST_F(Reach, CountsFromWhereItHasEntered) {
  reach.enter(kStart, 24h);
  reach.on_company(kStart);
  EXPECT_NEAR(to_seconds(reach.at(kStart, {}).most), to_seconds(24h + kAhead), 1e-3);
  EXPECT_NEAR(to_seconds(reach.at(kStart, {}).least), to_seconds(24h - kAhead), 1e-3);
  reach.on_company(kStart + 1000s);
  EXPECT_NEAR(to_seconds(reach.at(kStart + 1000s, {}).most), to_seconds(24h + kAhead) + 1.0, 0.01) << "clocks drift";
  EXPECT_NEAR(to_seconds(reach.at(kStart, 48h).most), to_seconds(48h + kAhead), 1e-3);
}

TEST_F(Reach, CompanyLastsAMinute) {
  reach.enter(kStart, 0s);
  EXPECT_TRUE(reach.is_free(kStart, false)) << "nobody has come yet";
  EXPECT_FALSE(reach.is_free(kStart, true)) << "it knows the time";
  reach.on_company(kStart);
  EXPECT_FALSE(reach.is_free(kStart + 60s, false));
  EXPECT_TRUE(reach.is_free(kStart + 61s, false));
}

TEST_F(Reach, AGapLetsSessionTimeStayBehind) {
  reach.on_gap(5s);
  reach.enter(kStart, 0s);
  reach.on_company(kStart);
  const OffsetBounds before = reach.at(kStart, {});
  reach.on_gap(1h);
  EXPECT_EQ(reach.at(kStart, {}).least, before.least - 1h);
  EXPECT_EQ(reach.at(kStart, {}).most, before.most);
}

}  // namespace peerd::replication::clock_reach_test
