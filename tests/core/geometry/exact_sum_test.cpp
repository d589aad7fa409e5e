#include "core/geometry/exact_sum.hpp"

#include <gtest/gtest.h>

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "core/geometry/plane_point.hpp"

namespace peerd::exact_sum_test {

using Rational = boost::multiprecision::cpp_rational;

constexpr float kMax = std::numeric_limits<float>::max(), kTiny = std::numeric_limits<float>::denorm_min();

TEST(ExactSum, OfNothingIsZero) {
  EXPECT_EQ(ExactSum{}.sign(), 0);
  EXPECT_EQ(ExactSum{}.value(), 0.0);
}

TEST(ExactSum, KeepsTheLeastBesideTheLargest) {
  ExactSum sum;
  for (int i = 0; i < 1000; ++i) sum.add(kMax, kMax);
  sum.add(-kTiny, kTiny);
  EXPECT_EQ(sum.sign(), 1);
  for (int i = 0; i < 1000; ++i) sum.subtract(kMax, kMax);
  EXPECT_EQ(sum.sign(), -1);
  EXPECT_EQ(sum.value(), -0x1p-298);
  sum.add(kTiny, kTiny);
  EXPECT_EQ(sum.sign(), 0);
}

float random_float(std::mt19937& rng, int exponents) {
  const float significand = std::uniform_real_distribution(-1.0F, 1.0F)(rng);
  return std::ldexp(significand, std::uniform_int_distribution(-exponents, exponents)(rng));
}

TEST(ExactSum, AgreesWithRationalNumbers) {
  std::mt19937 rng(1);
  for (int round = 0; round < 2000; ++round) {
    ExactSum sum;
    Rational expected = 0;
    const int exponents = round % 2 == 0 ? 3 : 127;
    for (int i = 0; i < 8; ++i) {
      const float a = random_float(rng, exponents), b = random_float(rng, exponents);
      sum.add(a, b), expected += Rational(a) * Rational(b);
      const float c = random_float(rng, exponents), d = i % 2 == 0 ? b : random_float(rng, exponents);
      sum.subtract(c, d), expected -= Rational(c) * Rational(d);
    }
    EXPECT_EQ(sum.sign(), expected.sign());
    EXPECT_LE(abs(Rational(sum.value()) - expected), abs(expected) * Rational(0x1p-52));
  }
}

int exact_turn_of(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const Rational x = c.x, y = c.y;
  return Rational((Rational(a.x) - x) * (Rational(b.y) - y) - (Rational(a.y) - y) * (Rational(b.x) - x)).sign();
}

TEST(Turn, AgreesWithRationalNumbers) {
  std::mt19937 rng(2);
  for (int round = 0; round < 20000; ++round) {
    const int exponents = std::array{0, 2, 20, 127}[static_cast<std::size_t>(round % 4)];
    const PlanePoint a{random_float(rng, exponents), random_float(rng, exponents)};
    const PlanePoint b{random_float(rng, exponents), random_float(rng, exponents)};
    // The point is on the line through them but for rounding.
    const float t = std::uniform_real_distribution(-2.0F, 2.0F)(rng);
    const PlanePoint c{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
    if (!std::isfinite(c.x) || !std::isfinite(c.y)) continue;
    EXPECT_EQ(orient2d(a, b, c), exact_turn_of(a, b, c));
    EXPECT_EQ(orient2d(b, c, a), orient2d(a, b, c));
    EXPECT_EQ(orient2d(b, a, c), -orient2d(a, b, c));
  }
}

// The coordinates have a size that the differences in binary64 lose in part.
TEST(Turn, AgreesWithRationalNumbersWhereDifferencesAreRounded) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<float> tiny(-0x1p-17F, 0x1p-17F);
  for (int round = 0; round < 20000; ++round) {
    const float x = std::ldexp(static_cast<float>(1 + rng() % 99), 26),
                y = std::ldexp(static_cast<float>(1 + rng() % 99), 26);
    const float k = static_cast<float>(1 + rng() % 99);
    const PlanePoint a{x, y}, b{-k * x, -k * y}, c{tiny(rng), tiny(rng)};  // a and b on a line through the origin
    EXPECT_EQ(orient2d(a, b, c), exact_turn_of(a, b, c));
    EXPECT_EQ(orient2d(c, a, b), orient2d(a, b, c));
  }
}

TEST(Turn, OfThreePointsOfALine) {
  EXPECT_EQ(orient2d({0.1F, 0.1F}, {0.3F, 0.3F}, {0.7F, 0.7F}), 0);
  EXPECT_EQ(orient2d({0.1F, 0.1F}, {0.3F, std::nextafter(0.3F, 0.0F)}, {0.7F, 0.7F}), 1);
  EXPECT_EQ(orient2d({kMax, 0}, {-kMax, 0}, {kTiny, kTiny}), -1);
  EXPECT_EQ(orient2d({kMax, 0}, {-kMax, 0}, {kTiny, 0}), 0);
}

}  // namespace peerd::exact_sum_test
