#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "peerd/measure/summary.hpp"
#include "peerd/report/figures.hpp"
#include "tests/peerd/report_samples.hpp"
#include "tests/peerd/well_formed.hpp"

namespace peerd::report::plan_figure_test {

using testing::HasSubstr;

const ScenarioInfo kInfo{"zigzag", "sim", 7, {}};

TEST(PlanFigure, DrawsTheRunThatErrsMost) {
  const std::vector<RunRecord> runs = samples::zigzag_sweep();
  const std::string svg = plan_figure(kInfo, runs, summarise(kInfo, runs));
  EXPECT_FALSE(testing_support::malformed(svg));
  EXPECT_THAT(svg, HasSubstr("latency 500 ms"));
  EXPECT_THAT(svg, HasSubstr(">ghost at b</text>"));
  EXPECT_THAT(svg, HasSubstr(">other objects at the start</text>"));
}

TEST(PlanFigure, SaysWhereThereIsNothingToDraw) {
  const std::vector<RunRecord> runs{samples::quiet_run()};
  EXPECT_THAT(plan_figure(kInfo, runs, summarise(kInfo, runs)), HasSubstr("no object that another peer observes"));
}

}  // namespace peerd::report::plan_figure_test
