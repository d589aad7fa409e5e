#include "peerd/lab/measure/meter.hpp"

#include <gtest/gtest.h>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::meter_test {

using samples::kB, samples::kCar;

RunRecord metered(const RunRecord& rows, const RowLimits& limits, std::vector<TimeSpan> parts = {}) {
  RunMeter meter(rows.duration_s, 60.0, limits, std::move(parts));
  // Rows come in order of time, whichever peers they are of.
  std::vector<GhostSample> in_time = rows.ghost_samples;
  std::ranges::stable_sort(in_time, {}, &GhostSample::t_s);
  for (const GhostSample& s : in_time) meter.add(s);
  for (const UpdateSent& u : rows.updates) meter.add(u);
  for (const DatagramSent& d : rows.datagrams) meter.add(d);
  RunRecord record = samples::quiet_run(rows.duration_s);
  record.contacts = rows.contacts;
  record.counters = rows.counters;
  meter.finish(record, rows.duration_s);
  return record;
}

std::string summary_of(const RunRecord& run) { return summarise({"s", "sim", 1, {}}, {&run, 1}).dump(); }

TEST(RunMeter, MeasuresTheSameWhereFewRowsAreKept) {
  const RunRecord rows = samples::zigzag_run(0.3, 600);
  const RunRecord few = metered(rows, {.samples = 100, .updates = 2, .datagrams = 2});
  EXPECT_LE(few.ghost_samples.size(), 100u);
  EXPECT_LE(few.updates.size(), 4u);
  EXPECT_LE(few.datagrams.size(), 2u);
  EXPECT_EQ(summary_of(few), summary_of(rows));
}

TEST(RunMeter, MeasuresPartsBesideTheWhole) {
  const RunRecord rows = samples::zigzag_run(0.3, 600);
  const TimeSpan part{2.0, 7.5};
  const RunRecord few = metered(rows, {.samples = 100, .updates = 2, .datagrams = 2}, {part});
  const auto found = measured_of(few, part), expected = measured_of(rows, part);
  ASSERT_TRUE(found && expected);
  EXPECT_EQ(summarise_part(few, *found)["objects"].dump(), summarise_part(rows, *expected)["objects"].dump());
  EXPECT_EQ(found->datagrams, expected->datagrams);
  EXPECT_LT(found->samples(), measured_of(rows).samples());
  EXPECT_FALSE(measured_of(few, {1.0, 2.0})) << "nobody asked for that part, and its rows are not kept";
}

TEST(RunMeter, CountsSamplesWithoutANumber) {
  RunRecord rows = samples::quiet_run();
  rows.ghost_samples = {samples::ghost_sample(0, kB, kCar, {NAN, 0, 0}, {0, 0, 0}),
                        samples::ghost_sample(1, kB, kCar, {0, 0, 0}, {2, 0, 0}),
                        samples::ghost_sample(2, kB, kCar, {0, 0, 0}, {2, 0, 0})};
  const ViewMeasured view = *metered(rows, {}).measured->whole.view(kB, kCar);
  EXPECT_EQ(view.not_finite, 1u);
  EXPECT_EQ(view.ghost_error_m.count, 2u);
  EXPECT_DOUBLE_EQ(view.inconsistency_m_s, 2.0) << "from the first number on";
}

// An object stands until 10 s, and what moves it then is known to its receiver a moment before its owner knows it.
TEST(RunMeter, MeasuresWhatIsAtRestApart) {
  RunRecord rows = samples::quiet_run();
  RunMeter meter(rows.duration_s, 60.0, {}, {});
  for (double t_s = 0.0; t_s < 12.0; t_s += 0.25) {
    const double at_m = t_s < 10.0 ? 0.0 : t_s - 10.0, off_m = t_s < 1.5 ? 3.0 : t_s < 9.5 ? 0.01 : 2.0;
    meter.add(samples::ghost_sample(t_s, kB, kCar, {at_m, 0, 0}, {at_m + off_m, 0, 0}));
  }
  meter.finish(rows, rows.duration_s);
  const ViewMeasured view = *rows.measured->whole.view(kB, kCar);
  EXPECT_NEAR(view.rest_error_max_m, 0.01, 1e-12) << "neither the first 2 s nor the last one count";
  EXPECT_GE(view.rest_samples, 4u * 5u);
  EXPECT_LE(view.rest_samples, 4u * 7u);
}

TEST(RunMeter, TakesSamplesWhereSessionTimeStepsBack) {
  RunRecord rows = samples::quiet_run();
  RunMeter meter(rows.duration_s, 60.0, {}, {});
  for (const double t_s : {0.0, 2.0, 1.0, 2.0, 3.0})
    meter.add(samples::ghost_sample(t_s, kB, kCar, {0, 0, 0}, {2, 0, 0}));
  meter.finish(rows, rows.duration_s);
  const ViewMeasured view = *rows.measured->whole.view(kB, kCar);
  EXPECT_EQ(view.ghost_error_m.count, 5u);
  EXPECT_DOUBLE_EQ(view.inconsistency_m_s, 6.0) << "no time counts twice";
}

}  // namespace peerd::measure::meter_test
