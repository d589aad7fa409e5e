#include "peerd/peer/motion/waypoints.hpp"

#include <gtest/gtest.h>

#include "tests/peerd/path_checks.hpp"

namespace peerd::motion::waypoints_test {

using path_checks::expect_continuous;
using path_checks::expect_derivatives;

Waypoints some() { return {{{-1, 0, 0, 0}, {0, 3, 1, -2}, {2, 4, 0, -9}, {2.5, 0, 0, -9}, {6, 0, 0, 0}}}; }

void expect_through(const MotionPath& path, const Waypoints& w) {
  for (const auto& row : w.rows) {
    EXPECT_LT((path.sample(row[0]).position - Vec3(row[1], row[2], row[3])).norm(), 1e-12) << row[0];
  }
}

// The acceleration between knots of a cubic is linear. A path is continuous through any knots, but this holds only
// where their velocities and accelerations are the spline's.
void expect_cubics(const MotionPath& path) {
  for (std::size_t i = 0; i + 1 < path.knots().size(); ++i) {
    const Knot &a = path.knots()[i], &b = path.knots()[i + 1];
    for (const double s : {0.25, 0.5, 0.75}) {
      const Vec3 line = (1.0 - s) * a.state.acceleration + s * b.state.acceleration;
      EXPECT_LT((path.sample(a.t_s + s * (b.t_s - a.t_s)).acceleration - line).norm(), 1e-10) << i;
    }
  }
}

TEST(Waypoints, ACurveGoesThroughThemWithContinuousAcceleration) {
  const MotionPath path(waypoint_knots(some()));
  expect_through(path, some());
  expect_derivatives(path, -1.0, 6.0, 500);
  expect_continuous(path);
  expect_cubics(path);
  EXPECT_TRUE(path.knots().front().state.acceleration.isZero(0.0)) << "a natural spline";
}

TEST(Waypoints, TwoAreALine) {
  const MotionPath path(waypoint_knots({{{0, 0, 0, 0}, {4, 8, 0, 4}}}));
  EXPECT_LT((path.sample(1.0).position - Vec3(2, 0, 1)).norm(), 1e-15);
  EXPECT_LT((path.sample(1.0).velocity - Vec3(2, 0, 1)).norm(), 1e-15);
  EXPECT_EQ(MotionPath(waypoint_knots({{{0, 1, 2, 3}}})).pose(9.0).position, Vec3(1, 2, 3)) << "and one is a place";
}

TEST(Waypoints, CornersAreStraightWithRightDerivatives) {
  Waypoints w = some();
  w.corners = true;
  const MotionPath path(waypoint_knots(w));
  expect_through(path, w);
  EXPECT_LT((path.sample(1.0).position - Vec3(3.5, 0.5, -5.5)).norm(), 1e-12);
  EXPECT_LT((path.sample(2.0).velocity - Vec3(-8, 0, 0)).norm(), 1e-12) << "of what follows";
  EXPECT_LT(path.sample(1.0).acceleration.norm(), 1e-10);
}

TEST(Waypoints, ALoopIsSmoothWhereItCloses) {
  Waypoints w = some();
  w.loop = true;
  const MotionPath path(waypoint_knots(w), true);
  expect_through(path, w);
  expect_continuous(path);
  expect_cubics(path);
  for (const double closing : {-1.0, 6.0, 13.0}) {
    const KinematicState before = path.sample(closing - 1e-9), after = path.sample(closing);
    EXPECT_LT((before.velocity - after.velocity).norm(), 1e-6);
    EXPECT_LT((before.acceleration - after.acceleration).norm(), 1e-6);
    EXPECT_GT(after.velocity.norm(), 0.1);
  }
}

TEST(Waypoints, WhatIsWrongIsNamedWithItsRow) {
  EXPECT_FALSE(check(some()));
  Waypoints w = some();
  w.rows[3][0] = 2.0;
  ASSERT_TRUE(check(w));
  EXPECT_EQ(check(w)->row, 3u);
  w = some();
  w.rows.back()[2] = 0.5;
  EXPECT_FALSE(check(w));
  w.loop = true;
  ASSERT_TRUE(check(w));
  EXPECT_EQ(check(w)->row, 4u);
}

TEST(FacingForward, ItIsTheSamePathLookingAlongIt) {
  const std::vector<Knot> plain = waypoint_knots(some());
  const MotionPath bare(plain), facing(facing_forward(plain));
  expect_derivatives(facing, -1.0, 6.0, 500);
  for (double t = -0.99; t < 6.0; t += 0.01) {
    EXPECT_LT((bare.sample(t).position - facing.sample(t).position).norm(), 1e-12) << t;
    KinematicState s = facing.sample(t);
    s.velocity.y() = 0.0;
    if (s.velocity.norm() > 1.0) {
      EXPECT_LT(path_checks::angle_from_velocity(s), 0.01) << t;
    }
  }
}

TEST(FacingForward, ItTurnsAtOnceAtACorner) {
  Waypoints w{{{0, 0, 0, 0}, {1, 0, 0, -2}, {2, 2, 0, -2}}};
  w.corners = true;
  const MotionPath path(facing_forward(waypoint_knots(w)));
  EXPECT_LT(path_checks::angle_from_velocity(path.sample(1.0 - 1e-6)), 1e-6);
  EXPECT_LT(path_checks::angle_from_velocity(path.sample(1.0)), 1e-6);
  EXPECT_LT((path.sample(1.0).velocity - Vec3(2, 0, 0)).norm(), 1e-12);
}

}  // namespace peerd::motion::waypoints_test
