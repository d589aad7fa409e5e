#include "peerd/lab/report/figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::plan_figure_test {

using measure::samples::kB, measure::samples::kC, measure::samples::kCar;
using testing::HasSubstr;

const measure::ScenarioInfo kInfo{"zigzag", "sim", 7, {}};
const double kNan = std::numeric_limits<double>::quiet_NaN();

Json plan_of(const measure::RunRecord& run) {
  return plan_figure(kInfo, {&run, 1}, measure::summarise(kInfo, {&run, 1}));
}

// The last series of a name; null if there is none.
Json series_of(const Json& figure, const std::string& name) {
  Json found;
  for (const Json& series : figure.at("series")) {
    if (series.at("name") == name) found = series;
  }
  return found;
}

// Many objects of b go along x, side by side.
measure::RunRecord crowd(std::uint32_t objects, int ticks) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1, 20);
  std::vector<measure::GhostSample> of_c;
  for (std::uint32_t i = 0; i < objects; ++i) {
    const ObjectId object{100 + i};
    run.objects.push_back({object, "O" + std::to_string(i), kB});
    for (int k = 0; k < ticks; ++k) {
      const Vec3 at(0.2 * k, 0.0, -30.0 * i / objects + 0.3 * std::sin(1.3 * k));
      of_c.push_back(measure::samples::ghost_sample(0.1 * k, kC, object, at, at));
    }
  }
  run.ghost_samples.insert(run.ghost_samples.end(), of_c.begin(), of_c.end());
  return run;
}

TEST(PlanFigure, IsBoundedAndSaysWhatItLeavesOut) {
  const Json few = plan_of(crowd(150, 400));
  EXPECT_LT(few.dump().size(), 400'000u);
  EXPECT_THAT(few.at("notes").dump(), HasSubstr("paths drawn to "));
  EXPECT_EQ(series_of(few, "of b").at("legend"), "of b: 150 moving, 1 standing");
  EXPECT_EQ(series_of(few, "other objects at the start").at("x").dump(), "[8.0]");
  const Json many = plan_of(crowd(4'100, 3));
  EXPECT_LT(many.dump().size(), 400'000u);
  EXPECT_THAT(many.at("notes").dump(), HasSubstr("of 4100 other objects that move, the 4000 that go farthest"));
}

TEST(PlanFigure, HasOutlinesAndSaysWhatIsUnseen) {
  measure::RunRecord run = crowd(3, 30);
  for (measure::GhostSample& s : run.ghost_samples) {
    if (s.object == ObjectId{101}) s.truth.position.x() = kNan;
    if (s.object == ObjectId{102}) s.truth.position.z() = 1e300;
  }
  run.outlines = {{.owned = {}, .corners = {{3, -30}, {4, 0}, {3, 0}}, .bottom_m = 1, .top_m = 2},
                  {.owned = {}, .corners = {{-9, -9}, {9, 9}, {0, 9}}, .bottom_m = -1, .top_m = 0},
                  {.owned = measure::samples::kCube, .corners = {{7, 0}, {9, 0}, {8, 1}}, .bottom_m = 0, .top_m = 1}};
  run.outlines_left_out = 12;
  const Json figure = plan_of(run);
  EXPECT_EQ(series_of(figure, "what stands").at("polygons").dump(), "[[3.0,-30.0,4.0,0.0,3.0,0.0]]");
  EXPECT_EQ(series_of(figure, "below all paths").at("polygons").size(), 1u);
  EXPECT_TRUE(series_of(figure, "other objects at the start").is_null()) << "the cube has an outline";
  EXPECT_EQ(figure.at("notes").dump(), R"(["12 shapes of the scene, farthest from the objects, not drawn",)"
                                       R"("2 objects unseen by all other peers, not drawn"])");
}

TEST(PlanFigure, APathIsInterruptedWhereNobodyHadASample) {
  measure::RunRecord run = measure::samples::quiet_run();
  for (int i = 0; i < 100; ++i) {
    if (i >= 40 && i < 60) continue;  // two seconds
    run.ghost_samples.push_back(measure::samples::ghost_sample(0.1 * i, kC, kCar, {1.0 * i, 0, 0}, {1.0 * i, 0, 1}));
  }
  EXPECT_EQ(series_of(plan_of(run), "ghost at c").at("x").dump(), "[0.0,39.0,null,60.0,99.0]");
}

}  // namespace peerd::report::plan_figure_test
