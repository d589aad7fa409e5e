#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/figures.hpp"
#include "tests/peerd/report_samples.hpp"
#include "tests/peerd/well_formed.hpp"

namespace peerd::report::plan_figure_test {

using testing::HasSubstr;

const measure::ScenarioInfo kInfo{"zigzag", "sim", 7, {}};

TEST(PlanFigure, DrawsTheRunThatErrsMost) {
  const std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  const std::string svg = plan_figure(kInfo, runs, measure::summarise(kInfo, runs));
  EXPECT_FALSE(testing_support::malformed(svg));
  EXPECT_THAT(svg, HasSubstr("latency 500 ms"));
  EXPECT_THAT(svg, HasSubstr(">ghost at b</text>"));
  EXPECT_THAT(svg, HasSubstr(">other objects at the start</text>"));
}

TEST(PlanFigure, SaysWhereThereIsNothingToDraw) {
  const std::vector<measure::RunRecord> runs{measure::samples::quiet_run()};
  EXPECT_THAT(plan_figure(kInfo, runs, measure::summarise(kInfo, runs)),
              HasSubstr("no object that another peer observes"));
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++count;
  return count;
}

std::string plan_of(const measure::RunRecord& run) {
  return plan_figure(kInfo, {&run, 1}, measure::summarise(kInfo, {&run, 1}));
}

measure::SceneOutline rectangle(double x_lo, double z_lo, double x_hi, double z_hi, double top_m) {
  return {.owned = {},
          .corners = {{x_lo, z_lo}, {x_hi, z_lo}, {x_hi, z_hi}, {x_lo, z_hi}},
          .bottom_m = top_m - 1,
          .top_m = top_m};
}

// Many objects of b go along x, side by side.
measure::RunRecord crowd(std::uint32_t objects, int ticks) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1, 20);
  std::vector<measure::GhostSample> of_c;
  for (std::uint32_t i = 0; i < objects; ++i) {
    const ObjectId object{100 + i};
    run.objects.push_back({object, "O" + std::to_string(i), measure::samples::kB});
    for (int k = 0; k < ticks; ++k) {
      const Vec3 at(0.2 * k, 0.0, -30.0 * i / objects + 0.3 * std::sin(1.3 * k));
      of_c.push_back(measure::samples::ghost_sample(0.1 * k, measure::samples::kC, object, at, at));
    }
  }
  run.ghost_samples.insert(run.ghost_samples.end(), of_c.begin(), of_c.end());
  return run;
}

TEST(PlanFigure, DrawsThePathOfEveryObjectByOwner) {
  const std::string svg = plan_of(crowd(7, 30));
  EXPECT_FALSE(testing_support::malformed(svg));
  const std::size_t path = svg.find("<path fill=\"none\"");
  ASSERT_NE(path, std::string::npos);
  EXPECT_EQ(count_of(svg.substr(path, svg.find("/>", path) - path), "M"), 7u);
  EXPECT_THAT(svg, HasSubstr(">of b: 7 moving, 1 standing</text>"));
  EXPECT_THAT(svg, HasSubstr(">truth of CAR</text>"));
}

TEST(PlanFigure, IsBoundedAndSaysWhatItLeavesOut) {
  const std::string few = plan_of(crowd(150, 400));
  EXPECT_LT(few.size(), 400'000u);
  EXPECT_THAT(few, HasSubstr("paths drawn to "));
  const std::string many = plan_of(crowd(4'100, 3));
  EXPECT_LT(many.size(), 400'000u);
  EXPECT_THAT(many, HasSubstr("of 4100 other objects that move, the 4000 that go farthest"));
}

TEST(PlanFigure, DrawsWhatStands) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  run.outlines = {rectangle(3, -30, 4, 0, 2.0), rectangle(-900, -900, 900, 900, 0.0),
                  rectangle(7.5, -0.5, 8.5, 0.5, 0.5)};
  run.outlines[2].owned = measure::samples::kCube;
  run.outlines_left_out = 12;
  const std::string svg = plan_of(run);
  EXPECT_FALSE(testing_support::malformed(svg));
  EXPECT_THAT(svg, HasSubstr(">what stands</text>"));
  EXPECT_THAT(svg, HasSubstr(">below all paths</text>"));
  EXPECT_THAT(svg, HasSubstr(">of b: 1 standing</text>"));
  EXPECT_THAT(svg, HasSubstr("12 shapes of the scene, farthest from the objects, not drawn"));
  EXPECT_THAT(svg, testing::Not(HasSubstr("other objects at the start"))) << "the cube has an outline";
  // Three shapes, and a sample of each in the legend: the floor as far as the picture goes.
  EXPECT_EQ(count_of(svg, "<polygon"), 6u);
}

TEST(PlanFigure, SaysWhatIsOutside) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  for (measure::GhostSample& s : run.ghost_samples) {
    if (s.object == measure::samples::kCube) s.truth.position.x() = s.ghost.position.x() = 800.0;
  }
  EXPECT_THAT(plan_of(run), HasSubstr("1 object stands outside of the picture"));
}

TEST(PlanFigure, SaysWhereItIsTurned) {
  const std::string road = plan_of(measure::samples::zigzag_run(0.1));  // 30 m along -z, 2 m along x; the cube at x = 8
  EXPECT_THAT(road, HasSubstr("turned by 90 degrees: −z points right"));
  EXPECT_THAT(road, HasSubstr(">−z [m]</text>"));
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  for (measure::GhostSample& s : run.ghost_samples) {
    std::swap(s.truth.position.x(), s.truth.position.z());
    std::swap(s.ghost.position.x(), s.ghost.position.z());
  }
  const std::string street = plan_of(run);
  EXPECT_THAT(street, testing::Not(HasSubstr("turned by")));
  EXPECT_THAT(street, HasSubstr(">x [m]</text>"));
}

TEST(PlanFigure, PathsThatAreNoNumbersAreLeftOut) {
  measure::RunRecord run = crowd(3, 30);
  for (measure::GhostSample& s : run.ghost_samples) {
    if (s.object == ObjectId{101}) s.truth.position.x() = std::nan("");
    if (s.object == ObjectId{102}) s.truth.position.z() = 1e300;
    if (s.object == measure::samples::kCar && s.t_s > 3.0 && s.t_s < 4.0)
      s.ghost.position.x() = s.observer == measure::samples::kB ? 1e300 : std::nan("");
    if (s.object == measure::samples::kCube) s.truth.position.x() = 1e99;
  }
  const std::string svg = plan_of(run);
  EXPECT_FALSE(testing_support::malformed(svg));
  EXPECT_THAT(svg, HasSubstr("2 objects unseen by all other peers, not drawn"));
}

}  // namespace peerd::report::plan_figure_test
