#include "collision/exact/quadratic.hpp"

#include <gtest/gtest.h>

namespace peerd::collision::quadratic_test {

constexpr double kInf = std::numeric_limits<double>::infinity();

struct Case {
  const char* name;
  Quadratic q;
  TimeInterval first, second;
};
class NonPositive : public testing::TestWithParam<Case> {};
TEST_P(NonPositive, Intervals) {
  const TimeSet set = non_positive(GetParam().q);
  EXPECT_EQ(set.first.begin, GetParam().first.begin);
  EXPECT_EQ(set.first.end, GetParam().first.end);
  EXPECT_EQ(set.second.begin, GetParam().second.begin);
  EXPECT_EQ(set.second.end, GetParam().second.end);
}
INSTANTIATE_TEST_SUITE_P(
    Table, NonPositive,
    testing::Values(Case{"AlwaysAbove", {1, 0, 0}, {}, {}},
                    Case{"AlwaysTouching", {0, 0, 0}, TimeInterval::always(), {}},
                    Case{"Falling", {2, -1, 0}, {2, kInf}, {}}, Case{"Rising", {2, 1, 0}, {-kInf, -2}, {}},
                    Case{"Bowl", {2, -3, 1}, {1, 2}, {}}, Case{"BowlTouching", {1, -2, 1}, {1, 1}, {}},
                    Case{"BowlAbove", {1.5, -2, 1}, {}, {}}, Case{"Hill", {-2, 3, -1}, {-kInf, 1}, {2, kInf}},
                    Case{"HillBelow", {-2, 2, -1}, TimeInterval::always(), {}},
                    Case{"HillFromTouch", {0, 2, -1}, {-kInf, 0}, {2, kInf}},
                    Case{"PlainSquare", {-4, 0, 1}, {-2, 2}, {}}),
    [](const auto& which) { return std::string(which.param.name); });

TEST(Roots, SmallRootKeepsItsDigits) {  // the school formula gives 0 or 7.45e-9 here
  const Quadratic q{1.0, -1e9, 1.0};
  EXPECT_DOUBLE_EQ(non_positive(q).first.begin, 1e-9);
}

TEST(Roots, VanishingCurvatureNeedsNoThreshold) {
  for (double c2 = 1e-3; c2 > 0.0; c2 *= 1e-7) {
    EXPECT_NEAR(non_positive({3.0, -2.0, c2}).first.begin, 1.5, 2.0 * c2) << c2;
    EXPECT_NEAR(non_positive({3.0, -2.0, -c2}).second.begin, 1.5, 2.0 * c2) << c2;
  }
}

TEST(Roots, DiscriminantSurvivesCancellation) {  // (t - 1)(t - 1 - 2^-27): c1^2 and 4 c0 c2 agree to 54 bits
  const double d = 0x1p-27;
  const Quadratic q{1.0 + d, -(2.0 + d), 1.0};
  EXPECT_EQ(discriminant(q), d * d);
}

}  // namespace peerd::collision::quadratic_test
