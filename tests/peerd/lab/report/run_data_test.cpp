#include "peerd/lab/report/figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::run_data_test {

using measure::samples::kA, measure::samples::kB, measure::samples::kCar;

const measure::ScenarioInfo kInfo{"zigzag", "sim", 7, {}};
const double kNan = std::numeric_limits<double>::quiet_NaN();

Figures figures_of(const std::vector<measure::RunRecord>& runs) {
  return make_figures(kInfo, runs, measure::summarise(kInfo, runs));
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
  measure::ViewMeasured& view =
      measured.whole.views.emplace_back(measure::ViewMeasured{.observer = kB, .object = kCar});
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

}  // namespace peerd::report::run_data_test
