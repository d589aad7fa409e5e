#include "peerd/peer/motion/walk.hpp"

#include <gtest/gtest.h>

#include "tests/peerd/path_checks.hpp"

namespace peerd::motion::walk_test {

WalkSettings square() {
  WalkSettings s;
  s.x_min_m = -10, s.z_min_m = -10, s.x_max_m = 10, s.z_max_m = 15;
  return s;
}
constexpr PathTimes kTimes{-5.0, 60.0};

TEST(Walk, IsDeterminedBySeedAndNumber) {
  const auto one = walk(square(), 7, 3, Vec3::Zero(), kTimes);
  EXPECT_TRUE(path_checks::same(one, walk(square(), 7, 3, Vec3::Zero(), kTimes)));
  EXPECT_FALSE(path_checks::same(one, walk(square(), 8, 3, Vec3::Zero(), kTimes)));
  EXPECT_FALSE(path_checks::same(one, walk(square(), 7, 4, Vec3::Zero(), kTimes)));
  const auto longer = walk(square(), 7, 3, Vec3::Zero(), {-5.0, 90.0});
  EXPECT_TRUE(path_checks::same(one, {longer.begin(), longer.begin() + static_cast<std::ptrdiff_t>(one.size())}));
}

TEST(Walk, CoversItsTimesFromItsPlace) {
  const auto knots = walk(square(), 1, 0, Vec3(3, 1.5, -2), kTimes);
  EXPECT_EQ(knots.front().t_s, -5.0);
  EXPECT_EQ(knots.front().state.position, Vec3(3, 1.5, -2));
  EXPECT_GE(knots.back().t_s, 60.0);
  for (const Knot& k : knots) ASSERT_EQ(k.state.position.y(), 1.5);
}

// All walkers stay inside from all starting places, the corners too.
TEST(Walk, StaysInItsArea) {
  WalkSettings s = square();
  for (const double speed : {1.3, 3.0}) {
    s.speed_m_s = speed;
    for (std::size_t n = 0; n < 200; ++n) {
      const Vec3 start(n % 2 == 0 ? -9 : 9, 0, n % 4 < 2 ? -9 : 14);
      for (const Knot& k : walk(s, 1, n, n < 100 ? start : Vec3(0, 0, 0), kTimes)) {
        const Vec3& p = k.state.position;
        ASSERT_TRUE(p.x() >= -10 && p.x() <= 10 && p.z() >= -10 && p.z() <= 15) << n << " at " << k.t_s << ": " << p;
      }
    }
  }
}

TEST(Walk, IsWhatPeopleDo) {
  double sum = 0.0, samples = 0.0, standing = 0.0;
  for (std::size_t n = 0; n < 100; ++n) {
    for (const Knot& k : walk(square(), 2, n, Vec3::Zero(), {-5.0, 300.0})) {
      const double speed = k.state.velocity.norm();
      ASSERT_LE(speed, 2.5);
      ASSERT_LE(k.state.acceleration.norm(), 5.0) << "a turn on the heel at most";
      ASSERT_LE(k.state.angular_velocity_body.norm(), 1.5 + 1e-12);
      if (speed < 0.05) standing += 1.0;
      if (speed > 0.5) sum += speed, samples += 1.0;
    }
  }
  EXPECT_NEAR(sum / samples, 1.25, 0.1) << "those who walk; borders slow them down";
  EXPECT_GT(standing / (standing + samples), 0.03);
  EXPECT_LT(standing / (standing + samples), 0.25);
}

TEST(Walk, LooksWhereItGoesAndIsSmooth) {
  const MotionPath path(walk(square(), 1, 5, Vec3::Zero(), kTimes));
  path_checks::expect_continuous(path);
  path_checks::expect_derivatives(path, -5.0, 60.0, 3000);
  for (double t = -5.0; t < 60.0; t += 0.013) {
    const KinematicState s = path.sample(t);
    if (s.velocity.norm() > 0.3) {
      ASSERT_LT(path_checks::angle_from_velocity(s), 0.02) << t;
    }
  }
}

TEST(Walk, NobodyStandsWithoutStops) {
  WalkSettings s = square();
  s.stop_every_s = 0.0;
  s.x_min_m = s.z_min_m = -1000, s.x_max_m = s.z_max_m = 1000;
  for (const Knot& k : walk(s, 1, 0, Vec3::Zero(), kTimes)) ASSERT_GT(k.state.velocity.norm(), 0.4) << k.t_s;
}

}  // namespace peerd::motion::walk_test
