#include "replication/physics/laws/position_history.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::position_history_test {

using namespace test;

// Equations 4.3 to 4.6 of the thesis, corrected: they return a parabola unchanged, whatever the two intervals are.
TEST(PositionHistory, IsTheParabolaThroughThreePositions) {
  const KinematicState s = moving({1, 2, 3}, {4, -5, 6}, {-0.7, 0.8, 0.9});
  for (const auto& [d1, d2] : {std::pair{0.1, 0.1}, std::pair{0.05, 0.2}, std::pair{0.3, 0.01}}) {
    const PositionHistory h =
        position_history(s.position, advance(s, -d1).position, advance(s, -d1 - d2).position, d1, d2);
    EXPECT_FALSE(h.sharp_turn);
    EXPECT_LT((h.velocity - s.velocity).norm(), 1e-12);
    EXPECT_LT((h.acceleration - s.acceleration).norm(), 1e-10);
    // Equation 4.6 one interval later: (4 d1 + 2 d2) / (d1 + d2) is the factor of x0.
    const KinematicState next = advance(moving(s.position, h.velocity, h.acceleration), d1);
    const Vec3 by_factors = 2 * d1 * d1 / (d2 * (d1 + d2)) * advance(s, -d1 - d2).position -
                            (2 * d1 / d2 + 1) * advance(s, -d1).position + (4 * d1 + 2 * d2) / (d1 + d2) * s.position;
    EXPECT_LT((next.position - by_factors).norm(), 1e-11);
  }
}

struct Turn {
  const char* name;
  double degrees;  // at the middle position: 180 is straight on, 0 back
  bool sharp;
};
class Angle : public testing::TestWithParam<Turn> {};
TEST_P(Angle, ChoosesTheOrder) {
  const double a = GetParam().degrees * std::numbers::pi / 180.0;
  const Vec3 x2(-1, 0, 0), x1(0, 0, 0), x0(-std::cos(a), std::sin(a), 0);
  const Vec3 corner(3, -2, 7);  // only differences count
  const PositionHistory h = position_history(corner + x0, corner + x1, corner + x2, 0.5, 0.5);
  EXPECT_EQ(h.sharp_turn, GetParam().sharp);
  EXPECT_EQ(h.acceleration.isZero(0.0), GetParam().sharp);
  if (GetParam().sharp) {
    EXPECT_LT((h.velocity - 2.0 * x0).norm(), 1e-14) << "the two newest";
  }
}
INSTANTIATE_TEST_SUITE_P(Table, Angle,
                         testing::Values(Turn{"Back", 0, true}, Turn{"Sharp", 60, true}, Turn{"JustSharp", 89, true},
                                         Turn{"JustSmooth", 91, false}, Turn{"Smooth", 150, false}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST(SpinBetween, TurnsOneIntoTheOther) {
  const Quat from(Eigen::AngleAxisd(1.0, Vec3(1, 2, 3).normalized()));
  for (const double angle : {0.0, 1e-12, 1e-6, 0.5, 3.0, 3.14159, std::numbers::pi}) {
    for (const double sign : {1.0, -1.0}) {  // q and -q are one orientation
      Quat to = from * quat_exp(angle * Vec3(2, -1, 2) / 3.0);
      to.coeffs() *= sign;
      const Vec3 spin = spin_between(from, to, 0.25);
      EXPECT_NEAR(0.25 * spin.norm(), angle, 1e-9);
      EXPECT_LT(angle_between(from * quat_exp(0.25 * spin), to), 3e-8);
    }
  }
}

TEST(PoseHistory, DerivesWhatASourceDoesNotGive) {
  KinematicState s = moving({1, 2, 3}, {4, 5, 6}, {1, -2, 3});
  s.angular_velocity_body = {0, 2, 0};
  PoseHistory history;
  EXPECT_TRUE(history.derive(sim(0s), advance(s, 0).pose()).velocity.isZero(0.0)) << "one pose says nothing";
  EXPECT_LT((history.derive(sim(20ms), advance(s, 0.02).pose()).velocity - advance(s, 0.01).velocity).norm(), 1e-9);
  const KinematicState found = history.derive(sim(50ms), advance(s, 0.05).pose());
  EXPECT_LT((found.velocity - advance(s, 0.05).velocity).norm(), 1e-9);
  EXPECT_LT((found.acceleration - s.acceleration).norm(), 1e-7);
  EXPECT_LT((found.angular_velocity_body - s.angular_velocity_body).norm(), 1e-9);
}

}  // namespace peerd::replication::position_history_test
