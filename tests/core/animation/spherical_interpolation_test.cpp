#include "core/animation/spherical_interpolation.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace peerd::animation::spherical_interpolation_test {

constexpr double kPi = std::numbers::pi;

TEST(QuatFromAxisAngle, NeedsNoUnitAxis) {
  const Quat q = quat_from_axis_angle({0, 0, 10}, kPi / 2);
  EXPECT_LT((q * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(quat_from_axis_angle(Vec3::Zero(), 1.0).coeffs(), Quat::Identity().coeffs());
}

TEST(RotationBetween, IsTheShorterWayAndLeadsThere) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto quat = [&] { return Quat(number(random), number(random), number(random), number(random)).normalized(); };
  for (int i = 0; i < 1000; ++i) {
    const Quat a = quat(), b = quat();
    const Vec3 r = rotation_between(a, b);
    EXPECT_LE(r.norm(), kPi + 1e-14);
    EXPECT_NEAR(r.norm(), angle_between(a, b), 1e-7);
    EXPECT_LT(angle_between(rotated_in_body_frame(a, r), b), 1e-7);
    EXPECT_EQ(rotation_between(a, a).norm() < 1e-7, true);
  }
}

// Half turns are written with the digits of pi that binary32 has; whichever side of pi they are rounded to, they go on.
TEST(RotationBetween, OfHalfATurnInBinary32GoesOn) {
  const auto key = [](double angle_rad) { return quat_from_axis_angle({0, 1, 0}, double(float(angle_rad))); };
  for (const double first : {0.0, 1.5707963, 3.14159265, 0.78539816, -3.14159265}) {
    for (const double half : {3.14159265, 3.14159265358979}) {
      EXPECT_NEAR(rotation_between(key(first), key(first + half)).y(), kPi, 3e-7) << first;
      EXPECT_NEAR(rotation_between(key(first), key(first - half)).y(), -kPi, 3e-7) << first;
    }
  }
  EXPECT_NEAR(rotation_between(key(0), key(3.14159)).y(), kPi, 1e-5);
  EXPECT_NEAR(rotation_between(key(0), key(3.1416)).y(), -kPi, 1e-5) << "more than half a turn";
  EXPECT_NEAR(rotation_between(key(0), key(3.5)).y(), 3.5 - 2 * kPi, 1e-6);
}

TEST(RotationBetween, OfOppositeSignsOfOneOrientationIsNone) {
  const Quat q = quat_from_axis_angle({1, 2, 3}, 1.0);
  EXPECT_LT(rotation_between(q, Quat(-q.coeffs())).norm(), 1e-15);
}

struct Case {
  const char* name;
  Vec3 p, q;
  double fraction;
  Vec3 expected;
};
class Slerp : public testing::TestWithParam<Case> {};
TEST_P(Slerp, IsOnTheShorterArc) {
  const Case& c = GetParam();
  EXPECT_LT((slerp(c.p, c.q, c.fraction) - c.expected).norm(), 1e-14);
}
const double kHalf = std::sqrt(0.5);
INSTANTIATE_TEST_SUITE_P(Table, Slerp,
                         testing::Values(Case{"Begin", Vec3::UnitX(), Vec3::UnitY(), 0, Vec3::UnitX()},
                                         Case{"Middle", Vec3::UnitX(), Vec3::UnitY(), 0.5, Vec3(kHalf, kHalf, 0)},
                                         Case{"End", Vec3::UnitX(), Vec3::UnitY(), 1, Vec3::UnitY()},
                                         Case{"LengthsAreInterpolated", Vec3(1, 0, 0), Vec3(0, 3, 0), 0.5,
                                              2 * Vec3(kHalf, kHalf, 0)},
                                         Case{"LinearFromZero", Vec3::Zero(), Vec3(0, 4, 0), 0.25, Vec3(0, 1, 0)}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Slerp, OfOppositePointsStaysOnTheSphere) {
  const Vec3 middle = slerp(Vec3::UnitX(), -Vec3::UnitX(), 0.5);
  EXPECT_NEAR(middle.norm(), 1.0, 1e-14);
  EXPECT_NEAR(middle.dot(Vec3::UnitX()), 0.0, 1e-14);
}

}  // namespace peerd::animation::spherical_interpolation_test
