#include "peerd/lab/live/netem_settings.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

namespace peerd::live::netem_settings_test {

struct Case {
  const char* name;
  config::LinkSettings link;
  const char* options;
  bool table;
};
class NetemOptions : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Table, NetemOptions,
    testing::Values(Case{"Nothing", {}, "netem limit 1000000000 delay 0.000us", false},
                    Case{"Latency", {.latency_ms = 100}, "netem limit 1000000000 delay 100000.000us", false},
                    Case{"JitterIsAdded",
                         {.latency_ms = 100, .jitter_ms = 20},
                         "netem limit 1000000000 delay 110000.000us 10000.000us distribution peerd",
                         true},
                    Case{"HeldBackByAsMuchAgain",
                         {.latency_ms = 100, .jitter_ms = 20, .reordering = 0.05},
                         "netem limit 1000000000 delay 170000.000us 70000.000us distribution peerd",
                         true},
                    Case{"NothingToBeHeldBackBy", {.reordering = 0.5}, "netem limit 1000000000 delay 0.000us", false},
                    Case{"Loss", {.loss = 0.01}, "netem limit 1000000000 delay 0.000us loss random 1.0000000%", false},
                    Case{"LossInBursts",
                         {.loss = 0.2, .loss_burst = 5},
                         "netem limit 1000000000 delay 0.000us loss gemodel 5.0000000% 20.0000000%",
                         false},
                    Case{"BurstsOfNoLoss", {.loss_burst = 5}, "netem limit 1000000000 delay 0.000us", false},
                    Case{"Duplication",
                         {.duplication = 0.125},
                         "netem limit 1000000000 delay 0.000us duplicate 12.5000000%",
                         false}),
    [](const auto& c) { return std::string(c.param.name); });

TEST_P(NetemOptions, AreThose) {
  const NetemSettings s = netem_settings(GetParam().link);
  EXPECT_EQ(s.options, GetParam().options);
  EXPECT_EQ(!s.table.empty(), GetParam().table);
}

// The delay that netem makes of a table's entry is mean + entry / 8192 of the spread.
std::vector<double> delays_ms(const std::string& table, double mean_ms, double spread_ms) {
  std::vector<double> delays;
  std::istringstream in(table);
  for (int entry; in >> entry;) {
    EXPECT_LE(std::abs(entry), 32767) << "a 16-bit number";
    delays.push_back(mean_ms + entry / 8192.0 * spread_ms);
  }
  return delays;
}

TEST(NetemTable, DelaysAsTheSimulatorDoes) {
  const config::LinkSettings link{.latency_ms = 100, .jitter_ms = 20, .reordering = 0.05};
  const std::vector<double> delays = delays_ms(netem_settings(link).table, 170, 70);
  ASSERT_EQ(delays.size(), 8192u);
  double sum = 0;
  int held = 0;
  for (const double ms : delays) {
    const double rest_ms = ms > 200 ? ms - 120 : ms;  // one more latency + jitter
    EXPECT_GE(rest_ms, 100 - 0.01) << "half a step of 70 ms / 8192";
    EXPECT_LE(rest_ms, 120 + 0.01);
    held += ms > 200;
    sum += rest_ms;
  }
  EXPECT_EQ(held, 410) << "5 % of 8192";
  EXPECT_NEAR(sum / 8192, 110, 0.01) << "uniform";
}

TEST(NetemTable, AllHeldBack) {
  const std::vector<double> delays = delays_ms(netem_settings({.latency_ms = 100, .reordering = 1}).table, 150, 50);
  ASSERT_EQ(delays.size(), 8192u);
  for (const double ms : delays) ASSERT_DOUBLE_EQ(ms, 200);
}

}  // namespace peerd::live::netem_settings_test
