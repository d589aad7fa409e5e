#include "peerd/peer/config/measures.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::config::measures_test {

TEST(Measures, EveryNameIsDifferentAndFoundAgain) {
  std::set<std::string_view> names;
  for (const Measure& m : measures()) {
    EXPECT_TRUE(names.insert(m.name).second) << m.name;
    const auto found = find_measure(m.name);
    ASSERT_TRUE(found) << m.name;
    EXPECT_EQ(found->of_view, m.of_view);
  }
  EXPECT_FALSE(find_measure("ghost_error_m"));
  EXPECT_FALSE(find_measure("nonsense"));
  EXPECT_TRUE(find_measure("counters.drops")) << "by whatever is counted";
}

// A measure that stands in every summary stands where its name says.
TEST(Measures, AreWhereTheSummaryHasThem) {
  const measure::RunRecord run = measure::samples::zigzag_run(0.1);
  const auto summary = measure::summarise({"zigzag", "sim", 7, {}}, {&run, 1})["runs"][0];
  std::size_t of_views = 0;
  for (const Measure& m : measures()) {
    std::string path = "/" + std::string(m.name);
    for (char& c : path) c = c == '.' ? '/' : c;
    const nlohmann::ordered_json::json_pointer at(path);
    if (m.of_view) {
      ++of_views;
      EXPECT_TRUE(summary["objects"][0].contains(at)) << m.name;
    } else if (m.name.starts_with("traffic.")) {
      EXPECT_TRUE(summary.contains(at)) << m.name;
    }
  }
  EXPECT_GT(of_views, 5u);
}

}  // namespace peerd::config::measures_test
