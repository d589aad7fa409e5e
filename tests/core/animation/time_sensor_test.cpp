#include "core/animation/time_sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace peerd::animation::time_sensor_test {

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Case {
  const char* name;
  TimeSensorFields fields;
  double t;
  bool has_run, active;
  double fraction, time_s, cycle_s;
};
class Sensor : public testing::TestWithParam<Case> {};
TEST_P(Sensor, IsWhatTheStandardSays) {
  const Case& c = GetParam();
  const TimeSensorState s = sensor_at(c.fields, 0.0, c.t);
  const auto o = output(s, c.t);
  ASSERT_EQ(o.has_value(), c.has_run);
  if (!c.has_run) return;
  EXPECT_EQ(o->is_active, c.active);
  EXPECT_EQ(o->fraction, c.fraction);
  EXPECT_EQ(o->time_s, c.time_s);
  EXPECT_EQ(o->cycle_time_s, c.cycle_s);
}
// cycleInterval, enabled, loop, startTime, stopTime
constexpr TimeSensorFields kLoop{4, true, true, 0, 0};
constexpr TimeSensorFields kOnce{4, true, false, 2, 0};
constexpr TimeSensorFields kUntil{4, true, true, 2, 9};
INSTANTIATE_TEST_SUITE_P(
    Clauses469And650, Sensor,
    testing::Values(
        Case{"DefaultsAreInactive", {}, 0.5, false, false, 0, 0, 0},
        Case{"NothingBeforeReading", kLoop, -1, false, false, 0, 0, 0},
        Case{"FractionIsZeroAtStartTime", kLoop, 0, true, true, 0, 0, 0},
        Case{"FractionProgresses", kLoop, 3, true, true, 0.75, 3, 0},
        Case{"FractionIsOneAtTheEndOfACycle", kLoop, 4, true, true, 1, 4, 4},
        Case{"AndSmallAfter", kLoop, 5, true, true, 0.25, 5, 4},
        Case{"FarAway", kLoop, 4e9 + 1, true, true, 0.25, 4e9 + 1, 4e9},
        Case{"ActiveWhenReadInItsMiddle", {4, true, true, -3, -3}, 0, true, true, 0.75, 0, -3},
        Case{"OverBeforeReading", {4, true, true, -9, -1}, 0, false, false, 0, 0, 0},
        Case{"WaitsForStartTime", kOnce, 1.5, false, false, 0, 0, 0},
        Case{"RunsOneCycle", kOnce, 5, true, true, 0.75, 5, 2},
        Case{"EndsWithFractionOne", kOnce, 6, true, false, 1, 6, 2},
        Case{"AndStaysThere", kOnce, 99, true, false, 1, 6, 2},
        Case{"LoopsUntilStopTime", kUntil, 8, true, true, 0.5, 8, 6},
        Case{"FinalEventAsEvaluatedAtStopTime", kUntil, 9, true, false, 0.75, 9, 6},
        Case{"AndStaysThereToo", kUntil, 20, true, false, 0.75, 9, 6},
        Case{"StopTimeAtTheEndOfACycle", {4, true, true, 2, 10}, 11, true, false, 1, 10, 6},
        Case{"StopTimeBeforeStartTimeIsIgnored", {4, true, true, 2, 1}, 8, true, true, 0.5, 8, 6},
        Case{"StopTimeWithinTheOnlyCycle", {4, true, false, 2, 3}, 8, true, false, 0.25, 3, 2},
        Case{"Disabled", {4, false, true, 0, 0}, 8, false, false, 0, 0, 0},
        Case{"NoCycleInterval", {0, true, true, 0, 0}, 0.25, true, true, 0.25, 0.25, 0},
        Case{"TinyCycleInterval", {1e-300, true, true, 0, 0}, 0x1.8p-10, true, true, 0.5, 0x1.8p-10, 0x1p-10},
        Case{"TooFarForItsCycles", {0.01, true, true, 0, 0}, 1e300, true, true, 1, 1e300, 1e300}),
    [](const auto& c) { return std::string(c.param.name); });

// 6.50: temp = (now - startTime) / cycleInterval; f = fractionalPart(temp)
TEST(Fraction, MeetsTheStandardsFormulaInLongDouble) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 200000; ++i) {
    const double interval = 0.01 + 10.0 * unit(random);
    const double start_s = 100.0 * unit(random) - 50.0;
    const double t = start_s + 1e6 * unit(random);
    const TimeSensorFields f{interval, true, true, start_s, start_s};
    const long double temp = (static_cast<long double>(t) - start_s) / interval;
    const long double truth = temp - std::floor(temp);
    double error = static_cast<double>(std::abs(fraction(f, t) - truth));
    error = std::min(error, 1.0 - error);  // at a cycle's end, 0 and 1 are neighbours
    const double ulp = std::nextafter(t, kNever) - t;
    ASSERT_LE(error, 2.0 * ulp / interval + 2e-16) << start_s << ' ' << interval << ' ' << t;
  }
}

TEST(Cycles, BeginAtOneNumberEach) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    const TimeSensorFields f{0.001 + 3.0 * unit(random), true, true, 1e5 * (unit(random) - 0.5), -1e9};
    const double t = f.start_time + 1e7 * unit(random);
    const double c = cycle_start(f, t);
    const double next = next_cycle_start(f, t);
    ASSERT_LE(c, t);
    ASSERT_GT(next, t);
    ASSERT_EQ(cycle_start(f, next), next);
    ASSERT_EQ(next_cycle_start(f, c), next);
    ASSERT_EQ(cycle_start(f, std::nextafter(next, -kNever)), c);
    ASSERT_EQ(fraction(f, next), 1.0);
  }
}

TEST(Transitions, AreStartAndStopOnly) {
  TimeSensorState s = read_sensor(kOnce, 0.0);
  EXPECT_EQ(next_transition(s, 0.0), 2.0);
  start(s, 2.0);
  EXPECT_EQ(next_transition(s, 2.0), 6.0);
  stop(s, 6.0, true);
  EXPECT_EQ(next_transition(s, 6.0), kNever);
  EXPECT_FALSE(starts(s, 7.0));  // its cycle is over
  EXPECT_EQ(next_transition(sensor_at(kLoop, 0.0, 3.0), 3.0), kNever);
}

TimeSensorState running(const TimeSensorFields& f) { return sensor_at(f, 0.0, 3.0); }

struct SetCase {
  const char* name;
  bool loop;
  SensorInput input;
  double value;
  SetResult result;
  double end_s;
};
class SetActive : public testing::TestWithParam<SetCase> {};
TEST_P(SetActive, AtThreeOfACycleFromTwoToSix) {
  const SetCase& c = GetParam();
  TimeSensorState s = running({4, true, c.loop, 2, 0});
  ASSERT_TRUE(s.active);
  EXPECT_EQ(set(s, c.input, c.value, 3.0), c.result);
  EXPECT_EQ(s.active, c.result != SetResult::kSetAndStopped);
  EXPECT_EQ(s.end_s, c.end_s);
}
INSTANTIATE_TEST_SUITE_P(
    Clause469, SetActive,
    testing::Values(SetCase{"StartTimeIsIgnored", true, SensorInput::kStartTime, 9, SetResult::kIgnored, kNever},
                    SetCase{"CycleIntervalIsIgnored", false, SensorInput::kCycleInterval, 9, SetResult::kIgnored, 6},
                    SetCase{"StopTimeAtStartTimeIsIgnored", true, SensorInput::kStopTime, 2, SetResult::kIgnored,
                            kNever},
                    SetCase{"StopTimeNowStops", true, SensorInput::kStopTime, 3, SetResult::kSetAndStopped, 3},
                    SetCase{"StopTimePastStopsNow", true, SensorInput::kStopTime, 2.5, SetResult::kSetAndStopped, 3},
                    SetCase{"StopTimeToCome", true, SensorInput::kStopTime, 8, SetResult::kSet, 8},
                    SetCase{"StopTimeAfterTheCycle", false, SensorInput::kStopTime, 8, SetResult::kSet, 6},
                    SetCase{"LoopFalseEndsTheCycle", true, SensorInput::kLoop, 0, SetResult::kSet, 6},
                    SetCase{"LoopTrueOverridesThat", false, SensorInput::kLoop, 1, SetResult::kSet, kNever},
                    SetCase{"EnabledFalseStops", true, SensorInput::kEnabled, 0, SetResult::kSetAndStopped, 3}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(SetInactive, TakesEverythingButNoInterval) {
  TimeSensorState s = read_sensor({}, 0.0);
  EXPECT_EQ(set(s, SensorInput::kCycleInterval, 0.0, 5.0), SetResult::kIgnored);
  EXPECT_EQ(set(s, SensorInput::kCycleInterval, 1e-300, 5.0), SetResult::kSet);
  EXPECT_EQ(s.fields.cycle_interval, kShortestCycle_s);
  EXPECT_EQ(set(s, SensorInput::kCycleInterval, 2.0, 5.0), SetResult::kSet);
  EXPECT_FALSE(starts(s, 5.0));
  EXPECT_EQ(set(s, SensorInput::kStartTime, 5.0, 5.0), SetResult::kSet);
  EXPECT_TRUE(starts(s, 5.0));
}

}  // namespace peerd::animation::time_sensor_test
