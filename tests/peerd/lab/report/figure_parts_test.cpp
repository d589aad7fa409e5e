#include "peerd/lab/report/figure_parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/peerd/report_samples.hpp"

namespace peerd::report::figure_parts_test {

using measure::samples::kA, measure::samples::kB;

TEST(OutputRates, AreKilobytesASecondOfOnePeer) {
  measure::RunRecord run = measure::samples::quiet_run(2.5);
  run.datagrams = {{0.1, kA, 500}, {0.9, kA, 500}, {1.5, kB, 9000}, {2.4, kA, 100}};
  EXPECT_THAT(output_rates(run, kA), testing::ElementsAre(1.0, 0.0, testing::DoubleEq(0.2)))
      << "half a second at the end is divided by half a second";
  EXPECT_EQ(output_bin_s(120.0), 1.0);
  EXPECT_EQ(output_bin_s(1000.0), 10.0);
  EXPECT_TRUE(output_rates(measure::samples::quiet_run(0.0), kA).empty());
}

}  // namespace peerd::report::figure_parts_test
