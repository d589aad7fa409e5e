#include "peerd/lab/measure/expectations.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/lab/measure/summary.hpp"
#include "peerd/peer/config/measures.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::expectations_test {

using Json = nlohmann::ordered_json;
using config::Expectation;
using testing::HasSubstr;

// The dotted names of all numbers and words of truth in `value`.
void collect(const Json& value, const std::string& name, std::vector<std::string>& names) {
  if (value.is_number() || value.is_boolean()) names.push_back(name);
  if (!value.is_object()) return;
  for (const auto& [key, below] : value.items()) collect(below, name.empty() ? key : name + "." + key, names);
}

TEST(Measures, AreAllThatASummaryHas) {
  RunRecord run = samples::zigzag_run(0.1);
  run.wrong = WrongOutcomes{};
  run.interest = InterestRecord{};
  run.shown_delay = ShownDelay{};
  run.contacts_measured = ContactsMeasured{.energy_samples = 1, .bodies = 1};
  for (const char* late : {"updates_late", "updates_missing", "decisions_late"}) run.counters[late] = 0;
  const Json row = summarise({}, {&run, 1})["runs"][0];
  std::vector<std::string> names;
  collect(row["objects"][0], "", names);
  Json of_run = row;
  for (const char* key : {"params", "objects", "counters", "seed"}) of_run.erase(key);
  collect(of_run, "", names);
  std::vector<std::string> known;
  for (const config::Measure& m : config::measures()) known.emplace_back(m.name);
  EXPECT_THAT(names, testing::UnorderedElementsAreArray(known));
  EXPECT_TRUE(config::find_measure("counters.drops"));
  EXPECT_FALSE(config::find_measure("counters."));
}

class ExpectationsReport : public testing::Test {
 protected:
  ExpectationsReport() {
    for (const double lag_s : {0.1, 0.4}) runs.push_back(samples::zigzag_run(lag_s));
    runs[0].params = {{"network.latency_ms", 100}};
    runs[1].params = {{"network.latency_ms", 400}};
    rows = summarise({}, runs)["runs"];
  }
  static Expectation that(const std::string& measure) { return {.name = "mine", .that = measure, .runs = {0, 1}}; }
  CheckedExpectation check(const Expectation& e) { return check_expectations({&e, 1}, "sim", runs, rows).front(); }
  [[nodiscard]] double mean_m(std::size_t run, std::size_t row) const {
    return rows[run]["objects"][row]["ghost_error_m"]["mean"].get<double>();
  }

  std::vector<RunRecord> runs;
  Json rows;
};

TEST_F(ExpectationsReport, ALimitHoldsForEachViewOfEachRun) {
  Expectation e = that("ghost_error_m.mean");
  e.at_most = 1e9;
  EXPECT_FALSE(check(e).failed());
  EXPECT_EQ(check(e).values, 2u * 4);
  e.at_most = 0.5 * (mean_m(0, 0) + mean_m(1, 0));  // the car of the second run, at b and at c, is beyond
  const auto checked = check(e);
  ASSERT_EQ(checked.failures.size(), 2u);
  EXPECT_EQ(checked.failures[0].run, 1u);
  EXPECT_EQ(checked.failures[0].object, "CAR");
  EXPECT_EQ(checked.failures[0].found, mean_m(1, 0));
  e.observer = "a";  // owner of the car
  EXPECT_FALSE(check(e).failed());
  EXPECT_EQ(check(e).values, 2u);
  e.observer = "";
  e.runs = {0};
  EXPECT_FALSE(check(e).failed());
}

TEST_F(ExpectationsReport, AtLeastAndEquals) {
  Expectation e = that("updates_sent");
  e.object = "C?R";
  e.equals = 5;
  EXPECT_FALSE(check(e).failed());
  e.equals = 4;
  EXPECT_EQ(check(e).failures.size(), 4u);
  e.equals.reset();
  e.at_least = 6;
  EXPECT_EQ(check(e).failures.size(), 4u);
  e.object = "";  // the cube has sent one: the worst comes first
  EXPECT_EQ(check(e).failures.front().object, "CUBE");
}

TEST_F(ExpectationsReport, WordsOfTruth) {
  Expectation e = that("state_roots_equal");
  e.equals = true;
  EXPECT_FALSE(check(e).failed());
  runs[1].worlds_equal = false;
  rows = summarise({}, runs)["runs"];
  EXPECT_EQ(check(e).failures.size(), 1u);
}

// A number that nobody has seen is not as expected.
TEST_F(ExpectationsReport, WhatIsNotThereFails) {
  Expectation e = that("ghost_error_m.max");
  e.at_most = 1e9;
  e.object = "TRAIN";
  EXPECT_THAT(check(e).failures.at(0).why, HasSubstr("no such view"));
  e.object = "CAR";
  std::erase_if(runs[0].ghost_samples, [](const GhostSample& s) { return s.object == samples::kCar; });
  rows = summarise({}, runs)["runs"];
  ASSERT_EQ(check(e).failures.size(), 1u);
  EXPECT_EQ(check(e).failures[0].why, "no samples");
  Expectation counter = that("counters.nosuch");
  counter.equals = 0;
  EXPECT_EQ(check(counter).failures.at(0).why, "the run has no such number");
  counter.that = "counters.drops";
  counter.equals = 3;
  EXPECT_FALSE(check(counter).failed());
}

TEST_F(ExpectationsReport, APartOfARunIsCountedByItself) {
  Expectation e = that("updates_sent");
  e.object = "CAR";  // tells at 0, 2, 4, 6 and 8 s
  e.from_s = 1;
  e.equals = 4;
  EXPECT_FALSE(check(e).failed());
  e.until_s = 5;
  e.equals = 2;
  EXPECT_FALSE(check(e).failed());
  e.equals = 3;
  EXPECT_TRUE(check(e).failed());
  Expectation rate = that("traffic.bytes_per_s");
  rate.from_s = 1;
  rate.until_s = 5;
  rate.equals = 2 * 98 / 4.0;
  EXPECT_FALSE(check(rate).failed());
}

TEST_F(ExpectationsReport, WhatIsAboutNoRunIsNeitherHeldNorFailed) {
  Expectation e = that("updates_sent");
  e.equals = 1;
  e.runs = {};
  EXPECT_FALSE(check(e).checked());
  e.runs = {0};
  e.mode = "real";
  EXPECT_FALSE(check(e).checked());
  EXPECT_TRUE(expectations_json(std::vector{check(e)})[0]["held"].is_null());
  EXPECT_THAT(expectations_table(std::vector{check(e)}, rows), HasSubstr("expect.mine was not checked"));
}

TEST_F(ExpectationsReport, WhatNeverRestsIsNotCheckedAtRest) {
  Expectation e = that("rest.ghost_error_max_m");
  e.at_most = 1e-6;
  for (Json& run : rows) {
    for (Json& view : run["objects"]) view["rest"] = {{"samples", 0}, {"ghost_error_max_m", 0.0}};
  }
  EXPECT_FALSE(check(e).checked());
  EXPECT_THAT(expectations_table(std::vector{check(e)}, rows), HasSubstr("or nothing came to rest"));
  rows[1]["objects"][0]["rest"] = {{"samples", 3}, {"ghost_error_max_m", 0.5}};
  const CheckedExpectation checked = check(e);
  EXPECT_EQ(checked.values, 1u);
  ASSERT_EQ(checked.failures.size(), 1u);
  EXPECT_EQ(checked.failures[0].found, Json(0.5));
}

TEST_F(ExpectationsReport, IsWrittenDown) {
  Expectation e = that("ghost_error_m.mean");
  e.at_most = 0.25;
  e.object = "CAR";
  e.where = {{"network.latency_ms", {100, 400}}};
  const std::vector checked{check(e)};
  const Json json = expectations_json(checked)[0];
  EXPECT_EQ(json["name"], "mine");
  EXPECT_EQ(json["held"], false);
  EXPECT_EQ(json["values"], 4);
  EXPECT_EQ(json["failures"][0]["run"], 2);
  EXPECT_EQ(json["failures"][0]["found"], mean_m(1, 0));
  const std::string table = expectations_table(checked, rows);
  EXPECT_THAT(table, HasSubstr("expectations: 0 held, 1 failed (4 values)"));
  EXPECT_THAT(table, HasSubstr("ghost_error_m.mean <= 0.25 of CAR"));
  EXPECT_THAT(table, HasSubstr("latency 400 ms"));
  EXPECT_EQ(expectations_table({}, rows), "");
}

}  // namespace peerd::measure::expectations_test
