#include "peerd/peer/motion/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/peerd/path_checks.hpp"

namespace peerd::motion::drive_test {

constexpr PathTimes kTimes{-5.0, 120.0};
const Vec3 kStart(20, 0.5, 1.75);

TEST(Drive, IsDeterminedBySeedAndNumber) {
  const auto one = drive({}, 7, 3, kStart, kTimes);
  EXPECT_TRUE(path_checks::same(one, drive({}, 7, 3, kStart, kTimes)));
  EXPECT_FALSE(path_checks::same(one, drive({}, 8, 3, kStart, kTimes)));
  EXPECT_FALSE(path_checks::same(one, drive({}, 7, 4, kStart, kTimes)));
}

struct Lane {
  const char* name;
  Vec3 start, begin, ahead;
};
class DriveLanes : public testing::TestWithParam<Lane> {};
TEST_P(DriveLanes, BeginsInTheNearestOne) {
  const Knot k = drive({}, 1, 0, GetParam().start, kTimes).front();
  EXPECT_LT((k.state.position - GetParam().begin).norm(), 1e-12) << k.state.position.transpose();
  EXPECT_LT((k.state.velocity.normalized() - GetParam().ahead).norm(), 1e-12);
  EXPECT_EQ(k.t_s, -5.0);
}
// Streets run at x, z = 0, 60, .., 240; right of +x is +z.
INSTANTIATE_TEST_SUITE_P(Table, DriveLanes,
                         testing::Values(Lane{"ToPlusX", {20, 0, 1}, {20, 0, 1.75}, {1, 0, 0}},
                                         Lane{"ToMinusX", {40, 2, 59}, {40, 2, 58.25}, {-1, 0, 0}},
                                         Lane{"ToPlusZ", {118, 0, 90}, {118.25, 0, 90}, {0, 0, 1}},
                                         Lane{"ToMinusZ", {121, 0, 90}, {121.75, 0, 90}, {0, 0, -1}},
                                         Lane{"NotBeyondTheLastCrossing", {250, 0, 1}, {225, 0, 1.75}, {1, 0, 0}},
                                         Lane{"NorTheFirst", {-90, 0, -1}, {15, 0, -1.75}, {-1, 0, 0}}),
                         [](const auto& c) { return std::string(c.param.name); });

// The distance of a place from the nearest middle of a street.
double off_street_m(const Vec3& p) {
  const auto off = [](double x) { return std::abs(x - 60.0 * std::round(x / 60.0)); };
  return std::min(off(p.x()), off(p.z()));
}

class DriveSpeeds : public testing::TestWithParam<double> {};
TEST_P(DriveSpeeds, KeepsToItsStreetsAndToWhatTyresCanDo) {
  DriveSettings s;
  s.speed_m_s = GetParam();
  double turned = 0.0;
  for (std::size_t n = 0; n < 40; ++n) {
    const MotionPath path(drive(s, 1, n, kStart, kTimes));
    double yaw_before = 0.0;
    for (double t = -5.0; t < 120.0; t += 0.01) {
      const KinematicState k = path.sample(t);
      const Vec3 &v = k.velocity, &a = k.acceleration;
      const double speed = v.norm();
      SCOPED_TRACE(testing::Message() << "car " << n << " at " << t << ": " << k.position.transpose());
      ASSERT_LE(a.norm(), 1.45 * s.acceleration_m_s2);
      ASSERT_LE(std::abs(a.cross(v).y()) / speed, 1.03 * s.acceleration_m_s2) << "sideways";
      ASSERT_LE(speed, 1.2 * s.speed_m_s);
      ASSERT_GT(speed, 1.0);
      ASSERT_LE(std::abs(k.angular_velocity_body.y()), speed / 4.9) << "its turning circle";
      ASSERT_LT(path_checks::angle_from_velocity(k), 0.005);
      ASSERT_LE(off_street_m(k.position), 5.0) << "3.5 m are half a street; a corner is cut or taken wide";
      ASSERT_TRUE(k.position.x() > -4 && k.position.x() < 244 && k.position.z() > -4 && k.position.z() < 244);
      if (t > -5.0) turned += std::abs(std::remainder(std::atan2(v.x(), v.z()) - yaw_before, 2 * M_PI));
      yaw_before = std::atan2(v.x(), v.z());
    }
  }
  EXPECT_GT(turned / 40.0, 3.0 * 0.5 * M_PI) << "some corners each";
}
INSTANTIATE_TEST_SUITE_P(Table, DriveSpeeds, testing::Values(6.0, 13.0, 25.0));

// On the straight, in the middle of a block, a car is on the right-hand side, a lane's width from the street's middle.
TEST(Drive, KeepsToTheRight) {
  int seen = 0;
  for (std::size_t n = 0; n < 40; ++n) {
    for (const Knot& k : drive({}, 1, n, kStart, kTimes)) {
      const Vec3 &p = k.state.position, ahead = k.state.velocity.normalized();
      const bool along_x = std::abs(ahead.x()) > 0.9;
      const double along = along_x ? p.x() : p.z(), aside = along_x ? ahead.x() * p.z() : -ahead.z() * p.x();
      if (!along_x && std::abs(ahead.z()) <= 0.9) continue;
      if (std::abs(along - 60.0 * std::floor(along / 60.0) - 30.0) > 3.0) continue;
      EXPECT_NEAR(aside - 60.0 * std::round(aside / 60.0), 1.75, 0.1) << n << " at " << k.t_s;
      ++seen;
    }
  }
  EXPECT_GT(seen, 500);
}

TEST(Drive, IsSmooth) {
  const MotionPath path(drive({}, 1, 5, kStart, kTimes));
  path_checks::expect_continuous(path);
  path_checks::expect_derivatives(path, -5.0, 120.0, 3000);
}

}  // namespace peerd::motion::drive_test
