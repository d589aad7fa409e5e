#include "peerd/lab/report/figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::timeline_figure_test {

const measure::ScenarioInfo kInfo{"zig & <zag>", "sim", 7, {}};

// The figure says how many contacts it leaves out: here 1,000 of 4,000.
TEST(TimelineFigure, SaysWhatItLeavesOut) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  run.contacts.clear();
  for (int i = 0; i < 4000; ++i) {
    const double t_s = 0.0025 * i;
    run.contacts.push_back(
        {t_s, measure::samples::kA, "owner", measure::samples::kCar, measure::samples::kWall, Vec3::UnitX(), t_s});
  }
  const std::string svg = timeline_figure(kInfo, run, 1, figure_frame({&run, 1}, measure::summarise(kInfo, {&run, 1})));
  EXPECT_THAT(svg, testing::HasSubstr(">4000 to an own object</text>"));
  EXPECT_THAT(svg, testing::HasSubstr(">1000 not drawn</text>"));
}

}  // namespace peerd::report::timeline_figure_test
