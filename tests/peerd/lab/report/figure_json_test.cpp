#include "peerd/lab/report/figure_json.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace peerd::report::figure_json_test {

const double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Thinned, KeepsTheSpikesOfALongLine) {
  std::vector<Point> line;
  for (int i = 0; i < 10'000; ++i) line.push_back({0.001 * i, 0.0});
  line[1234].y = 7.0;
  line[8765].y = -3.0;
  const std::vector<Point> few = thinned(line, 100);
  EXPECT_LE(few.size(), 201u);
  Range y;
  for (const Point& p : few) y.add(p.y);
  EXPECT_EQ(y.lo, -3.0);
  EXPECT_EQ(y.hi, 7.0);
  EXPECT_TRUE(std::ranges::is_sorted(few, {}, &Point::x));
}

TEST(Thinned, LeavesOutWhatIsNoNumberAndInterruptsTheLine) {
  const std::vector<Point> line{{0, kNan}, {1, 1}, {2, kNan}, {3, 1e300}, {4, 2}, {5, kNan}};
  const std::vector<Point> few = thinned(line, 100);
  ASSERT_EQ(few.size(), 3u);
  EXPECT_EQ(few[0].y, 1.0);
  EXPECT_TRUE(std::isnan(few[1].y));
  EXPECT_EQ(few[2].y, 2.0);
  EXPECT_TRUE(thinned({}, 5).empty());
}

TEST(Numbers, AreRoundedToTheirRange) {
  EXPECT_EQ(numbers(std::vector{0.0, 0.123456789, 1.0, kNan, 1e300}).dump(), "[0.0,0.1235,1.0,null,null]");
  EXPECT_EQ(numbers(std::vector{1000.00001, 1000.00002}).dump(), "[1000.00001,1000.00002]");
  EXPECT_EQ(numbers(std::vector{-0.0, 12345678.9}).dump(), "[0.0,12345679.0]");
  EXPECT_EQ(numbers({}).dump(), "[]");
}

}  // namespace peerd::report::figure_json_test
