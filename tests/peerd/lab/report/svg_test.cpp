#include "peerd/lab/report/svg.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "tests/peerd/well_formed.hpp"

namespace peerd::report::svg_test {

using testing_support::malformed;

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

TEST(Svg, ManyLinesAreOneElement) {
  Svg svg(100, 100);
  svg.lines(std::vector<std::vector<Point>>{{{1, 2}, {3, 4.5}}, {}, {{5, 6}, {7, 8}, {9, 10}}}, {.colour = "#123"});
  const std::string text = std::move(svg).finish();
  EXPECT_FALSE(testing_support::malformed(text));
  EXPECT_THAT(text, testing::HasSubstr(" d=\"M1,2 3,4.5M5,6 7,8 9,10\"/>"));
}

TEST(Svg, PolygonsAreFilled) {
  Svg svg(100, 100);
  svg.polygon(std::vector<Point>{{1, 2}, {3, 4}, {5, 0}}, "#123", 0.07);
  const std::string text = std::move(svg).finish();
  EXPECT_FALSE(testing_support::malformed(text));
  EXPECT_THAT(text, testing::HasSubstr("<polygon fill=\"#123\" fill-opacity=\"0.07\" points=\"1,2 3,4 5,0\"/>"));
}

}  // namespace peerd::report::svg_test
