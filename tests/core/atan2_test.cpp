#include "core/atan2.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>

namespace peerd::atan2_test {

TEST(Atan2, MeetsTheLibrarysInLongDouble) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
  std::uniform_int_distribution<int> exponent(-30, 30);
  double worst = 0.0;
  double worst_relative = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    const double size_y = mantissa(random);
    const double size_x = mantissa(random);
    const double y = std::ldexp(size_y, exponent(random));
    const double x = std::ldexp(size_x, i % 2 ? 0 : exponent(random));
    const long double truth = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    const double error = static_cast<double>(std::abs(peerd::atan2(y, x) - truth));
    worst = std::max(worst, error);
    worst_relative = std::max(worst_relative, error / static_cast<double>(std::abs(truth)));
  }
  EXPECT_LT(worst, 6e-16);
  EXPECT_LT(worst_relative, 5e-16);
  std::printf("atan2: worst error %.2e rad, %.2e relative\n", worst, worst_relative);
}

TEST(Atan2, GoesAllAround) {
  for (int degree = -180; degree <= 180; ++degree) {
    const double angle = degree * std::numbers::pi / 180.0;
    EXPECT_NEAR(peerd::atan2(std::sin(angle), std::cos(angle)), angle, 9e-16) << degree;
  }
}

TEST(Atan2, KeepsSignsOfZeroAsTheLibraryDoes) {
  for (const double y : {0.0, -0.0, 1.0, -1.0, 5e-324, -5e-324, 1.7e308}) {
    for (const double x : {0.0, -0.0, 1.0, -1.0, 5e-324, -5e-324, 1.7e308}) {
      EXPECT_NEAR(peerd::atan2(y, x), std::atan2(y, x), 6e-16) << y << ' ' << x;
      EXPECT_EQ(std::signbit(peerd::atan2(y, x)), std::signbit(y)) << y << ' ' << x;
    }
  }
  EXPECT_TRUE(std::isnan(peerd::atan2(std::numeric_limits<double>::infinity(), 1.0)));
}

TEST(Atan2, IsTheSameEverywhere) {
  EXPECT_EQ(peerd::atan2(1.0, 3.0), 0x1.4978fa3269ee1p-2);
  EXPECT_EQ(peerd::atan2(-2.0, -0.7), -0x1.e850076ee9e8ep+0);
}

}  // namespace peerd::atan2_test
