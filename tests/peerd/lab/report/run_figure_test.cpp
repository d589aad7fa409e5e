#include "peerd/lab/report/figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::run_figure_test {

const measure::ScenarioInfo kInfo{"zig & <zag>", "sim", 7, {}};

TEST(FigureFrame, DrawsTheCoordinateThatTurns) {
  const std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  const FigureFrame frame = figure_frame(runs, measure::summarise(kInfo, runs));
  EXPECT_EQ(frame.object, "CAR");
  EXPECT_EQ(frame.component, 0);  // z has the greater range, but no turn
}

TEST(FigureFrame, DrawsTheCoordinateThatMovesIfNoneTurns) {
  measure::RunRecord run = measure::samples::quiet_run();
  for (int i = 0; i < 50; ++i) {
    const double t_s = 0.1 * i;
    run.ghost_samples.push_back(measure::samples::ghost_sample(t_s, measure::samples::kB, measure::samples::kCar,
                                                               {0.1 * t_s, 0, -0.3 * t_s}, {1, 0, 0}));
  }
  EXPECT_EQ(figure_frame({&run, 1}, measure::summarise(kInfo, {&run, 1})).component, 2);
}

TEST(FigureFrame, SameScaleForSameLatency) {
  const std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  const FigureFrame frame = figure_frame(runs, measure::summarise(kInfo, runs));
  ASSERT_EQ(frame.error_m.size(), 3u);
  EXPECT_LT(frame.error_m.at("5").hi, frame.error_m.at("500").hi);
}

TEST(RunFigure, CountsTheUpdatesAndNamesTheOwner) {
  const measure::RunRecord run = measure::samples::zigzag_run(0.1);
  const std::string svg = run_figure(kInfo, run, 3, figure_frame({&run, 1}, measure::summarise(kInfo, {&run, 1})));
  EXPECT_THAT(svg, testing::HasSubstr(">5 updates</text>")) << "of CAR alone";
  EXPECT_THAT(svg, testing::HasSubstr("run 3: CAR, run by a</text>"));
  EXPECT_THAT(svg, testing::HasSubstr(">ghost at b</text>"));
  EXPECT_THAT(svg, testing::HasSubstr(">ghost at c</text>"));
}

}  // namespace peerd::report::run_figure_test
