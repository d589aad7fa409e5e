#include "peerd/peer/motion/motion_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/peerd/path_checks.hpp"

namespace peerd::motion::motion_path_test {

using path_checks::expect_continuous;
using path_checks::expect_derivatives;
using std::numbers::pi;

// A knot of some smooth motion in all of its parts.
Knot some_knot(double t) {
  Knot k;
  k.t_s = t;
  k.state.position = Vec3(3.0 * std::sin(t), t * t, std::cos(2.0 * t));
  k.state.velocity = Vec3(3.0 * std::cos(t), 2.0 * t, -2.0 * std::sin(2.0 * t));
  k.state.acceleration = Vec3(-3.0 * std::sin(t), 2.0, -4.0 * std::cos(2.0 * t));
  face(k.state, 0.8 * t * t, std::sin(t), 1.6 * t, std::cos(t));
  return k;
}
MotionPath some_path() { return MotionPath({some_knot(0.0), some_knot(0.3), some_knot(0.5), some_knot(1.0)}); }

TEST(MotionPath, HasItsKnots) {
  const MotionPath path = some_path();
  for (std::size_t i = 0; i + 1 < path.knots().size(); ++i) {
    const KinematicState &knot = path.knots()[i].state, s = path.sample(path.knots()[i].t_s);
    EXPECT_EQ(s.position, knot.position);
    EXPECT_EQ(s.velocity, knot.velocity);
    EXPECT_EQ(s.acceleration, knot.acceleration);
    EXPECT_LT(turn_between(s.orientation, knot.orientation).norm(), 1e-14);
    EXPECT_LT((s.angular_velocity_body - knot.angular_velocity_body).norm(), 1e-13);
  }
}

TEST(MotionPath, IsContinuousUpToAccelerationAndSpin) { expect_continuous(some_path()); }
TEST(MotionPath, SamplesHaveTheirDerivatives) { expect_derivatives(some_path(), 0.0, 1.0, 500); }

TEST(MotionPath, AQuinticIsKeptExactly) {
  const auto quintic = [](double t) {
    Knot k;
    k.t_s = t;
    k.state.position.x() = 1 + t - 2 * std::pow(t, 3) + std::pow(t, 5);
    k.state.velocity.x() = 1 - 6 * t * t + 5 * std::pow(t, 4);
    k.state.acceleration.x() = -12 * t + 20 * std::pow(t, 3);
    return k;
  };
  const MotionPath path({quintic(-1.0), quintic(2.0)});
  for (double t = -1.0; t < 2.0; t += 0.125) {
    EXPECT_NEAR(path.sample(t).position.x(), quintic(t).state.position.x(), 1e-12);
    EXPECT_NEAR(path.sample(t).velocity.x(), quintic(t).state.velocity.x(), 1e-12);
    EXPECT_NEAR(path.sample(t).acceleration.x(), quintic(t).state.acceleration.x(), 1e-11);
  }
}

TEST(MotionPath, ASteadySpinIsKeptExactly) {
  const Vec3 spin(0.3, -1.0, 2.0);
  const auto knot = [&](double t) {
    Knot k;
    k.t_s = t;
    k.state.orientation = quat_exp(t * spin);
    k.state.angular_velocity_body = spin;
    return k;
  };
  const MotionPath path({knot(0.0), knot(1.0)});
  for (double t = 0.0; t < 1.0; t += 0.0625) {
    EXPECT_LT(turn_between(path.sample(t).orientation, quat_exp(t * spin)).norm(), 1e-14);
    EXPECT_LT((path.sample(t).angular_velocity_body - spin).norm(), 1e-14);
  }
}

TEST(MotionPath, StandsBeforeAndAfter) {
  const MotionPath path = some_path();
  for (const auto& [t, at] : {std::pair{-3.0, 0.0}, {-1e-9, 0.0}, {1.0, 1.0}, {7.0, 1.0}}) {
    const KinematicState s = path.sample(t);
    EXPECT_EQ(s.position, some_knot(at).state.position);
    EXPECT_TRUE(s.velocity.isZero(0.0) && s.acceleration.isZero(0.0) && s.angular_velocity_body.isZero(0.0)) << t;
  }
  EXPECT_FALSE(path.sample(0.0).velocity.isZero(0.0)) << "what follows counts";
}

TEST(MotionPath, TwoKnotsOfOneTimeAreACorner) {
  Knot a, b, c, d;
  b.t_s = c.t_s = 1.0, d.t_s = 2.0;
  b.state.position = c.state.position = Vec3(1, 0, 0), d.state.position = Vec3(1, 5, 0);
  a.state.velocity = b.state.velocity = Vec3(1, 0, 0);
  c.state.velocity = d.state.velocity = Vec3(0, 5, 0);
  const MotionPath path({a, b, c, d});
  EXPECT_EQ(path.sample(0.5).velocity, Vec3(1, 0, 0));
  EXPECT_EQ(path.sample(1.0).velocity, Vec3(0, 5, 0)) << "from the right";
  EXPECT_EQ(path.sample(1.5).position, Vec3(1, 2.5, 0));
}

TEST(MotionPath, ALoopHasNoEnd) {
  std::vector<Knot> knots{some_knot(0.0), some_knot(0.3), some_knot(0.0)};
  knots.back().t_s = 0.9;
  const MotionPath path(knots, true);
  for (const double t : {0.0, 0.1, 0.5, 0.8999}) {
    for (const int rounds : {-3, 1, 40}) {
      EXPECT_LT((path.sample(t + 0.9 * rounds).position - path.sample(t).position).norm(), 1e-10);
      EXPECT_LT((path.sample(t + 0.9 * rounds).velocity - path.sample(t).velocity).norm(), 1e-9);
    }
  }
  for (int i = -1000; i < 1000; ++i) EXPECT_FALSE(path.sample(0.9 * i).velocity.isZero(0.0)) << i;
}

// ---- where it looks ----

TEST(Face, YawIsRightHandedAboutYAndPitchIsUp) {
  KinematicState s;
  face(s, 0.5 * pi, 0.0, 0.0, 0.0);
  EXPECT_LT((s.orientation * Vec3(0, 0, -1) - Vec3(-1, 0, 0)).norm(), 1e-15);
  face(s, 0.0, 0.25 * pi, 0.0, 0.0);
  EXPECT_LT((s.orientation * Vec3(0, 0, -1) - Vec3(0, std::sqrt(0.5), -std::sqrt(0.5))).norm(), 1e-15);
}

TEST(FaceForward, LooksAndTurnsAsTheVelocityDoes) {
  constexpr double h = 1e-5;
  for (const bool level : {true, false}) {
    for (const double t : {0.2, 1.0, 2.5, 4.0}) {
      const auto at = [&](double when) {
        KinematicState s = some_knot(when).state;
        if (level) s.velocity.y() = s.acceleration.y() = 0.0;
        face_forward(s, level, {});
        return s;
      };
      EXPECT_LT(path_checks::angle_from_velocity(at(t)), 1e-7) << t;
      const Vec3 spin = turn_between(at(t - h).orientation, at(t + h).orientation) / (2.0 * h);
      EXPECT_LT((at(t).angular_velocity_body - spin).norm(), 1e-6 * (1.0 + spin.norm())) << t << ' ' << level;
    }
  }
}

TEST(FaceForward, WhoStandsLooksWhereItDid) {
  KinematicState before, s;
  face(before, 1.0, 0.0, 3.0, 0.0);
  face_forward(s, true, before);
  EXPECT_EQ(s.orientation.coeffs(), before.orientation.coeffs());
  EXPECT_TRUE(s.angular_velocity_body.isZero(0.0));
}

}  // namespace peerd::motion::motion_path_test
