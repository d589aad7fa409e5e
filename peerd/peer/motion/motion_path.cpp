#include "peerd/peer/motion/motion_path.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd::motion {
namespace {

// The vector whose quat_exp is q, for the shorter of the two rotations.
Vec3 quat_log(const Quat& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double sine = q.vec().norm();
  if (sine == 0.0) return Vec3::Zero();
  return sign * 2.0 * std::atan2(sine, sign * q.w()) / sine * q.vec();
}

// Coefficients of the quintic in t [s]: position, velocity, half the acceleration, and the three that make it meet `b`
// after h.
void interpolate_position(const KinematicState& a, const KinematicState& b, double h, double t, KinematicState& out) {
  const Vec3 dp = b.position - a.position - h * (a.velocity + 0.5 * h * a.acceleration);
  const Vec3 dv = h * (b.velocity - a.velocity - h * a.acceleration);
  const Vec3 da = h * h * (b.acceleration - a.acceleration);
  const Vec3 c3 = 10.0 * dp - 4.0 * dv + 0.5 * da;
  const Vec3 c4 = -15.0 * dp + 7.0 * dv - da;
  const Vec3 c5 = 6.0 * dp - 3.0 * dv + 0.5 * da;
  const double s = t / h;
  out.position = a.position + t * (a.velocity + 0.5 * t * a.acceleration) + s * s * s * (c3 + s * (c4 + s * c5));
  out.velocity = a.velocity + t * a.acceleration + s * s / h * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5));
  out.acceleration = a.acceleration + s / (h * h) * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5));
}

// The curve is q = qa e1 e2 e3 with ei = exp(wi Bi(s)), where Bi are the cumulative Bernstein polynomials. A turn about
// a fixed axis leaves that axis where it is in the body, so each factor's spin is turned only by the factors behind it.
void interpolate_orientation(const KinematicState& a, const KinematicState& b, double h, double t,
                             KinematicState& out) {
  const Vec3 w1 = h / 3.0 * a.angular_velocity_body, w3 = h / 3.0 * b.angular_velocity_body;
  const Vec3 w2 = quat_log(quat_exp(-w1) * a.orientation.conjugate() * b.orientation * quat_exp(-w3));
  const double s = t / h, r = 1.0 - s;
  const Quat e2 = quat_exp((3.0 - 2.0 * s) * s * s * w2), e3 = quat_exp(s * s * s * w3);
  out.orientation = (a.orientation * quat_exp((1.0 - r * r * r) * w1) * e2 * e3).normalized();
  const Quat back3 = e3.conjugate();
  out.angular_velocity_body = (back3 * (e2.conjugate() * (3.0 * r * r * w1) + 6.0 * s * r * w2) + 3.0 * s * s * w3) / h;
}

}  // namespace

MotionPath::MotionPath(std::vector<Knot> knots, bool loops) : knots_(std::move(knots)), loops_(loops) {
  assert(!knots_.empty());
  assert(std::ranges::is_sorted(knots_, {}, &Knot::t_s));
  assert(!loops_ || knots_.back().t_s > knots_.front().t_s);
}

KinematicState MotionPath::sample(double t_s) const {
  if (loops_) {
    const double begin = knots_.front().t_s, end = knots_.back().t_s;
    t_s -= (end - begin) * std::floor((t_s - begin) / (end - begin));
    if (t_s < begin || t_s >= end) t_s = begin;  // rounding can lead outside
  }
  const auto next = std::ranges::upper_bound(knots_, t_s, {}, &Knot::t_s);
  if (next == knots_.begin()) return at_rest(knots_.front().state.pose());
  if (next == knots_.end()) return at_rest(knots_.back().state.pose());
  const Knot& before = *(next - 1);
  KinematicState s;
  interpolate_position(before.state, next->state, next->t_s - before.t_s, t_s - before.t_s, s);
  interpolate_orientation(before.state, next->state, next->t_s - before.t_s, t_s - before.t_s, s);
  return s;
}

Vec3 turn_between(const Quat& a, const Quat& b) { return quat_log(a.conjugate() * b); }

void face(KinematicState& state, double yaw, double pitch, double yaw_rate, double pitch_rate) {
  state.orientation = Eigen::AngleAxisd(yaw, Vec3::UnitY()) * Eigen::AngleAxisd(pitch, Vec3::UnitX());
  state.angular_velocity_body = Vec3(pitch_rate, yaw_rate * std::cos(pitch), -yaw_rate * std::sin(pitch));
}

void face_forward(KinematicState& state, bool level, const KinematicState& before) {
  const Vec3 &v = state.velocity, &a = state.acceleration;
  const double across2 = v.x() * v.x() + v.z() * v.z(), across = std::sqrt(across2);
  if (across2 == 0.0) {  // straight up, or at rest: neither gives a direction
    state.orientation = before.orientation;
    state.angular_velocity_body = Vec3::Zero();
    return;
  }
  const double yaw_rate = (v.z() * a.x() - v.x() * a.z()) / across2;
  if (level) return face(state, std::atan2(-v.x(), -v.z()), 0.0, yaw_rate, 0.0);
  const double across_rate = (v.x() * a.x() + v.z() * a.z()) / across;
  face(state, std::atan2(-v.x(), -v.z()), std::atan2(v.y(), across), yaw_rate,
       (a.y() * across - v.y() * across_rate) / v.squaredNorm());
}

}  // namespace peerd::motion
