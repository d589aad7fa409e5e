#include "core/scene/rotation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace peerd::vrml::rotation_test {

Quat turned(float x, float y, float z, float angle) { return to_quat(std::array{x, y, z, angle}); }

TEST(ToQuat, MeetsTheLibrarysSineToTheLastPlaces) {
  for (float angle = -6.3f; angle < 6.3f; angle += 0.001f) {
    const Quat q = turned(0, 0, 1, angle);
    EXPECT_NEAR(q.z(), std::sin(0.5 * angle), 3e-16) << angle;
    EXPECT_NEAR(q.w(), std::cos(0.5 * angle), 3e-16) << angle;
  }
}

TEST(ToQuat, TakesManyTurns) {
  const Quat q = turned(1, 0, 0, 1000.0f);
  EXPECT_NEAR(q.x(), std::sin(500.0), 1e-13);
  EXPECT_NEAR(turned(1, 0, 0, 3e38f).norm(), 1.0, 1e-15);
}

TEST(ToQuat, NormalisesTheAxis) {
  using Axis = std::array<float, 4>;
  for (const Axis& axis : {Axis{3, 4, 12, 1}, Axis{1e-40f, 2e-40f, 0, 1}, Axis{3e38f, 3e38f, 3e38f, 1}}) {
    const Quat q = to_quat(axis);
    EXPECT_NEAR(q.norm(), 1.0, 1e-15);
    EXPECT_NEAR(q.w(), std::cos(0.5), 1e-15);
  }
}

TEST(ToQuat, IsIdentityForNoAngleAndNoAxis) {
  EXPECT_EQ(turned(0, 0, 0, 0).coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(turned(1, 2, 3, 0).coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(turned(0, 0, 0, 1).coeffs(), Quat::Identity().coeffs());
}

// The test compares bits, not nearness: two peers with different C libraries must get these.
TEST(ToQuat, IsTheSameEverywhere) {
  const Quat q = turned(1, 2, 3, 0.5f);
  EXPECT_EQ(q.w(), 0x1.f01549f7deea1p-1);
  EXPECT_EQ(q.x(), 0x1.0ed56828e058p-4);
  EXPECT_EQ(q.y(), 0x1.0ed56828e058p-3);
  EXPECT_EQ(q.z(), 0x1.96401c3d5084p-3);
}

}  // namespace peerd::vrml::rotation_test
