#include "peerd/peer/motion/street_route.hpp"

#include <gtest/gtest.h>

namespace peerd::motion::street_route_test {

TEST(StreetRoute, IsOneSmoothLineOfUnitSpeed) {
  const DriveSettings settings;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed, 0);
    StreetRoute route(settings, Vec2(10.0, 3.0), random);
    constexpr double kStep_m = 0.25;
    for (double s = 0.0; s < 2000.0; s += kStep_m) {
      const auto here = route.at(s), next = route.at(s + kStep_m);
      EXPECT_NEAR(here.direction.norm(), 1.0, 1e-9);
      EXPECT_NEAR((next.position - here.position).norm(), kStep_m, 1e-3) << "seed " << seed << " at " << s << " m";
      EXPECT_GT(here.direction.dot(next.direction), 0.99) << "seed " << seed << " at " << s << " m";
    }
  }
}

TEST(StreetRoute, StaysOnTheGridOfStreets) {
  const DriveSettings settings{.blocks = 2, .origin_x_m = -50.0};
  Random random(3, 1);
  StreetRoute route(settings, Vec2(0.0, 0.0), random);
  const double size_m = settings.block_m * settings.blocks, room_m = settings.lane_m + 1e-6;
  for (double s = 0.0; s < 3000.0; s += 1.0) {
    const Vec2 p = route.at(s).position;
    EXPECT_GE(p.x(), settings.origin_x_m - room_m);
    EXPECT_LE(p.x(), settings.origin_x_m + size_m + room_m);
    EXPECT_GE(p.y(), -room_m);
    EXPECT_LE(p.y(), size_m + room_m);
  }
}

// The speed that is safe at s leaves enough way to brake to the speed that is safe further on.
TEST(StreetRoute, ASafeSpeedCanBeBrakedFrom) {
  const DriveSettings settings;
  Random random(7, 2);
  StreetRoute route(settings, Vec2(0.0, 0.0), random);
  constexpr double kBraking = 2.0, kSideways = 2.0, kMax = 15.0;
  bool slows = false;
  for (double s = 0.0; s < 1000.0; s += 1.0) {
    const double here = route.safe_speed(s, kBraking, kSideways, kMax);
    const double next = route.safe_speed(s + 1.0, kBraking, kSideways, kMax);
    EXPECT_LE(here, kMax);
    EXPECT_GT(here, 0.0);
    EXPECT_LE(here * here, next * next + 2.0 * kBraking * 1.0 + 1e-6) << s;
    slows = slows || here < kMax;
  }
  EXPECT_TRUE(slows) << "it turns somewhere";
}

}  // namespace peerd::motion::street_route_test
