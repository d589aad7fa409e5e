#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/figures.hpp"
#include "tests/peerd/report_samples.hpp"
#include "tests/peerd/well_formed.hpp"

namespace peerd::report::overview_figure_test {

using testing::HasSubstr;

const measure::ScenarioInfo kInfo{"zigzag", "sim", 7, {}};

TEST(OverviewFigure, HasALineForEachValueOfTheOtherKey) {
  const std::string svg = overview_figure(measure::summarise(kInfo, measure::samples::zigzag_sweep()));
  EXPECT_FALSE(testing_support::malformed(svg));
  EXPECT_THAT(svg, HasSubstr(">latency [ms]</text>")) << "the numeric key is the x axis";
  EXPECT_THAT(svg, HasSubstr(">dr</text>"));
  EXPECT_THAT(svg, HasSubstr(">dr+rcp</text>"));
}

TEST(OverviewFigure, OfOneRunHasABarForEachObserver) {
  const measure::RunRecord run = measure::samples::zigzag_run(0.1);
  const std::string svg = overview_figure(measure::summarise(kInfo, {&run, 1}));
  EXPECT_THAT(svg, HasSubstr(">b, mean</text>"));
  EXPECT_THAT(svg, HasSubstr(">c, max</text>"));
}

TEST(OverviewFigure, RepeatedRunsAreTheirMean) {
  measure::ScenarioInfo twice = kInfo;
  twice.repeat = 2;
  std::vector<measure::RunRecord> runs;
  for (const measure::RunRecord& run : measure::samples::zigzag_sweep()) runs.insert(runs.end(), 2, run);
  EXPECT_EQ(testing_support::count_of(overview_figure(measure::summarise(twice, runs)), "<circle"),
            testing_support::count_of(overview_figure(measure::summarise(kInfo, measure::samples::zigzag_sweep())),
                                      "<circle"));
}

}  // namespace peerd::report::overview_figure_test
