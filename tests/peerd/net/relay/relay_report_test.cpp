#include "peerd/net/relay/relay_report.hpp"

#include <gtest/gtest.h>

#include "tests/peerd/net/relay/relay_fixture.hpp"

namespace peerd::relay::relay_report_test {

using namespace relay::testing_support;

using RelayReportTest = RelayFixture;

TEST_F(RelayReportTest, ABudgetLimitsALinkAndIsCounted) {
  RelayUnderTest relay(io, 0, {}, nullptr, /*budget_bytes_per_s=*/4'000.0);
  relay.relay->start();
  Peer a(by_relay({0})), b(by_relay({0}), {0, 5});
  ASSERT_TRUE(run_until(io, [&] { return a.can_send(5) && a.can_send(0); }));
  const std::string text(494, 'x');  // 500 bytes with the header: three at once, and one more for all
  for (int i = 0; i < 20; ++i) a.send(5, text);
  a.send(0, "for all");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty() && b.heard.back() == "0 for all"; }));
  EXPECT_GE(b.heard.size(), 4u);
  EXPECT_LT(b.heard.size(), 12u);
  EXPECT_GT(relay.relay->counters().over_budget, 8u);
  const auto report = report_of(*relay.relay);
  EXPECT_EQ(report["counters"]["relay.over_budget"], relay.relay->counters().over_budget);
  EXPECT_EQ(report["links"].size(), 2u);
}

}  // namespace peerd::relay::relay_report_test
