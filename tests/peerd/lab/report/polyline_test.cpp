#include "peerd/lab/report/polyline.hpp"

#include <gtest/gtest.h>

#include <random>

namespace peerd::report::polyline_test {

constexpr Box kBox{10.0, 20.0, 30.0, 40.0};  // x from 10 to 40, y from 20 to 60

bool is_inside(const Point& p) {
  constexpr double kRounding = 1e-9;
  return p.x >= 10.0 - kRounding && p.x <= 40.0 + kRounding && p.y >= 20.0 - kRounding && p.y <= 60.0 + kRounding;
}

double distance_from(const Point& p, const Point& a, const Point& b) {
  double least = 1e300;
  for (int i = 0; i <= 1000; ++i) {
    const double s = i / 1000.0;
    least = std::min(least, std::hypot(p.x - a.x - s * (b.x - a.x), p.y - a.y - s * (b.y - a.y)));
  }
  return least;
}

TEST(Simplified, AStraightLineIsItsEnds) {
  std::vector<Point> line;
  for (int i = 0; i <= 100; ++i) line.push_back({1.0 * i, 2.0 * i});
  const auto few = simplified(line, 0.1);
  ASSERT_EQ(few.size(), 2u);
  EXPECT_EQ(few.back().x, 100.0);
}

TEST(Simplified, NoPointIsFartherThanTheTolerance) {
  std::mt19937 random(5);
  std::normal_distribution<double> step(0.0, 1.0);
  std::vector<Point> line{{0.0, 0.0}};
  for (int i = 0; i < 300; ++i) line.push_back({line.back().x + step(random), line.back().y + step(random)});
  const auto few = simplified(line, 2.0);
  EXPECT_LT(few.size(), 150u);
  for (const Point& p : line) {
    double least = 1e300;
    for (std::size_t i = 1; i < few.size(); ++i) least = std::min(least, distance_from(p, few[i - 1], few[i]));
    EXPECT_LE(least, 2.02);
  }
}

TEST(Simplified, ALoopKeepsItsFarthestPoint) {
  const std::vector<Point> loop{{0, 0}, {5, 1}, {10, 0}, {5, -1}, {0, 0}};
  EXPECT_EQ(simplified(loop, 3.0).size(), 3u);
  EXPECT_EQ(simplified(std::vector<Point>{{1, 1}}, 3.0).size(), 1u);
  EXPECT_TRUE(simplified({}, 3.0).empty());
}

TEST(ClippedLine, IsCutWhereItLeavesAndWhereItComesBack) {
  const std::vector<Point> line{{25, 30}, {25, 70}, {35, 70}, {35, 50}};
  const auto parts = clipped_line(line, kBox);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_DOUBLE_EQ(parts[0].back().y, 60.0);
  EXPECT_DOUBLE_EQ(parts[1].front().y, 60.0);
  EXPECT_DOUBLE_EQ(parts[1].back().y, 50.0);
}

TEST(ClippedLine, KeepsWhatIsInsideAsOneLine) {
  const std::vector<Point> line{{15, 30}, {20, 35}, {20, 55}};
  const auto parts = clipped_line(line, kBox);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].size(), 3u);
  EXPECT_TRUE(clipped_line(std::vector<Point>{{0, 0}, {5, 100}}, kBox).empty());
  const auto across = clipped_line(std::vector<Point>{{0, 40}, {100, 40}}, kBox);
  ASSERT_EQ(across.size(), 1u);
  EXPECT_DOUBLE_EQ(across[0].front().x, 10.0);
  EXPECT_DOUBLE_EQ(across[0].back().x, 40.0);
}

TEST(ClippedPolygon, OneThatIsLargerThanTheBoxIsTheBox) {
  const std::vector<Point> floor{{-100, -100}, {200, -100}, {200, 200}, {-100, 200}};
  const auto part = clipped_polygon(floor, kBox);
  ASSERT_EQ(part.size(), 4u);
  for (const Point& p : part) EXPECT_TRUE(is_inside(p));
}

// The area of what is left is the share of random points that are in both.
TEST(ClippedPolygon, HasTheAreaThatBothShare) {
  const std::vector<Point> triangle{{0, 30}, {50, 30}, {25, 80}};
  const auto part = clipped_polygon(triangle, kBox);
  double area = 0.0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Point &a = part[i], &b = part[(i + 1) % part.size()];
    EXPECT_TRUE(is_inside(a));
    area += 0.5 * (a.x * b.y - a.y * b.x);
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(10, 40), y(20, 60);
  int hits = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Point p{x(random), y(random)};
    hits += p.y >= 30.0 && p.y <= 80.0 - 2.0 * std::fabs(p.x - 25.0) ? 1 : 0;
  }
  EXPECT_NEAR(area, hits * 1200.0 / 100'000, 10.0);
  EXPECT_TRUE(clipped_polygon(std::vector<Point>{{0, 0}, {5, 0}, {5, 5}}, kBox).empty());
}

}  // namespace peerd::report::polyline_test
