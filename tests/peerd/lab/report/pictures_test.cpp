#include "peerd/lab/report/pictures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/figures.hpp"
#include "tests/peerd/report_samples.hpp"
#include "tests/peerd/well_formed.hpp"

namespace peerd::report::pictures_test {

using testing_support::count_of, testing_support::malformed;

const measure::ScenarioInfo kInfo{"zig & <zag>", "sim", 7, {}};

void expect_figures(const std::vector<measure::RunRecord>& runs) {
  const nlohmann::ordered_json summary = measure::summarise(kInfo, runs);
  const FigureFrame frame = figure_frame(runs, summary);
  std::vector<std::string> pictures{overview_figure(summary), plan_figure(kInfo, runs, summary)};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    pictures.push_back(run_figure(kInfo, runs[i], i + 1, frame));
    pictures.push_back(timeline_figure(kInfo, runs[i], i + 1, frame));
  }
  for (const std::string& of_sweeps : {pareto_figure(summary), multiples_figure(kInfo, runs, frame)}) {
    if (!of_sweeps.empty()) pictures.push_back(of_sweeps);
  }
  for (const std::string& picture : pictures) {
    EXPECT_FALSE(malformed(picture)) << *malformed(picture);
    EXPECT_EQ(picture.find("<script"), std::string::npos);
    EXPECT_THAT(picture, testing::HasSubstr("</text>"));
  }
}

TEST(Figures, AreWellFormed) { expect_figures(measure::samples::zigzag_sweep()); }
TEST(Figures, OfOneRun) { expect_figures({measure::samples::zigzag_run(0.1)}); }

// Events are vertical lines with their names; names that would cover each other go below.
TEST(Figures, MarkTheEvents) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  const auto draw = [&] {
    const FigureFrame frame = figure_frame({&run, 1}, measure::summarise(kInfo, {&run, 1}));
    return std::array{run_figure(kInfo, run, 1, frame), timeline_figure(kInfo, run, 1, frame)};
  };
  for (const std::string& svg : draw()) EXPECT_EQ(count_of(svg, std::string(kEventColour)), 0u);
  run.events = {{0.2 * run.duration_s, "apart & away"}, {0.21 * run.duration_s, "strike"}, {run.duration_s, "the-end"}};
  for (const std::string& svg : draw()) {
    EXPECT_EQ(count_of(svg, std::string(kEventColour)), 3u * (3 + 1)) << "three panels and a name each";
    EXPECT_EQ(count_of(svg, ">apart &amp; away<"), 1u);
    const auto y_of = [&](const std::string& name) {
      const auto text = svg.substr(svg.rfind("<text", svg.find(">" + name + "<")));
      return std::stod(text.substr(text.find(" y=\"") + 4));
    };
    EXPECT_GT(y_of("strike"), y_of("apart &amp; away"));
    EXPECT_EQ(y_of("the-end"), y_of("apart &amp; away"));
  }
}

TEST(Figures, OfNoRun) { expect_figures({}); }
TEST(Figures, OfRunsWithNothingInThem) { expect_figures({measure::RunRecord{}, measure::samples::quiet_run()}); }
TEST(Figures, OfALongRun) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1, 20000);
  run.duration_s = 1000.5;
  expect_figures({run});
}
TEST(Figures, OfRunsThatAreBroken) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  for (std::size_t i = 0; i < run.ghost_samples.size(); i += 3) {
    run.ghost_samples[i].ghost.position.x() = std::numeric_limits<double>::quiet_NaN();
    run.ghost_samples[i].truth.position.z() = std::numeric_limits<double>::infinity();
  }
  expect_figures({run});
}
TEST(Figures, OfASweepOverWords) {
  std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  for (measure::RunRecord& run : runs) run.params.erase("network.latency_ms");
  expect_figures(runs);
}
TEST(Figures, OfRunsWithoutAFirstObject) {
  std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  runs[1].objects.erase(runs[1].objects.begin());
  expect_figures(runs);
}

TEST(Pictures, AreEachDrawnOnceForFileAndPage) {
  const std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  const auto summary = measure::summarise(kInfo, runs);
  const Pictures pictures = draw_pictures(kInfo, runs, summary);
  EXPECT_EQ(pictures.overview, overview_figure(summary));
  EXPECT_EQ(pictures.pareto, pareto_figure(summary));
  ASSERT_EQ(pictures.runs.size(), runs.size());
  EXPECT_EQ(pictures.runs[4].run, run_figure(kInfo, runs[4], 5, figure_frame(runs, summary)));
}

TEST(Pictures, HaveNumberedFiles) {
  EXPECT_EQ(picture_file("run", 1), "run-001.svg");
  EXPECT_EQ(picture_file("timeline", 42), "timeline-042.svg");
  EXPECT_EQ(picture_file("run", 12345), "run-12345.svg");
}

}  // namespace peerd::report::pictures_test
