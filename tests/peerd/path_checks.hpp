#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "peerd/peer/motion/motion_path.hpp"

// Checks that hold of every path, whatever made it.
namespace peerd::motion::path_checks {

inline bool same(const std::vector<motion::Knot>& a, const std::vector<motion::Knot>& b) {
  return std::ranges::equal(a, b, [](const motion::Knot& p, const motion::Knot& q) {
    return p.t_s == q.t_s && p.state.position == q.state.position && p.state.velocity == q.state.velocity &&
           p.state.acceleration == q.state.acceleration &&
           p.state.orientation.coeffs() == q.state.orientation.coeffs() &&
           p.state.angular_velocity_body == q.state.angular_velocity_body;
  });
}

// Velocity, acceleration and spin against differences of what they are derivatives of, by a step of h inside of one
// piece: [begin, end] apart from where it touches a knot.
inline void expect_derivatives(const motion::MotionPath& path, double begin_s, double end_s, int count) {
  constexpr double h = 1e-5;
  for (int i = 0; i < count; ++i) {
    const double t = begin_s + (end_s - begin_s) * (i + 0.37) / count;
    const bool near_knot =
        std::ranges::any_of(path.knots(), [&](const motion::Knot& k) { return std::abs(k.t_s - t) <= 2.0 * h; });
    if (near_knot) continue;
    SCOPED_TRACE(testing::Message() << "t = " << t);
    const KinematicState before = path.sample(t - h), s = path.sample(t), after = path.sample(t + h);
    const double scale = 1.0 + s.acceleration.norm();
    ASSERT_LT((s.velocity - (after.position - before.position) / (2.0 * h)).norm(), 1e-6 * scale);
    ASSERT_LT((s.acceleration - (after.velocity - before.velocity) / (2.0 * h)).norm(), 1e-5 * scale);
    const Vec3 spin = motion::turn_between(before.orientation, after.orientation) / (2.0 * h);
    ASSERT_LT((s.angular_velocity_body - spin).norm(), 1e-5 * (1.0 + spin.norm()));
    ASSERT_NEAR(s.orientation.norm(), 1.0, 1e-14);
  }
}

// Position, velocity, acceleration, orientation and spin just before each knot are those at it.
inline void expect_continuous(const motion::MotionPath& path) {
  const auto& knots = path.knots();
  for (std::size_t i = 1; i + 1 < knots.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "t = " << knots[i].t_s);
    const KinematicState before = path.sample(knots[i].t_s - 1e-9), at = path.sample(knots[i].t_s);
    ASSERT_LT((before.position - at.position).norm(), 1e-7);
    ASSERT_LT((before.velocity - at.velocity).norm(), 1e-6);
    ASSERT_LT((before.acceleration - at.acceleration).norm(), 1e-5);
    ASSERT_LT(motion::turn_between(before.orientation, at.orientation).norm(), 1e-6);
    ASSERT_LT((before.angular_velocity_body - at.angular_velocity_body).norm(), 1e-5);
  }
}

// -z of the body is where it goes, wherever it goes anywhere.
inline double angle_from_velocity(const KinematicState& s) {
  const Vec3 nose = s.orientation * Vec3(0, 0, -1);
  return std::atan2(nose.cross(s.velocity).norm(), nose.dot(s.velocity));
}

}  // namespace peerd::motion::path_checks
