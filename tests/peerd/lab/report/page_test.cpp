#include "peerd/lab/report/page.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <regex>

#include "peerd/lab/report/page_frame.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::page_test {

using testing::HasSubstr;
using testing::Not;

std::string page_of(const measure::ScenarioInfo& info, const std::vector<measure::RunRecord>& runs) {
  const Json summary = measure::summarise(info, runs);
  return report_page(info, runs, summary, make_figures(info, runs, summary));
}

std::string part(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  return begin == std::string::npos ? "" : text.substr(begin, text.find(to, begin) - begin);
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++count;
  return count;
}

// The cells of a table's body, row by row, without tags.
std::vector<std::vector<std::string>> cells_of(const std::string& html) {
  std::vector<std::vector<std::string>> rows;
  const std::regex row("<tr>(.*?)</tr>"), cell("<td[^>]*>(.*?)</td>"), tag("<[^>]*>");
  const std::string body = part(html, "<tbody>", "</tbody>");
  for (std::sregex_iterator r(body.begin(), body.end(), row), end; r != end; ++r) {
    rows.emplace_back();
    const std::string inside = (*r)[1];
    for (std::sregex_iterator c(inside.begin(), inside.end(), cell); c != end; ++c)
      rows.back().push_back(std::regex_replace((*c)[1].str(), tag, ""));
  }
  return rows;
}

const measure::ScenarioInfo kInfo{"zigzag", "sim", 7, {}, 1, "peerd sim 'a b.toml'"};

TEST(ReportPage, EscapesNamesFromFiles) {
  measure::ScenarioInfo info{"<b>&\"x\"", "sim", 1, {"</style><script>alert(1)</script>"}, 1, "peerd sim '<i>'"};
  std::vector<measure::RunRecord> runs{measure::samples::zigzag_run(0.1)};
  runs[0].objects[0].path = "CAR<script>&\"'\xff";
  runs[0].peers[1].name = "<img src=x>";
  runs[0].params = {{"<u>", "<s>"}};
  runs[0].counters = {{"<em>", 1}};
  const std::string html = page_of(info, runs);
  for (const char* tag : {"<script>alert", "CAR<script", "<img", "<b>", "<i>", "<u>", "<s>", "<em>"})
    EXPECT_THAT(html, Not(HasSubstr(tag)));
  EXPECT_THAT(html, HasSubstr("truth of CAR\\u003cscript>")) << "no name ends the script element of its figure";
  EXPECT_THAT(html, HasSubstr("<h1>&lt;b&gt;&amp;&quot;x&quot;</h1>"));
  EXPECT_THAT(html, HasSubstr("CAR&lt;script&gt;&amp;&quot;'\xef\xbf\xbd"));
}

TEST(ReportPage, NeedsNothingButItself) {
  const std::string html = page_of(kInfo, measure::samples::zigzag_sweep());
  for (const char* what : {" src=", "@import", "<iframe", "fetch(", "import("}) EXPECT_THAT(html, Not(HasSubstr(what)));
  EXPECT_EQ(count_of(html, "<link"), 1u);  // an empty icon, which a browser would ask a server for
  EXPECT_EQ(count_of(html, "http"), 1u) << "the name of SVG";
}

TEST(ReportPage, HasTheNumbersOfTheSummary) {
  const std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  const Json summary = measure::summarise(kInfo, runs);
  const auto rows = cells_of(part(page_of(kInfo, runs), "<h2>Runs</h2>", "<h2>All"));
  ASSERT_EQ(rows.size(), runs.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {  // run, approach, latency, updates, three at b, three at c, bytes/s
    ASSERT_EQ(rows[i].size(), 11u);
    const Json& run = summary.at("runs")[i];
    EXPECT_EQ(rows[i][0], std::to_string(i + 1));
    EXPECT_EQ(rows[i][1], run.at("params").at("replication.approach"));
    EXPECT_EQ(rows[i][3], run.at("objects")[0].at("updates_sent").dump());
    for (const std::size_t observer : {0u, 1u}) {
      const Json& error_m = run.at("objects")[observer].at("ghost_error_m");
      std::size_t cell = 4 + 3 * observer;
      for (const char* what : {"mean", "p99", "max"}) {
        const double value = error_m.at(what);
        EXPECT_NEAR(std::strtod(rows[i][cell++].c_str(), nullptr), value, 5e-4 * value) << what << " of run " << i + 1;
      }
    }
    EXPECT_NEAR(std::strtod(rows[i][10].c_str(), nullptr), run.at("traffic").at("bytes_per_s").get<double>(), 0.5);
  }
}

TEST(ReportPage, SaysWhatWasRun) {
  const std::string html = page_of(kInfo, measure::samples::zigzag_sweep());
  EXPECT_THAT(html, HasSubstr("on a simulated network, seed 7, 6 runs of 10 s. Peers: a, b, c. "));
  EXPECT_THAT(html, HasSubstr("<code>peerd sim 'a b.toml'</code>"));
  EXPECT_THAT(html, HasSubstr("<code>network.latency_ms</code></td><td>swept</td><td class=\"wrap\">5, 100, 500</td>"));
}

TEST(ReportPage, SaysWhatTheNetworkWas) {
  std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  for (measure::RunRecord& run : runs) run.network_settings = {{"network.jitter_ms", 20.0}, {"network.loss", 0.05}};
  const std::string html = part(page_of(kInfo, runs), "<h2>What was run</h2>", "<h2>Runs");
  EXPECT_THAT(html, HasSubstr("<code>network.jitter_ms</code></td><td>set</td><td class=\"wrap\">20</td>"));
  EXPECT_THAT(html, HasSubstr("<code>network.loss</code></td><td>set</td><td class=\"wrap\">0.05</td>"));
}

TEST(ReportPage, ListsAllObjects) {
  const auto rows =
      cells_of(part(page_of(kInfo, measure::samples::zigzag_sweep()), "<h2>Objects</h2>", "<h2>Run by run"));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_THAT(rows[0], testing::ElementsAre("*", "CAR", "a", "5.0", testing::_, testing::_, testing::_));
  EXPECT_THAT(rows[1], testing::ElementsAre("", "CUBE", "b", "1.0", "0", "0", "0"));
}

TEST(ReportPage, MarksThePrincipalObjectOfARun) {
  const auto rows =
      cells_of(part(page_of(kInfo, {measure::samples::zigzag_run(0.1)}), "<h3>Objects</h3>", "<h3>Contacts"));
  ASSERT_EQ(rows.size(), 4u);
  for (const auto& row : rows) EXPECT_EQ(row[0], row[1] == "CAR" ? "*" : "");
}

TEST(ReportPage, HoldsEveryFigureOfItsRuns) {
  const std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  const std::string html = page_of(kInfo, runs);
  for (const char* name : {"overview", "pareto", "multiples", "plan", "run-1", "timeline-6"})
    EXPECT_EQ(count_of(html, "<figure data-name=\"" + std::string(name) + '"'), 1u) << name;
  EXPECT_EQ(count_of(html, "<script class=\"figure\" type=\"application/json\">{"), 4u + 2u * runs.size());
  for (std::size_t i = 1; i <= runs.size(); ++i) {  // each row's link has somewhere to go
    EXPECT_EQ(count_of(html, "href=\"#run-" + std::to_string(i) + "\""), 1u);
    EXPECT_EQ(count_of(html, "id=\"run-" + std::to_string(i) + "\""), 1u);
  }
}

// 250 runs of 100 kB of figures, with 60 objects each: the page stays some megabytes, and says what it leaves out.
TEST(ReportPage, IsBoundedAndSaysWhatItLeavesOut) {
  measure::RunRecord run = measure::samples::quiet_run();
  for (std::uint32_t i = 0; i < 60; ++i)
    run.objects.push_back({ObjectId{100 + i}, "o" + std::to_string(i), measure::samples::kA});
  std::vector<measure::RunRecord> runs;
  for (int i = 0; i < 250; ++i) {
    runs.push_back(run);
    runs.back().params = {{"replication.order", i}};
  }
  const Json summary = measure::summarise(kInfo, runs);
  Figures figures{.sweep = nullptr, .overview = Json::object(), .pareto = nullptr, .plan = Json::object(), .runs = {}};
  figures.runs.assign(runs.size(), Json(std::string(100'000, 'x')));
  const std::string html = report_page(kInfo, runs, summary, figures);
  EXPECT_LT(html.size(), 16u << 20);
  const std::size_t drawn = count_of(html, ">\"xxx");
  EXPECT_GT(drawn, 50u);
  EXPECT_THAT(html, HasSubstr("The figures of " + std::to_string(200 - drawn) + " runs are left out of this page"));
  EXPECT_EQ(count_of(html, "Its figures are left out of this page"), 200 - drawn);
  EXPECT_THAT(html, HasSubstr("Of 50 runs (from 201 on) there is nothing below"));
  // There are 62 objects, each seen by two others: of the 124 rows the page has 24.
  EXPECT_EQ(count_of(html, "100 more rows are left out of this page"), 200u);
  EXPECT_THAT(html, HasSubstr(", 39 and 210 more</td>"));  // values of a key
}

TEST(ReportPage, SaysWhatWasExpected) {
  const std::vector<measure::RunRecord> runs{measure::samples::zigzag_run(0.1)};
  Json summary = measure::summarise(kInfo, runs);
  summary["expectations"] = Json::parse(R"([
    {"name": "near", "that": "ghost_error_m.mean", "at_most": 0.05, "object": "CAR", "held": false, "values": 2,
     "failed": 1, "failures": [{"run": 1, "observer": "b", "found": 0.3}]},
    {"name": "real", "that": "traffic.bytes", "equals": 1, "held": null, "values": 0, "failed": 0, "failures": []}])");
  const std::string html = report_page(kInfo, runs, summary, make_figures(kInfo, runs, summary));
  using testing::ElementsAre;
  EXPECT_THAT(
      cells_of(part(html, "<h2>Expectations</h2>", "<h2>What")),
      ElementsAre(ElementsAre("near", "ghost_error_m.mean &lt;= 0.05 of CAR", "FAILED", "2", "1", "0.3 in run 1, b"),
                  ElementsAre("real", "traffic.bytes = 1", "not checked", "0", "0", "")));
}

TEST(ReportPage, UnfoldsARunAlone) {
  EXPECT_THAT(page_of(kInfo, {measure::samples::zigzag_run(0.1)}),
              HasSubstr("<details open><summary><strong>Run 1</strong>"));
  EXPECT_THAT(page_of(kInfo, measure::samples::zigzag_sweep()), Not(HasSubstr("<details open>")));
}

TEST(ReportPage, OfNoRunsAndOfEmptyOnes) {
  EXPECT_THAT(page_of(kInfo, {}), HasSubstr("No object that another peer observes."));
  EXPECT_THAT(page_of(kInfo, {measure::RunRecord{}, measure::samples::quiet_run()}),
              HasSubstr("<strong>Run 2</strong>"));
}

}  // namespace peerd::report::page_test
