#include "peerd/report/table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "peerd/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::table_test {

using samples::belief, samples::kCar;

const ScenarioInfo kInfo{"zigzag", "sim", 7, {}};

TEST(Table, ARowARunWithin100Columns) {
  const std::string text = table(summarise(kInfo, samples::zigzag_sweep()));
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 3u + 6u) << text;
  for (const std::string& line : lines) EXPECT_LE(line.size(), 100u);
  EXPECT_THAT(lines[0], testing::HasSubstr("CAR"));
  EXPECT_THAT(lines[1], testing::AllOf(testing::HasSubstr("at b"), testing::HasSubstr("at c")));
  EXPECT_THAT(lines[2], testing::AllOf(testing::HasSubstr("approach"), testing::HasSubstr("latency_ms")));
  EXPECT_THAT(lines[3], testing::HasSubstr("dr"));
  for (std::size_t i = 3; i < lines.size(); ++i) EXPECT_EQ(lines[i].size(), lines[2].size()) << text;  // aligned
}

TEST(Table, ManyObserversHaveARowEach) {
  RunRecord run = samples::zigzag_run(0.1);
  const PeerId d{4};
  run.peers.push_back({d, "d"});
  for (int i = 0; i < 3; ++i) run.ghost_samples.push_back(belief(i, d, kCar, {0, 0, 0}, {1, 0, 0}));
  const std::string text = table(summarise(kInfo, {&run, 1}));
  EXPECT_EQ(std::ranges::count(text, '\n'), 2 + 3) << text;
  EXPECT_THAT(text, testing::HasSubstr("observer"));
}

TEST(Table, AnUnseenObjectIsADashNotAZero) {
  RunRecord run = samples::quiet_run();
  EXPECT_THAT(table(summarise(kInfo, {&run, 1})), testing::HasSubstr(" - "));
}

TEST(Table, ThePrincipalObjectIsTheOneThatErrsMost) {
  const std::vector<RunRecord> runs = samples::zigzag_sweep();
  EXPECT_EQ(principal_object(summarise(kInfo, runs)), "CAR");
  EXPECT_EQ(principal_object(summarise(kInfo, {})), "");
}

}  // namespace peerd::report::table_test
