#include "peerd/lab/measure/points.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "peerd/lab/measure/statistics/interval.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/table.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::points_test {

TEST(Points, AreRunsThatDifferInTheirSeedAlone) {
  std::vector<RunRecord> runs;
  for (const int latency_ms : {5, 100}) {
    for (std::uint64_t seed = 7; seed < 10; ++seed) {
      runs.push_back(samples::zigzag_run(1e-3 * latency_ms * static_cast<double>(seed)));
      runs.back().seed = seed;
      runs.back().params = {{"network.latency_ms", latency_ms}};
    }
  }
  ScenarioInfo info{"zigzag", "sim", 7, {}};
  info.repeat = 3;
  const auto summary = summarise(info, runs);
  EXPECT_EQ(summary["runs"][4]["seed"], 8);
  ASSERT_EQ(summary["points"].size(), 2u);
  const auto& point = summary["points"][1];
  EXPECT_EQ(point["params"]["network.latency_ms"], 100);
  EXPECT_EQ(point["runs"], (std::vector{4, 5, 6}));
  std::vector<double> means;
  for (std::size_t i = 3; i < 6; ++i) means.push_back(summary["runs"][i]["objects"][0]["ghost_error_m"]["mean"]);
  const Interval expected = interval_95(means);
  EXPECT_GT(expected.half_width, 0.0);
  EXPECT_EQ(point["objects"][0]["path"], "CAR");
  EXPECT_EQ(point["objects"][0]["ghost_error_m"]["mean"]["mean"], expected.mean);
  EXPECT_EQ(point["objects"][0]["ghost_error_m"]["mean"]["half_width_95"], expected.half_width);
  EXPECT_EQ(point["traffic"]["packets"]["mean"], 5);
  EXPECT_EQ(point["traffic"]["packets"]["half_width_95"], 0);
  EXPECT_NE(report::table(summary).find("4-6"), std::string::npos);
  EXPECT_NE(report::table(summary).find(" ± "), std::string::npos);
}

// A view of nothing has an error of 0 in summary.json, which has no NaN; a mean over seeds must not take it for one.
TEST(Points, LeaveOutWhatWasNotSeen) {
  std::vector<RunRecord> runs{samples::zigzag_run(0.1), samples::zigzag_run(0.1)};
  std::erase_if(runs[1].ghost_samples, [](const GhostSample& s) { return s.object == samples::kCar; });
  ScenarioInfo info{"zigzag", "sim", 7, {}};
  info.repeat = 2;
  const auto summary = summarise(info, runs);
  EXPECT_EQ(summary["points"][0]["objects"][0]["ghost_error_m"]["mean"]["mean"],
            summary["runs"][0]["objects"][0]["ghost_error_m"]["mean"]);
}

}  // namespace peerd::measure::points_test
