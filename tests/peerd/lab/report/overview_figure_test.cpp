#include "peerd/lab/report/figures.hpp"

#include <gtest/gtest.h>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::overview_figure_test {

const measure::ScenarioInfo kInfo{"zigzag", "sim", 7, {}};

TEST(SweepData, HasTheValuesOfAllKeysAndTheMeansOverObservers) {
  const Json sweep = sweep_data(measure::summarise(kInfo, measure::samples::zigzag_sweep()));
  EXPECT_EQ(sweep.at("keys").dump(), R"(["approach","latency [ms]"])");
  ASSERT_EQ(sweep.at("runs").size(), 6u);
  Json run = sweep.at("runs").at(4);
  EXPECT_NEAR(run.at("error_m").get<double>(), 0.31, 0.01);
  run.erase("error_m");
  EXPECT_EQ(run.dump(), R"({"values":["dr+rcp",100],"words":["dr+rcp","latency 100 ms"],"updates":5.0})");
}

TEST(OverviewFigure, OfASingleRunHasABarForEachObserver) {
  const measure::RunRecord run = measure::samples::zigzag_run(0.1);
  const Json figure = overview_figure(measure::summarise(kInfo, {&run, 1}));
  const Json& bars = figure.at("cells").at(0).at("panels").at(0).at("bars");
  ASSERT_EQ(bars.size(), 6u);
  EXPECT_EQ(bars.at(5).at("label"), "c, max");
  EXPECT_EQ(figure.at("cells").at(1).at("panels").at(0).at("bars").dump(),
            R"([{"label":"CAR","value":5.0,"colour":"bar"},{"label":"CUBE","value":1.0,"colour":"bar"}])");
}

}  // namespace peerd::report::overview_figure_test
