#include "peerd/report/svg.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <optional>
#include <regex>

#include "peerd/report/figure_parts.hpp"
#include "peerd/report/figures.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::svg_test {

// Why a text is not well-formed XML of the simple kind that we write; nullopt if it is.
std::optional<std::string> malformed(const std::string& xml) {
  std::vector<std::string> open;
  std::size_t at = 0;
  while ((at = xml.find('<', at)) != std::string::npos) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return "unclosed tag at " + std::to_string(at);
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.find('<') != std::string::npos) return "'<' in tag " + tag;
    if (std::ranges::count(tag, '"') % 2 != 0) return "odd quotes in tag " + tag;
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag.front() == '/') {
      if (open.empty() || "/" + open.back() != tag) return "unexpected " + tag;
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
    at = end;
  }
  for (at = 0; (at = xml.find('&', at)) != std::string::npos; ++at) {
    const std::string entity = xml.substr(at, xml.find(';', at) - at);
    if (entity != "&amp" && entity != "&lt" && entity != "&gt" && entity != "&quot")
      return "bare & at " + std::to_string(at);
  }
  for (const char* bad : {"nan", "inf"}) {
    if (xml.find(std::string("\"") + bad) != std::string::npos) return std::string("a number is ") + bad;
  }
  if (!open.empty()) return "unclosed " + open.back();
  return xml.starts_with("<svg ") ? std::nullopt : std::optional<std::string>("no svg element");
}

TEST(SvgChecker, SeesFaults) {
  EXPECT_TRUE(malformed("<svg ><g></svg>"));
  EXPECT_TRUE(malformed("<svg ><text>a & b</text></svg>"));
  EXPECT_TRUE(malformed("<svg ><text x=\"1>a</text></svg>"));
  EXPECT_FALSE(malformed("<svg a=\"1\"><text>a &amp; b</text><line/></svg>"));
}

struct TickCase {
  const char* name;
  Range range;
  int most;
  std::vector<std::string> labels;
};
void PrintTo(const TickCase& c, std::ostream* os) { *os << c.name; }

class NiceTicks : public testing::TestWithParam<TickCase> {};
TEST_P(NiceTicks, AreAsWritten) {
  const Ticks ticks = nice_ticks(GetParam().range, GetParam().most);
  std::vector<std::string> labels;
  for (const double t : ticks.at) labels.push_back(tick_label(t, ticks.decimals));
  EXPECT_EQ(labels, GetParam().labels);
}
INSTANTIATE_TEST_SUITE_P(
    Table, NiceTicks,
    testing::Values(TickCase{"Seconds",
                             {0, 15},
                             16,
                             {"0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15"}},
                    TickCase{"SecondsCoarse", {0, 15}, 6, {"0", "5", "10", "15"}},
                    TickCase{"Latency", {0, 515}, 7, {"0", "100", "200", "300", "400", "500"}},
                    TickCase{"Tenths", {0, 0.6}, 4, {"0.0", "0.2", "0.4", "0.6"}},
                    TickCase{"AcrossZeroWithoutMinusZero", {-0.25, 0.25}, 5, {"-0.2", "-0.1", "0.0", "0.1", "0.2"}},
                    TickCase{"Millimetres", {0, 0.0023}, 6, {"0.0000", "0.0005", "0.0010", "0.0015", "0.0020"}},
                    TickCase{
                        "FarFromTheOrigin", {100000.1, 100000.4}, 4, {"100000.1", "100000.2", "100000.3", "100000.4"}},
                    TickCase{"SinglePoint", {3, 3}, 3, {"2.5", "3.0", "3.5"}},
                    TickCase{"Empty", {}, 3, {"0.0", "0.5", "1.0"}}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(NiceTicksProperty, InsideTheRangeAndNotTooMany) {
  for (const double lo : {-7.3, 0.0, 1e-9, 12345.678, -1e12}) {
    for (const double width : {1e-9, 0.037, 1.0, 9.99, 4321.0, 1e15}) {
      const Range range = drawable({lo, lo + width});
      for (const int most : {2, 5, 11}) {
        const Ticks ticks = nice_ticks(range, most);
        EXPECT_LE(ticks.at.size(), static_cast<std::size_t>(most));
        const double room = 1e-6 * (range.hi - range.lo);
        for (const double t : ticks.at) EXPECT_TRUE(t >= range.lo - room && t <= range.hi + room) << lo << ' ' << width;
      }
    }
  }
}

TEST(LogTicks, AreOneTwoFiveOrThePowersAlone) {
  EXPECT_THAT(log_ticks({0.04, 1.3}, 9), testing::ElementsAre(0.05, 0.1, 0.2, 0.5, 1.0));
  EXPECT_THAT(log_ticks({1e-4, 20.0}, 9), testing::ElementsAre(1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0));
}

TEST(Panel, LogarithmicPutsTenTimesAsMuchEquallyFarUp) {
  const Panel panel = Panel::log_y({0, 0, 100, 300}, {0, 1}, {0.01, 10.0});
  EXPECT_NEAR(panel.py(0.01), 300.0, 1e-9);
  EXPECT_NEAR(panel.py(0.1), 200.0, 1e-9);
  EXPECT_NEAR(panel.py(10.0), 0.0, 1e-9);
}

TEST(Svg, EscapesWhatXmlCannotHold) {
  Svg svg(10, 10);
  svg.text({0, 0}, "<a & \"b\">\x01 \xff \xc3\xa4");
  const std::string xml = std::move(svg).finish();
  EXPECT_FALSE(malformed(xml)) << *malformed(xml);
  EXPECT_THAT(xml, testing::HasSubstr("&lt;a &amp; &quot;b&quot;&gt;  \xef\xbf\xbd \xc3\xa4</text>"));
}

TEST(Svg, PolylineBreaksWhereThereIsNoNumber) {
  Svg svg(10, 10);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Point> points{{0, 0}, {1, 1}, {2, nan}, {3, 3.26}, {4, -4}};
  svg.polyline(points, {});
  const std::string xml = std::move(svg).finish();
  EXPECT_THAT(xml, testing::HasSubstr("points=\"0,0 1,1\""));
  EXPECT_THAT(xml, testing::HasSubstr("points=\"3,3.3 4,-4\""));
}

TEST(Panel, ThinningKeepsEveryPeak) {
  std::vector<Point> data;
  for (int i = 0; i < 100000; ++i) data.push_back({i * 1e-5, i == 31234 ? 1.0 : i == 77777 ? -1.0 : 0.0});
  const Panel panel({0, 0, 200, 100}, {0, 1}, {-1, 1});
  Svg svg(200, 100);
  panel.draw_curve(svg, data, {});
  const std::string xml = std::move(svg).finish();
  EXPECT_LT(xml.size(), 12000u);
  EXPECT_THAT(xml, testing::HasSubstr(",0 "));    // the top: y of 1.0
  EXPECT_THAT(xml, testing::HasSubstr(",100 "));  // the bottom: y of -1.0
}

const ScenarioInfo kInfo{"zig & <zag>", "sim", 7, {}};

void expect_figures(const std::vector<RunRecord>& runs) {
  const nlohmann::ordered_json summary = summarise(kInfo, runs);
  const FigureFrame frame = figure_frame(runs, summary);
  std::vector<std::string> pictures{overview_figure(summary), plan_figure(kInfo, runs, summary)};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    pictures.push_back(run_figure(kInfo, runs[i], i + 1, frame));
    pictures.push_back(timeline_figure(kInfo, runs[i], i + 1, frame));
  }
  for (const std::string& of_sweeps : {pareto_figure(summary), multiples_figure(kInfo, runs, frame)}) {
    if (!of_sweeps.empty()) pictures.push_back(of_sweeps);
  }
  for (const std::string& picture : pictures) {
    EXPECT_FALSE(malformed(picture)) << *malformed(picture);
    EXPECT_EQ(picture.find("<script"), std::string::npos);
    EXPECT_THAT(picture, testing::HasSubstr("</text>"));
  }
}

TEST(Figures, AreWellFormed) { expect_figures(samples::zigzag_sweep()); }
TEST(Figures, OfOneRun) { expect_figures({samples::zigzag_run(0.1)}); }
// Upright lines with their names; names that would cover each other go below.
TEST(Figures, MarkTheEvents) {
  RunRecord run = samples::zigzag_run(0.1);
  const auto draw = [&] {
    const FigureFrame frame = figure_frame({&run, 1}, summarise(kInfo, {&run, 1}));
    return std::array{run_figure(kInfo, run, 1, frame), timeline_figure(kInfo, run, 1, frame)};
  };
  const auto count = [](const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  };
  for (const std::string& svg : draw()) EXPECT_EQ(count(svg, std::string(kEventColour)), 0u);
  run.events = {{0.2 * run.duration_s, "apart & away"}, {0.21 * run.duration_s, "strike"}, {run.duration_s, "the-end"}};
  for (const std::string& svg : draw()) {
    EXPECT_EQ(count(svg, std::string(kEventColour)), 3u * (3 + 1)) << "three panels and a name each";
    EXPECT_EQ(count(svg, ">apart &amp; away<"), 1u);
    const auto y_of = [&](const std::string& name) {
      const auto text = svg.substr(svg.rfind("<text", svg.find(">" + name + "<")));
      return std::stod(text.substr(text.find(" y=\"") + 4));
    };
    EXPECT_GT(y_of("strike"), y_of("apart &amp; away"));
    EXPECT_EQ(y_of("the-end"), y_of("apart &amp; away"));
  }
}

TEST(Figures, OfNoRun) { expect_figures({}); }
TEST(Figures, OfRunsWithNothingInThem) { expect_figures({RunRecord{}, samples::quiet_run()}); }
TEST(Figures, OfALongRun) {
  RunRecord run = samples::zigzag_run(0.1, 20000);
  run.duration_s = 1000.5;
  expect_figures({run});
}
TEST(Figures, OfRunsThatAreBroken) {
  RunRecord run = samples::zigzag_run(0.1);
  for (std::size_t i = 0; i < run.ghost_samples.size(); i += 3) {
    run.ghost_samples[i].ghost.position.x() = std::numeric_limits<double>::quiet_NaN();
    run.ghost_samples[i].truth.position.z() = std::numeric_limits<double>::infinity();
  }
  expect_figures({run});
}
TEST(Figures, OfASweepOverWords) {
  std::vector<RunRecord> runs = samples::zigzag_sweep();
  for (RunRecord& run : runs) run.params.erase("network.latency_ms");
  expect_figures(runs);
}
TEST(Figures, OfRunsWithoutAFirstObject) {
  std::vector<RunRecord> runs = samples::zigzag_sweep();
  runs[1].objects.erase(runs[1].objects.begin());
  expect_figures(runs);
}

std::string multiples_of(const std::vector<RunRecord>& runs) {
  return multiples_figure(kInfo, runs, figure_frame(runs, summarise(kInfo, runs)));
}

// "1 dr, latency 5 ms", ..: the titles of its pictures, in order.
std::vector<std::string> titles_of(const std::string& svg) {
  std::vector<std::string> titles;
  const std::regex title(R"(font-weight="bold">([0-9]+)</text>\n<text [^>]*font-weight="bold">([^<]*)</text>)");
  for (std::sregex_iterator it(svg.begin(), svg.end(), title), end; it != end; ++it)
    titles.push_back((*it)[1].str() + ' ' + (*it)[2].str());
  return titles;
}

TEST(MultiplesFigure, NumbersItsPicturesRowByRow) {
  EXPECT_THAT(titles_of(multiples_of(samples::zigzag_sweep())),
              testing::ElementsAre("1 dr, latency 5 ms", "2 dr, latency 100 ms", "3 dr, latency 500 ms",
                                   "4 dr+rcp, latency 5 ms", "5 dr+rcp, latency 100 ms", "6 dr+rcp, latency 500 ms"));
}

// The third key's values share a picture: as many pictures, and a ghost in each colour.
TEST(MultiplesFigure, DrawsAThirdKeyInColours) {
  std::vector<RunRecord> runs;
  for (const int order : {1, 2}) {
    for (RunRecord run : samples::zigzag_sweep()) {
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
  std::vector<RunRecord> runs;
  for (int latency_ms = 1; latency_ms <= 8; ++latency_ms) {  // columns: at most seven
    runs.push_back(samples::zigzag_run(0.1, 10));
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

// Where there are more than can be drawn, it says so: here 4,000 contacts, of which 3,000 are.
TEST(TimelineFigure, SaysWhatItLeavesOut) {
  RunRecord run = samples::zigzag_run(0.1);
  run.contacts.clear();
  for (int i = 0; i < 4000; ++i) {
    const double t_s = 0.0025 * i;
    run.contacts.push_back({t_s, samples::kA, "owner", samples::kCar, samples::kWall, Vec3::UnitX(), t_s});
  }
  const std::string svg = timeline_figure(kInfo, run, 1, figure_frame({&run, 1}, summarise(kInfo, {&run, 1})));
  EXPECT_THAT(svg, testing::HasSubstr(">4000 to an own object</text>"));
  EXPECT_THAT(svg, testing::HasSubstr(">1000 not drawn</text>"));
}

TEST(FigureFrame, DrawsTheCoordinateThatTurns) {
  const std::vector<RunRecord> runs = samples::zigzag_sweep();
  const FigureFrame frame = figure_frame(runs, summarise(kInfo, runs));
  EXPECT_EQ(frame.object, "CAR");
  EXPECT_EQ(frame.component, 0);  // z has the greater range, but no turn
}

TEST(FigureFrame, DrawsTheCoordinateThatMovesIfNoneTurns) {
  RunRecord run = samples::quiet_run();
  for (int i = 0; i < 50; ++i) {
    const double t_s = 0.1 * i;
    run.ghost_samples.push_back(samples::belief(t_s, samples::kB, samples::kCar, {0.1 * t_s, 0, -0.3 * t_s}, {1, 0, 0}));
  }
  EXPECT_EQ(figure_frame({&run, 1}, summarise(kInfo, {&run, 1})).component, 2);
}

TEST(FigureFrame, SameScaleForSameLatency) {
  const std::vector<RunRecord> runs = samples::zigzag_sweep();
  const FigureFrame frame = figure_frame(runs, summarise(kInfo, runs));
  ASSERT_EQ(frame.error_m.size(), 3u);
  EXPECT_LT(frame.error_m.at("5").hi, frame.error_m.at("500").hi);
}

}  // namespace peerd::report::svg_test
