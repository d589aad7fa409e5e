#include "peerd/lab/report/figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::figures_test {

using measure::samples::kA, measure::samples::kB, measure::samples::kC, measure::samples::kCar;
using testing::HasSubstr;

const measure::ScenarioInfo kInfo{"zigzag", "sim", 7, {}};
const double kNan = std::numeric_limits<double>::quiet_NaN();

Figures figures_of(const std::vector<measure::RunRecord>& runs) {
  return make_figures(kInfo, runs, measure::summarise(kInfo, runs));
}

// The last series of a name; null if there is none.
Json series_of(const Json& figure, const std::string& name) {
  Json found;
  for (const Json& series : figure.at("series")) {
    if (series.at("name") == name) found = series;
  }
  return found;
}

TEST(FigureChoice, IsTheCoordinateThatTurnsOrElseTheOneThatMoves) {
  const std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  const FigureChoice choice = figure_choice(runs, measure::summarise(kInfo, runs));
  EXPECT_EQ(choice.object, "CAR");
  EXPECT_EQ(choice.component, 0);  // z has the greater range, but no turn
  measure::RunRecord run = measure::samples::quiet_run();
  for (int i = 0; i < 50; ++i) {
    run.ghost_samples.push_back(measure::samples::ghost_sample(0.1 * i, kB, kCar, {0.01 * i, 0, -0.03 * i}, {1, 0, 0}));
  }
  EXPECT_EQ(figure_choice({&run, 1}, measure::summarise(kInfo, {&run, 1})).component, 2);
}

TEST(RunData, HasTheValuesOfTheRecord) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1, 10);
  run.events = {{2.0, "apart"}};
  const Json data = figures_of({run}).runs.at(0);
  EXPECT_EQ(data.at("object"), "CAR");
  EXPECT_EQ(data.at("component"), "x");
  EXPECT_EQ(data.at("truth").at("x").dump(), "[0.0,1.0,2.0,3.0,4.0,5.0,6.0,7.0,8.0,9.0]");
  EXPECT_EQ(data.at("truth").at("y").dump(), "[2.0,1.0,0.0,1.0,2.0,1.0,0.0,1.0,2.0,1.0]");
  // The ghost is 0.1 s behind: 0.1 m in x and 0.3 m in z.
  ASSERT_EQ(data.at("observers").size(), 2u);
  EXPECT_EQ(data.at("observers").at(0).at("error").at("y").at(1), 0.31623);
  EXPECT_EQ(data.at("updates").dump(), R"({"count":5,"at":[0.0,2.0,4.0,6.0,8.0],"threshold_m":[0.5,0.5,0.5,0.5,0.5]})");
  EXPECT_EQ(data.at("output").at(0).dump(),
            R"({"name":"a","kB_s":[0.098,0.0,0.098,0.0,0.098,0.0,0.098,0.0,0.098,0.0]})");
  EXPECT_EQ(data.at("contacts").dump(),
            R"({"at":[2.0,2.1],"known":[2.01,2.15],"peer":[0,1],"kind":[0,2],"own":[1,1],"counts":[1,0,1,0,0]})");
  EXPECT_EQ(data.at("events").dump(), R"([{"at":2.0,"name":"apart"}])");
}

TEST(RunData, ItsMeanIsThatOfAllSamplesAndLeavesOutWhatIsNoNumber) {
  measure::RunRecord run = measure::samples::quiet_run();
  for (const double x : {1.0, kNan, 3.0}) {
    run.ghost_samples.push_back(
        measure::samples::ghost_sample(run.ghost_samples.size() / 5.0, kB, kCar, {0, 0, 0}, {x, 0, 0}));
  }
  Json data = figures_of({run}).runs.at(0);
  EXPECT_EQ(data.at("observers").at(0).at("mean_m"), 2.0);
  EXPECT_EQ(data.at("observers").at(0).at("error").at("y").dump(), "[1.0,null,3.0]");
  measure::RunMeasured& measured = run.measured.emplace();
  measure::ViewMeasured& view = measured.whole.views.emplace_back();
  view.observer = kB;
  view.object = kCar;
  view.ghost_error_m.mean = 0.125;
  measured.whole.updates[kCar].updates = 77;
  data = run_data(kInfo, run, 1, {.object = "CAR"});
  EXPECT_EQ(data.at("observers").at(0).at("mean_m"), 0.125);
  EXPECT_EQ(data.at("updates").at("count"), 77u);
}

TEST(RunData, CountsTheContactsThatItLeavesOut) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  run.contacts.clear();
  for (int i = 0; i < 4000; ++i) {
    const double t_s = 0.0025 * i;
    run.contacts.push_back({t_s, kB, "owner", measure::samples::kCube, measure::samples::kWall, Vec3::UnitX(), t_s});
  }
  const Json contacts = figures_of({run}).runs.at(0).at("contacts");
  EXPECT_EQ(contacts.at("counts").at(0), 4000u);
  EXPECT_EQ(contacts.at("at").size(), 3000u);
}

TEST(OutputRates, AreKilobytesASecondOfOnePeer) {
  measure::RunRecord run = measure::samples::quiet_run(2.5);
  run.datagrams = {{0.1, kA, 500}, {0.9, kA, 500}, {1.5, kB, 9000}, {2.4, kA, 100}};
  EXPECT_THAT(output_rates(run, kA), testing::ElementsAre(1.0, 0.0, testing::DoubleEq(0.2)))
      << "half a second at the end is divided by half a second";
  EXPECT_EQ(output_bin_s(120.0), 1.0);
  EXPECT_EQ(output_bin_s(1000.0), 10.0);
  EXPECT_TRUE(output_rates(measure::samples::quiet_run(0.0), kA).empty());
}

TEST(OverviewFigure, HasALineForEachValueOfTheOtherKey) {
  const Json figure = figures_of(measure::samples::zigzag_sweep()).overview;
  EXPECT_EQ(figure.at("axis"), "latency [ms]") << "the numeric key is the x axis";
  ASSERT_EQ(figure.at("points").size(), 6u);
  Json point = figure.at("points").at(4);
  EXPECT_NEAR(point.at("error_m").get<double>(), 0.31, 0.01);
  point.erase("error_m");
  EXPECT_EQ(point.dump(), R"({"label":"dr+rcp","whole":"dr+rcp, latency 100 ms","x":100,"colour":"dr+rcp","dash":"[]",)"
                          R"("updates":5.0})");
}

TEST(OverviewFigure, RepeatedRunsAreTheirMean) {
  measure::ScenarioInfo twice = kInfo;
  twice.repeat = 2;
  std::vector<measure::RunRecord> runs;
  for (const measure::RunRecord& run : measure::samples::zigzag_sweep()) runs.insert(runs.end(), 2, run);
  EXPECT_EQ(overview_figure(measure::summarise(twice, runs)).at("points"),
            figures_of(measure::samples::zigzag_sweep()).overview.at("points"));
}

TEST(MultiplesFigure, NumbersItsCellsRowByRowAndHasAThirdKeyInColours) {
  std::vector<measure::RunRecord> runs;
  for (const int order : {1, 2}) {
    for (measure::RunRecord run : measure::samples::zigzag_sweep()) {
      run.params["replication.order"] = order;
      runs.push_back(std::move(run));
    }
  }
  const Json figure = figures_of(runs).multiples;
  EXPECT_EQ(figure.at("columns"), 3u);
  ASSERT_EQ(figure.at("cells").size(), 6u);
  EXPECT_EQ(
      figure.at("cells").at(4).dump(),
      R"({"heading":"5  dr+rcp, latency 100 ms","runs":[{"number":5,"words":"order 1"},{"number":11,"words":"order 2"}]})");
}

TEST(MultiplesFigure, IsNotDrawnWhereTooMuchWouldBeLeftOut) {
  std::vector<measure::RunRecord> runs;
  for (int latency_ms = 1; latency_ms <= 8; ++latency_ms) {  // columns: at most seven
    runs.push_back(measure::samples::zigzag_run(0.1, 10));
    runs.back().params = {{"network.latency_ms", latency_ms}};
  }
  EXPECT_TRUE(figures_of(runs).multiples.is_null());
  runs.pop_back();
  EXPECT_FALSE(figures_of(runs).multiples.is_null());
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
  const Json few = figures_of({crowd(150, 400)}).plan;
  EXPECT_LT(few.dump().size(), 400'000u);
  EXPECT_THAT(few.at("notes").dump(), HasSubstr("paths drawn to "));
  EXPECT_EQ(series_of(few, "of b").at("legend"), "of b: 150 moving, 1 standing");
  EXPECT_EQ(series_of(few, "other objects at the start").at("x").dump(), "[8.0]");
  const Json many = figures_of({crowd(4'100, 3)}).plan;
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
  const Json figure = figures_of({run}).plan;
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
  const Json x = series_of(figures_of({run}).plan, "ghost at c").at("x");
  ASSERT_EQ(x.size(), 81u);
  EXPECT_TRUE(x[40].is_null());
  EXPECT_EQ(x[41], 60.0);
}

TEST(Figures, OfNoRunsOfEmptyAndOfBrokenOnes) {
  measure::RunRecord broken = measure::samples::zigzag_run(0.1);
  for (std::size_t i = 0; i < broken.ghost_samples.size(); i += 3) {
    broken.ghost_samples[i].ghost.position.x() = kNan;
    broken.ghost_samples[i].truth.position.z() = std::numeric_limits<double>::infinity();
  }
  for (const std::vector<measure::RunRecord>& runs :
       {std::vector<measure::RunRecord>{}, {measure::RunRecord{}, measure::samples::quiet_run()}, {broken}}) {
    EXPECT_EQ(figures_of(runs).runs.size(), runs.size());
  }
  EXPECT_THAT(figures_of({broken}).runs.at(0).at("truth").at("x"),
              testing::Each(testing::Truly([](const Json& x) { return x.is_number(); })));
}

}  // namespace peerd::report::figures_test
