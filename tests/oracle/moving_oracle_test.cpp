#include "tests/oracle/moving_oracle.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/oracle/triangle_cases.hpp"

namespace peerd::oracle::moving_oracle_test {

constexpr Triangle kFloor{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};

MovingTriangle still(const Triangle& t) { return {t, t}; }
MovingTriangle moved(Triangle t, const Point& by) {
  MovingTriangle out{t, t};
  for (Point& p : out.at_1) {
    for (std::size_t k = 0; k < 3; ++k) p[k] += by[k];
  }
  return out;
}

struct Case {
  const char* name;
  MovingTriangle a, b;
  double time;  // below 0: never
};

constexpr Triangle kTipDown{{{1, 1, 1}, {2, 1, 3}, {1, 2, 3}}};
constexpr Triangle kAlongX{{{-3, 1, 0}, {-2, 1, 0}, {-2, 2, 0}}};

class FirstTouchOf : public testing::TestWithParam<Case> {};
TEST_P(FirstTouchOf, IsThatOfTheTable) {
  const Case& c = GetParam();
  for (const bool swapped : {false, true}) {
    const auto first = swapped ? first_touch(c.b, c.a) : first_touch(c.a, c.b);
    ASSERT_EQ(first.has_value(), c.time >= 0.0);
    if (!first) continue;
    EXPECT_LE(first->not_before, c.time);
    EXPECT_GE(first->at_latest, c.time);
    EXPECT_LE(first->at_latest - first->not_before, 0x1p-64);
    EXPECT_TRUE(touch_at(c.a, c.b, first->at_latest));
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, FirstTouchOf,
    testing::Values(Case{"Still", still(kFloor), still(kTipDown), -1}, Case{"AtBegin", still(kFloor), still(kFloor), 0},
                    Case{"CornerFalls", still(kFloor), moved(kTipDown, {0, 0, -2}), 0.5},
                    Case{"AtTheEnd", still(kFloor), moved(kTipDown, {0, 0, -1}), 1},
                    Case{"NotQuite", still(kFloor), moved(kTipDown, {0, 0, -0.9999999}), -1},
                    Case{"PassesBy", still(kFloor), moved(kTipDown, {8, 0, -2}), -1},
                    Case{"InThePlane", still(kFloor), moved(kAlongX, {4, 0, 0}), 0.5},
                    Case{"AlongAnEdge", still(kFloor), moved({{{-2, 0, 0}, {-1, 0, 0}, {-2, 0, 1}}}, {4, 0, 0}), 0.25},
                    Case{"GrazesACorner",
                         still(kFloor),
                         {{{{-1, -1, 0}, {-1, -1, 0}, {-1, -1, 0}}}, {{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}}},
                         0.5},
                    Case{"GrazesOnlyACorner",
                         still(kFloor),
                         {{{{-1, 1, 0}, {-1, 1, 0}, {-1, 1, 0}}}, {{{1, -1, 0}, {1, -1, 0}, {1, -1, 0}}}},
                         0.5}),
    [](const auto& test) { return std::string(test.param.name); });

// A third is no binary64 number.
TEST(FirstTouch, BracketsAThird) {
  const auto first = first_touch(still(kFloor), moved(kTipDown, {0, 0, -3}));
  ASSERT_TRUE(first);
  EXPECT_LE(first->not_before, mpq_class(1, 3));
  EXPECT_GE(first->at_latest, mpq_class(1, 3));
}

TEST(FirstTouch, NoSampledTimeTouchesBefore) {
  Rng rng(5);
  int touches = 0;
  for (int i = 0; i < 150; ++i) {
    MovingTriangle a, b;
    for (MovingTriangle* t : {&a, &b}) {
      for (Triangle* end : {&t->at_0, &t->at_1}) {
        for (Point& p : *end) p = {rng.real(-1, 1), rng.real(-1, 1), rng.real(-1, 1)};
      }
    }
    const auto first = first_touch(a, b);
    touches += first.has_value();
    const mpq_class end = first ? first->not_before : mpq_class(1);
    for (int sample = 0; sample < 64; ++sample) {
      if (end == 0) break;
      ASSERT_FALSE(touch_at(a, b, end * sample / 64)) << i;
    }
    if (!first) continue;
    ASSERT_TRUE(touch_at(a, b, first->at_latest)) << i;
    ASSERT_EQ(squared_distance_at(a, b, first->at_latest), 0) << i;
  }
  EXPECT_GT(touches, 50);
}

}  // namespace peerd::oracle::moving_oracle_test
