#include "core/kinematics.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace peerd::kinematics_test {

KinematicState sample() {
  KinematicState s;
  s.position = {1, 2, 3};
  s.velocity = {4, 0, -2};
  s.acceleration = {0, -10, 1};
  s.orientation = quat_exp({0.4, 0.1, -0.2});
  s.angular_velocity_body = {0, 2, 0};
  return s;
}

TEST(Advance, FollowsEquations41And42) {
  const KinematicState s = advance(sample(), 2.0);
  EXPECT_EQ(s.position, Vec3(9, -18, 1));
  EXPECT_EQ(s.velocity, Vec3(4, -20, 0));
  EXPECT_EQ(s.acceleration, Vec3(0, -10, 1));
}

TEST(Advance, TurnsInTheBodyFrame) {
  const KinematicState base = sample();
  const KinematicState s = advance(base, 0.25);
  EXPECT_NEAR(angle_between(base.orientation, s.orientation), 0.5, 1e-15);
  EXPECT_LT((s.orientation * Vec3(0, 1, 0) - base.orientation * Vec3(0, 1, 0)).norm(), 1e-15);
}

TEST(Advance, ByZeroChangesNothing) {
  const KinematicState base = sample();
  const KinematicState s = advance(base, 0.0);
  EXPECT_EQ(s.position, base.position);
  EXPECT_EQ(s.velocity, base.velocity);
  EXPECT_LT(angle_between(s.orientation, base.orientation), 1e-15);
}

TEST(Advance, GoesBackAsItCame) {
  const KinematicState base = sample();
  const KinematicState s = advance(advance(base, 3.0), -3.0);
  EXPECT_LT((s.position - base.position).norm(), 1e-13);
  EXPECT_LT(angle_between(s.orientation, base.orientation), 1e-14);
}

TEST(Advance, KeepsTheQuaternionUnitAfterMillionsOfTurns) {
  const KinematicState s = advance(sample(), 1e7);
  EXPECT_NEAR(s.orientation.norm(), 1.0, 1e-15);
}

TEST(AtRest, StaysWhereItIs) {
  const Pose pose{{1, 2, 3}, quat_exp({0, 0, std::numbers::pi / 3})};
  const KinematicState s = advance(at_rest(pose), 100.0);
  EXPECT_EQ(s.position, pose.position);
  EXPECT_EQ(s.orientation.coeffs(), pose.orientation.coeffs());
}

}  // namespace peerd::kinematics_test
