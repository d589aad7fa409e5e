#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/figures.hpp"
#include "tests/peerd/report_samples.hpp"
#include "tests/peerd/well_formed.hpp"

namespace peerd::report::pareto_figure_test {

const measure::ScenarioInfo kInfo{"zigzag", "sim", 7, {}};

TEST(ParetoFigure, HasAFrontForEachNetworkAndMarksWhatIsBeaten) {
  const std::string svg = pareto_figure(measure::summarise(kInfo, measure::samples::zigzag_sweep()));
  EXPECT_FALSE(testing_support::malformed(svg));
  for (const char* front : {">latency 5 ms</text>", ">latency 100 ms</text>", ">latency 500 ms</text>"}) {
    EXPECT_THAT(svg, testing::HasSubstr(front));
  }
  EXPECT_THAT(svg, testing::HasSubstr(">beaten by another</text>"));
}

TEST(ParetoFigure, NeedsTwoRuns) {
  const measure::RunRecord run = measure::samples::zigzag_run(0.1);
  EXPECT_EQ(pareto_figure(measure::summarise(kInfo, {&run, 1})), "");
}

}  // namespace peerd::report::pareto_figure_test
