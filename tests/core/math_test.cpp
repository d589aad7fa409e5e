#include "core/math.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace peerd::math_test {

TEST(QuatExp, IsTheRotationAboutItsDirection) {
  const Quat q = quat_exp({0, std::numbers::pi / 2, 0});
  EXPECT_LT((q * Vec3(1, 0, 0) - Vec3(0, 0, -1)).norm(), 1e-15);
}

TEST(QuatExp, HasNoBlowUpNearZero) {
  EXPECT_EQ(quat_exp(Vec3::Zero()).coeffs(), Quat::Identity().coeffs());
  for (double angle = 1e-300; angle < 1e-2; angle *= 10) {
    const Quat q = quat_exp({0, 0, angle});
    EXPECT_NEAR(q.z(), std::sin(angle / 2), 3e-15 * angle) << angle;
    EXPECT_NEAR(q.norm(), 1.0, 1e-15) << angle;
  }
}

TEST(QuatExp, GoesOnWhereItsFormChanges) {
  for (const double angle : {1.570, std::numbers::pi / 2, 1.571, 1.572}) {
    EXPECT_NEAR(quat_exp({angle, 0, 0}).x(), std::sin(angle / 2), 2e-16) << angle;
    EXPECT_NEAR(quat_exp({angle, 0, 0}).w(), std::cos(angle / 2), 2e-16) << angle;
  }
}

TEST(QuatExp, TurnsBackWithTheNegative) {
  const Vec3 rotation(0.3, -1.2, 2.0);
  EXPECT_LT((quat_exp(rotation) * quat_exp(-rotation)).vec().norm(), 1e-15);
}

TEST(AngleBetween, KnowsThatQAndMinusQAreOneOrientation) {
  const Quat a = quat_exp({0.1, 0.2, 0.3});
  const Quat b = a * quat_exp({0, 0.7, 0});
  EXPECT_NEAR(angle_between(a, b), 0.7, 1e-15);
  EXPECT_NEAR(angle_between(a, Quat(-b.coeffs())), 0.7, 1e-15);
  EXPECT_EQ(angle_between(a, b), angle_between(b, a));
}

TEST(AngleBetween, IsAccurateForTinyAndForStraightAngles) {
  const Quat a = quat_exp({0, 1, 0});
  EXPECT_NEAR(angle_between(a, a * quat_exp({1e-9, 0, 0})), 1e-9, 1e-16);
  EXPECT_NEAR(angle_between(a, a * quat_exp({std::numbers::pi, 0, 0})), std::numbers::pi, 1e-15);
}

}  // namespace peerd::math_test
