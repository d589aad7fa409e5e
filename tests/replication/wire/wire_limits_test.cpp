#include "replication/wire/wire_limits.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace peerd::replication::wire_limits_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

TEST(WireLimits, StateBeyondThemRestsAtTheNearestPlaceWithin) {
  KinematicState s;
  s.position = {2e12, -kInfinity, 5.0};
  s.velocity = {1.0, 2.0, 3.0};
  s.angular_velocity_body = {2.0 * kSpinMax, 0.0, 0.0};
  s.orientation = Quat(0.6, 0.0, 0.8, 0.0);
  ASSERT_FALSE(acceptable(s));
  const KinematicState out = at_rest_within_limits(s);
  EXPECT_TRUE(acceptable(out));
  EXPECT_EQ(out.position, Vec3(kMagnitudeMax, 0.0, 5.0));
  EXPECT_EQ(out.orientation.coeffs(), s.orientation.coeffs());
  EXPECT_TRUE(out.velocity.isZero(0.0));
  EXPECT_TRUE(out.angular_velocity_body.isZero(0.0));
}

TEST(WireLimits, OrientationThatIsNoneBecomesTheIdentity) {
  for (const Quat& none : {Quat(kNaN, 0.0, 0.0, 0.0), Quat(0.0, 0.0, 0.0, 0.0), Quat(0.0, 2.0, 0.0, 0.0)}) {
    KinematicState s;
    s.orientation = none;
    ASSERT_FALSE(acceptable(s));
    EXPECT_EQ(at_rest_within_limits(s).orientation.coeffs(), Quat::Identity().coeffs());
  }
}

}  // namespace
}  // namespace peerd::replication::wire_limits_test
