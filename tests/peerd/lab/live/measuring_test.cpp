#include "peerd/lab/live/measuring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd::measuring_test {

TEST(ReadSamples, TakesAllNoneAndNumbers) {
  EXPECT_EQ(read_samples("all").value(), std::nullopt);
  EXPECT_EQ(read_samples("none").value(), 0u);
  EXPECT_EQ(read_samples("123").value(), 123u);
  for (const char* wrong : {"", "-1", "1e3", "12x", "some"}) {
    ASSERT_FALSE(read_samples(wrong)) << wrong;
    EXPECT_EQ(read_samples(wrong).error().exit_code, 2);
    EXPECT_THAT(read_samples(wrong).error().text, testing::HasSubstr("--samples"));
  }
}

TEST(MeasuringOf, SharesTheRowsAmongTheRuns) {
  config::Scenario scenario;
  scenario.runs.resize(4);
  const measure::RowLimits all;
  EXPECT_EQ(measuring_of(scenario, 0, 1000).limits.samples, all.samples / 4);
  EXPECT_EQ(measuring_of(scenario, 0, 8 * all.samples).limits.samples, 2 * all.samples) << "what the file is to have";
  EXPECT_GT(measuring_of(scenario, 0, std::nullopt).limits.samples, 1u << 30);
}

TEST(MeasuringOf, MeasuresThePartsThatAreExpectedOfThatRun) {
  config::Scenario scenario;
  scenario.runs.resize(2);
  for (config::RunSettings& run : scenario.runs) run.duration_s = 20.0;
  const config::Expectation from_8{.name = "later", .that = "updates_sent", .from_s = 8.0, .runs = {1}};
  scenario.expectations = {from_8, from_8};
  EXPECT_TRUE(measuring_of(scenario, 0, 1).parts.empty());
  const auto part = only(measuring_of(scenario, 1, 1).parts);
  EXPECT_EQ(part.from_s, 8.0);
  EXPECT_EQ(part.until_s, 20.0);
}

}  // namespace peerd::measuring_test
