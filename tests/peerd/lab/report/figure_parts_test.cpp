#include "peerd/lab/report/figure_parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/peerd/report_samples.hpp"
#include "tests/peerd/well_formed.hpp"

namespace peerd::report::figure_parts_test {

using measure::samples::kA, measure::samples::kB, measure::samples::kC, measure::samples::kCar;
using testing::HasSubstr;

TEST(Shortened, KeepsTheEndAndWholeLetters) {
  EXPECT_EQ(shortened("CAR", 1000.0, 12.0), "CAR");
  const std::string path = "STREET/HOUSE/DÖÖÖÖÖÖÖÖÖR";
  for (double width = 20.0; width < 200.0; width += 3.0) {
    const std::string text = shortened(path, width, 12.0);
    EXPECT_TRUE(path.ends_with(text.starts_with("…") ? text.substr(std::string("…").size()) : text)) << text;
    EXPECT_FALSE(testing_support::malformed("<svg >" + text + "</svg>"));
  }
}

TEST(Legend, BreaksIntoLinesThatFit) {
  std::vector<LegendEntry> entries(7);
  for (LegendEntry& entry : entries) entry.label = "a ghost at some peer";
  EXPECT_EQ(legend_rows(entries, 1e6).size(), 1u);
  const auto rows = legend_rows(entries, 300.0);
  EXPECT_GT(rows.size(), 1u);
  std::size_t all = 0;
  for (const auto& row : rows) all += row.size();
  EXPECT_EQ(all, entries.size());
  EXPECT_EQ(legend_rows(entries, 1.0).size(), entries.size()) << "one a line, however narrow";
}

TEST(Legend, CountsWhatDoesNotFit) {
  std::vector<LegendEntry> entries(5);
  for (LegendEntry& entry : entries) entry.label = "a ghost at some peer";
  Svg svg(400, 20);
  draw_legend(svg, {0, 10}, 400.0, entries);
  EXPECT_THAT(std::move(svg).finish(), HasSubstr(">+ 3</text>"));
}

TEST(Observers, AreThosePeersThatHaveSamples) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  const measure::ObjectInfo* const car = find_object(run, "CAR");
  ASSERT_NE(car, nullptr);
  EXPECT_EQ(find_object(run, "VAN"), nullptr);
  EXPECT_EQ(observers_of(run, *car).size(), 2u);
  std::erase_if(run.ghost_samples, [](const measure::GhostSample& s) { return s.observer == kC; });
  const auto observers = observers_of(run, *car);
  ASSERT_EQ(observers.size(), 1u);
  EXPECT_EQ(observers.front().peer, kB);
}

TEST(Truth, IsTheUnionOfAllObserversSamples) {
  measure::RunRecord run = measure::samples::quiet_run();
  run.ghost_samples = {measure::samples::ghost_sample(0.0, kB, kCar, {0, 0, 0}, Vec3::Zero()),
                       measure::samples::ghost_sample(2.0, kB, kCar, {2, 0, 0}, Vec3::Zero()),
                       measure::samples::ghost_sample(1.0, kC, kCar, {1, 0, 0}, Vec3::Zero()),
                       measure::samples::ghost_sample(2.0, kC, kCar, {2, 0, 0}, Vec3::Zero())};
  const auto truth = truth_of(run, run.objects.front());
  ASSERT_EQ(truth.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(truth[i].position.x(), static_cast<double>(i));
  EXPECT_EQ(component_over_time(truth, 0)[1].y, 1.0);
}

TEST(ErrorSeries, ItsMeanLeavesOutWhatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  measure::RunRecord run = measure::samples::quiet_run();
  run.ghost_samples = {measure::samples::ghost_sample(0, kB, kCar, {0, 0, 0}, {1, 0, 0}),
                       measure::samples::ghost_sample(1, kB, kCar, {0, 0, 0}, {nan, 0, 0}),
                       measure::samples::ghost_sample(2, kB, kCar, {0, 0, 0}, {3, 0, 0})};
  const ErrorSeries series = error_series(run, kB, kCar, 0);
  EXPECT_EQ(series.mean_m, 2.0);
  EXPECT_EQ(series.error.size(), 3u) << "the curve breaks there";
}

TEST(ErrorSeries, ItsMeanIsThatOfAllSamplesAndNotOfThoseThatAreKept) {
  measure::RunRecord run = measure::samples::zigzag_run(0.3);
  const auto updates = updates_sent(run, kCar);
  measure::RunMeasured& measured = run.measured.emplace();
  measure::ViewMeasured& view = measured.whole.views.emplace_back();
  view.observer = kB;
  view.object = kCar;
  view.ghost_error_m.mean = 0.125;
  measured.whole.updates[kCar].updates = 77;
  EXPECT_EQ(error_series(run, kB, kCar, 0).mean_m, 0.125);
  EXPECT_EQ(updates, 5u);
  EXPECT_EQ(updates_sent(run, kCar), 77u);
}

}  // namespace peerd::report::figure_parts_test
