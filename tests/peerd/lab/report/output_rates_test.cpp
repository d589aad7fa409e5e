#include "peerd/lab/report/output_rates.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/peerd/report_samples.hpp"

namespace peerd::report::output_rates_test {

using measure::samples::kA, measure::samples::kB;

TEST(OutputRates, AreKilobytesASecondOfOnePeer) {
  measure::RunRecord run = measure::samples::quiet_run(2.5);
  run.datagrams = {{0.1, kA, 500}, {0.9, kA, 500}, {1.5, kB, 9000}, {2.4, kA, 100}};
  const auto rates = output_rates(run, kA);
  ASSERT_EQ(rates.size(), 3u);
  EXPECT_DOUBLE_EQ(rates[0], 1.0);
  EXPECT_DOUBLE_EQ(rates[1], 0.0);
  EXPECT_DOUBLE_EQ(rates[2], 0.2) << "half a second at the end is divided by half a second";
}

TEST(OutputRates, LongRunsHaveWiderBinsAndLoseNoByte) {
  EXPECT_EQ(output_bin_s(120.0), 1.0);
  EXPECT_GT(output_bin_s(121.0), 1.0);
  measure::RunRecord run = measure::samples::quiet_run(1000.0);
  for (int i = 0; i < 1000; ++i) run.datagrams.push_back({static_cast<double>(i), kA, 100});
  run.datagrams.push_back({1000.0, kA, 100});
  const auto rates = output_rates(run, kA);
  EXPECT_LE(rates.size(), 120u);
  EXPECT_NEAR(std::accumulate(rates.begin(), rates.end(), 0.0) * output_bin_s(1000.0), 100.1, 1e-9);
}

TEST(OutputRates, ARunOfNoTimeHasNone) { EXPECT_TRUE(output_rates(measure::samples::quiet_run(0.0), kA).empty()); }

}  // namespace peerd::report::output_rates_test
