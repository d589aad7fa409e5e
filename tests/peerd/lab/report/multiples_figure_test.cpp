#include "peerd/lab/report/figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <vector>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::multiples_figure_test {

const measure::ScenarioInfo kInfo{"zig & <zag>", "sim", 7, {}};

std::string multiples_of(const std::vector<measure::RunRecord>& runs) {
  return multiples_figure(kInfo, runs, figure_frame(runs, measure::summarise(kInfo, runs)));
}

// The titles of the pictures, in order, such as "1 dr, latency 5 ms".
std::vector<std::string> titles_of(const std::string& svg) {
  std::vector<std::string> titles;
  const std::regex title(R"(font-weight="bold">([0-9]+)</text>\n<text [^>]*font-weight="bold">([^<]*)</text>)");
  for (std::sregex_iterator it(svg.begin(), svg.end(), title), end; it != end; ++it)
    titles.push_back((*it)[1].str() + ' ' + (*it)[2].str());
  return titles;
}

TEST(MultiplesFigure, NumbersItsPicturesRowByRow) {
  EXPECT_THAT(titles_of(multiples_of(measure::samples::zigzag_sweep())),
              testing::ElementsAre("1 dr, latency 5 ms", "2 dr, latency 100 ms", "3 dr, latency 500 ms",
                                   "4 dr+rcp, latency 5 ms", "5 dr+rcp, latency 100 ms", "6 dr+rcp, latency 500 ms"));
}

// The third key's values share a picture, so that there are no more pictures, but a ghost in each colour.
TEST(MultiplesFigure, DrawsAThirdKeyInColours) {
  std::vector<measure::RunRecord> runs;
  for (const int order : {1, 2}) {
    for (measure::RunRecord run : measure::samples::zigzag_sweep()) {
      run.params["replication.order"] = order;
      runs.push_back(std::move(run));
    }
  }
  const std::string svg = multiples_of(runs);
  EXPECT_EQ(titles_of(svg).size(), 6u);
  EXPECT_THAT(svg, testing::HasSubstr(">ghost, order 1</text>"));
  EXPECT_THAT(svg, testing::HasSubstr(">order 2: 5 updates, mean "));
}

TEST(MultiplesFigure, IsNotDrawnWhereTooMuchWouldBeLeftOut) {
  std::vector<measure::RunRecord> runs;
  for (int latency_ms = 1; latency_ms <= 8; ++latency_ms) {  // columns: at most seven
    runs.push_back(measure::samples::zigzag_run(0.1, 10));
    runs.back().params = {{"network.latency_ms", latency_ms}};
  }
  EXPECT_EQ(multiples_of(runs), "");
  runs.pop_back();
  EXPECT_NE(multiples_of(runs), "");
  for (std::size_t i = 0; i < runs.size(); ++i) {  // four keys
    for (const char* key : {"a", "b", "c"}) runs[i].params[key] = i;
  }
  EXPECT_EQ(multiples_of(runs), "");
}

}  // namespace peerd::report::multiples_figure_test
