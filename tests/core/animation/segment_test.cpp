#include "core/animation/segment.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace peerd::animation::segment_test {

TEST(Segment, MovesAtItsVelocityFromItsBeginning) {
  Segment s;
  s.begin_s = 2;
  s.is_constant = false;
  s.position = {1, 0, 0};
  s.velocity = {0, 3, 0};
  EXPECT_EQ(s.position_at(2), Vec3(1, 0, 0));
  EXPECT_EQ(s.position_at(4), Vec3(1, 6, 0));
}

TEST(Segment, TurnsInItsOwnFrame) {
  Segment s;
  s.begin_s = 0;
  s.is_constant = false;
  s.orientation = Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()));
  s.angular_velocity_body = {0, std::numbers::pi, 0};
  const Quat expected = s.orientation * Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY()));
  EXPECT_LT(angle_between(s.orientation_at(0.5), expected), 1e-14);
}

TEST(Segment, ThatIsConstantHasAnyTimeAndIgnoresItsBeginning) {
  Segment s;  // begins at -inf, from where no difference can be taken
  s.position = {1, 2, 3};
  EXPECT_EQ(s.position_at(5), Vec3(1, 2, 3));
  EXPECT_EQ(s.orientation_at(5).coeffs(), Quat::Identity().coeffs());
}

}  // namespace peerd::animation::segment_test
