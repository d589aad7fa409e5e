#include "core/sin_cos.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace peerd::sin_cos_test {

double off_by(const SinCos& is, double x) {
  const long double exact = x;
  return static_cast<double>(std::max(std::abs(is.sin - std::sin(exact)), std::abs(is.cos - std::cos(exact))));
}

TEST(SinCos, IsWithinAFewRoundingsOfTheLibrarysInLongDouble) {
  double worst = 0.0, worst_far = 0.0;
  for (int i = -200'000; i <= 200'000; ++i) {
    const double x = std::numbers::pi * i / 100'000.0;  // two turns
    worst = std::max(worst, off_by(sin_cos(x), x));
    worst_far = std::max(worst_far, off_by(sin_cos(16.0 * x), 16.0 * x));
  }
  EXPECT_LT(worst, 4e-16);
  EXPECT_LT(worst_far, 5e-15);
}

TEST(SinCos, KeepsTheSignAndSizeOfWhatIsTiny) {
  for (const double x : {-0.0, 5e-324, -1e-300, 1e-9}) {
    EXPECT_EQ(sin_cos(x).sin, x);
    EXPECT_EQ(std::signbit(sin_cos(x).sin), std::signbit(x));
    EXPECT_EQ(sin_cos(x).cos, 1.0);
  }
}

TEST(SincCos, IsThatOfTheRoot) {
  EXPECT_EQ(sinc_cos(0.0).sinc, 1.0);
  EXPECT_EQ(sinc_cos(0.0).cos, 1.0);
  for (int i = 1; i <= 100'000; ++i) {
    const double x2 = kSincCosMax * i / 100'000.0;
    const long double x = std::sqrt(static_cast<long double>(x2));
    EXPECT_LT(std::abs(sinc_cos(x2).sinc - std::sin(x) / x), 2e-16L) << x2;
    EXPECT_LT(std::abs(sinc_cos(x2).cos - std::cos(x)), 2e-16L) << x2;
  }
}

TEST(SinCos, IsTheSameEverywhere) {
  const auto [sin, cos] = sin_cos(1.25);
  EXPECT_EQ(sin, 0x1.e5e14fe11418cp-1);
  EXPECT_EQ(cos, 0x1.42e3dd88bd952p-2);
}

}  // namespace peerd::sin_cos_test
