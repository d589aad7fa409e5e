#include "core/animation/interpolator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/animation/spherical_interpolation.hpp"

namespace peerd::animation::interpolator_test {

using Floats = std::vector<float>;
using LongVec = Eigen::Matrix<long double, 3, 1>;
using LongQuat = Eigen::Quaternion<long double>;

Value at(InterpolatorType type, const Floats& key, const Floats& key_value, double fraction) {
  Value out;
  evaluate(type, {key, key_value}, fraction, out);
  return out;
}

double scalar(const Floats& key, const Floats& key_value, double fraction) {
  return at(InterpolatorType::kScalar, key, key_value, fraction).scalar();
}

struct Case {
  const char* name;
  Floats key, key_value;
  double fraction;
  double expected;
};
class Scalar : public testing::TestWithParam<Case> {};
TEST_P(Scalar, IsPiecewiseLinear) {
  const Case& c = GetParam();
  EXPECT_EQ(scalar(c.key, c.key_value, c.fraction), c.expected);
}
INSTANTIATE_TEST_SUITE_P(  // 4.6.8
    Clause468, Scalar,
    testing::Values(Case{"FirstValueBeforeTheFirstKey", {0.25, 1}, {3, 5}, -7.0, 3.0},
                    Case{"FirstValueAtTheFirstKey", {0.25, 1}, {3, 5}, 0.25, 3.0},
                    Case{"LastValueAtTheLastKey", {0, 0.5}, {3, 5}, 0.5, 5.0},
                    Case{"LastValueAfterTheLastKey", {0, 0.5}, {3, 5}, 1e300, 5.0},
                    Case{"LinearBetween", {0, 0.5, 1}, {0, 10, 0}, 0.125, 2.5},
                    Case{"LinearBetweenFalling", {0, 0.5, 1}, {0, 10, 0}, 0.75, 5.0},
                    Case{"KeysNeedNotBeIn01", {-4, 4}, {0, 8}, 2.0, 6.0}, Case{"OneKey", {0.5}, {9}, 0.1, 9.0},
                    Case{"DoubleKeyTakesTheLimitFromTheRight", {0, 0.5, 0.5, 1}, {0, 1, 5, 6}, 0.5, 5.0},
                    Case{"ThreefoldKeyTakesTheLast", {0, 0.5, 0.5, 0.5, 1}, {0, 1, 2, 5, 6}, 0.5, 5.0},
                    Case{"DoubleFirstKeyTakesTheFirst", {0, 0, 1}, {1, 2, 3}, 0.0, 1.0},
                    Case{"DoubleLastKeyTakesTheLast", {0, 1, 1}, {1, 2, 3}, 1.0, 3.0},
                    Case{"NanTakesTheFirst", {0, 1}, {4, 5}, std::numeric_limits<double>::quiet_NaN(), 4.0},
                    Case{"FewerValuesThanKeys", {0, 0.5, 1}, {4, 5}, 1.0, 5.0},
                    Case{"MoreValuesThanKeys", {0, 1}, {4, 5, 6}, 1.0, 5.0}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(Interpolator, ComesFromBothSidesOfAJump) {
  const Floats key{0, 0.5, 0.5, 1};
  EXPECT_NEAR(scalar(key, {0, 1, 5, 6}, std::nextafter(0.5, 0.0)), 1.0, 1e-15);
  EXPECT_NEAR(scalar(key, {0, 1, 5, 6}, std::nextafter(0.5, 1.0)), 5.0, 1e-14);
}

TEST(Interpolator, SendsNothingWithoutKeysOrValues) {
  EXPECT_FALSE(sends(InterpolatorType::kScalar, {}));
  EXPECT_FALSE(sends(InterpolatorType::kPosition, {Floats{0}, Floats{1, 2}}));
  EXPECT_FALSE(sends(InterpolatorType::kCoordinate, {Floats{0, 1}, Floats{1, 2, 3}}));
  EXPECT_TRUE(sends(InterpolatorType::kOrientation, {Floats{0, 1}, Floats{0, 1, 0, 1}}));
}

TEST(Interpolator, TakesUnsortedKeysWithoutHarm) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> number(-1, 2);
  for (int n = 1; n < 40; ++n) {
    Floats key(n), value(n);
    for (float& k : key) k = number(random);
    for (float& v : value) v = number(random);
    if (n > 3) key[n / 2] = std::numeric_limits<float>::quiet_NaN();
    for (double f = -1.5; f < 2.5; f += 0.03125) {
      const double v = scalar(key, value, f);
      EXPECT_GE(v, -1.0) << n << ' ' << f;
      EXPECT_LE(v, 2.0) << n << ' ' << f;
    }
  }
}

TEST(Interpolator, PositionIsLinear) {
  const Value v = at(InterpolatorType::kPosition, {0, 1}, {0, 0, 0, 4, -8, 2}, 0.25);
  EXPECT_EQ(v.type, FieldType::kVec3);
  EXPECT_EQ(v.vec3(), Vec3(1, -2, 0.5));
}

// 6.13: "an integer multiple of the number of key frames": so many vectors each.
TEST(Interpolator, CoordinatesComeAsManyAsTheKeysShare) {
  const Floats key_value{0, 0, 0, 1, 1, 1, /**/ 2, 4, 8, 3, 3, 3, /* not used */ 9, 9, 9};
  const Value v = at(InterpolatorType::kCoordinate, {0, 1}, key_value, 0.5);
  EXPECT_EQ(v.type, FieldType::kVec3s);
  EXPECT_EQ(v.numbers, (Floats{1, 2, 4, 2, 2, 2}));
}

TEST(Interpolator, NormalsGoAlongTheArc) {  // 6.31
  const Value v = at(InterpolatorType::kNormal, {0, 1}, {1, 0, 0, 0, 1, 0}, 1.0 / 3.0);
  ASSERT_EQ(v.numbers.size(), 3u);
  EXPECT_NEAR(v.numbers[0], std::cos(std::numbers::pi / 6), 1e-7);
  EXPECT_NEAR(v.numbers[1], std::sin(std::numbers::pi / 6), 1e-7);
}

struct ColorCase {
  const char* name;
  Vec3 a, b;
  double fraction;
  Vec3 expected;
};
class Color : public testing::TestWithParam<ColorCase> {};
TEST_P(Color, IsLinearInHsv) {
  const ColorCase& c = GetParam();
  const Floats values{float(c.a[0]), float(c.a[1]), float(c.a[2]), float(c.b[0]), float(c.b[1]), float(c.b[2])};
  const Value v = at(InterpolatorType::kColor, {0, 1}, values, c.fraction);
  EXPECT_EQ(v.type, FieldType::kColor);
  EXPECT_LT((v.vec3() - c.expected).norm(), 1e-7) << v.vec3().transpose();
}
INSTANTIATE_TEST_SUITE_P(  // 6.10
    Clause610, Color,
    testing::Values(ColorCase{"RedToGreenIsYellow", {1, 0, 0}, {0, 1, 0}, 0.5, {1, 1, 0}},
                    ColorCase{"RedToBlueGoesByMagenta", {1, 0, 0}, {0, 0, 1}, 0.5, {1, 0, 1}},
                    ColorCase{"BlueToRedGoesByMagenta", {0, 0, 1}, {1, 0, 0}, 0.25, {0.5, 0, 1}},
                    ColorCase{"ComplementsGoUpwards", {1, 0, 0}, {0, 1, 1}, 0.5, {0.5, 1, 0}},
                    ColorCase{"GreyTakesTheOthersHue", {1, 1, 1}, {0, 0, 1}, 0.5, {0.5, 0.5, 1}},
                    ColorCase{"BlackToRedIsDarkRed", {0, 0, 0}, {1, 0, 0}, 0.5, {0.5, 0.25, 0.25}},
                    ColorCase{"Greys", {0.25, 0.25, 0.25}, {0.75, 0.75, 0.75}, 0.5, {0.5, 0.5, 0.5}},
                    ColorCase{"FirstIsExact", {0.1, 0.7, 0.3}, {1, 0, 0}, 0.0, {0.1, 0.7, 0.3}},
                    ColorCase{"LastIsExact", {0.1, 0.7, 0.3}, {0.3, 0.9, 0.2}, 1.0, {0.3, 0.9, 0.2}}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(Interpolator, ColorsStayColors) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 20000; ++i) {
    Floats v(6);
    for (float& x : v) x = unit(random);
    const Vec3 rgb = at(InterpolatorType::kColor, {0, 1}, v, unit(random)).vec3();
    EXPECT_GE(rgb.minCoeff(), 0.0);
    EXPECT_LE(rgb.maxCoeff(), 1.0);
  }
}

LongQuat long_quat(const float* r) {
  const LongVec axis = LongVec(r[0], r[1], r[2]).normalized();
  const long double half = 0.5L * r[3];
  const LongVec v = std::sin(half) * axis;
  return {std::cos(half), v.x(), v.y(), v.z()};
}

double distance(const Quat& a, const LongQuat& b) {
  const LongQuat d = a.cast<long double>().conjugate() * b;
  return static_cast<double>(2.0L * std::atan2(d.vec().norm(), std::abs(d.w())));
}

// The oracle is the slerp of the textbook, in long double. It shares nothing with ours, which turns by an axis and an
// angle.
TEST(Orientation, MeetsSlerpInLongDouble) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> number(-1, 1);
  double worst = 0.0;
  for (int i = 0; i < 100000; ++i) {
    Floats v(8);
    for (float& x : v) x = number(random);
    v[3] *= 3.1f;
    v[7] *= 3.1f;
    if (i % 4 == 1) {  // nearly the same
      for (int k = 0; k < 4; ++k) v[4 + k] = v[k] + 1e-5f * v[4 + k];
    }
    const double f = 0.5 * (number(random) + 1.0);
    const LongQuat a = long_quat(v.data());
    LongQuat b = long_quat(v.data() + 4);
    long double cosine = a.dot(b);
    if (cosine < 0.0L) {
      b.coeffs() = -b.coeffs();
      cosine = -cosine;
    }
    if (cosine < 1e-4L) continue;  // opposite: either way is right
    const long double angle = std::atan2((b.coeffs() - a.coeffs() * cosine).norm(), cosine);
    LongQuat truth = a;
    if (angle > 0.0L) {
      truth.coeffs() = (std::sin((1.0L - f) * angle) * a.coeffs() + std::sin(f * angle) * b.coeffs()) / std::sin(angle);
    }
    const Quat ours = at(InterpolatorType::kOrientation, {0, 1}, v, f).quat();
    worst = std::max(worst, distance(ours, truth));
    ASSERT_NEAR(ours.norm(), 1.0, 4e-16);
  }
  EXPECT_LT(worst, 3e-15);
}

TEST(Orientation, TakesSomeHalfTurnBetweenOpposites) {  // undefined by 6.32
  for (const double f : {0.25, 0.5, 0.75}) {
    const Quat q = at(InterpolatorType::kOrientation, {0, 1}, {0, 0, 1, 0, 0, 1, 0, 3.14159265f}, f).quat();
    EXPECT_NEAR(q.norm(), 1.0, 1e-15);
    EXPECT_NEAR(std::abs(q.y()), std::sin(f * std::numbers::pi / 2.0), 1e-7);
  }
}

TEST(Orientation, IsTheSameEverywhere) {
  const Quat q = at(InterpolatorType::kOrientation, {0, 1}, {1, 2, 3, 0.5f, 3, 1, 0, 2.0f}, 0.3).quat();
  EXPECT_EQ(q.w(), 0x1.d47784cf9dc63p-1);
  EXPECT_EQ(q.x(), 0x1.4a6f5378f2409p-2);
  EXPECT_EQ(q.y(), 0x1.866744932c495p-3);
  EXPECT_EQ(q.z(), 0x1.32344a77c69dp-3);
}

}  // namespace peerd::animation::interpolator_test
