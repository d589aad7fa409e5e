#include "replication/motion_model.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/sin_cos.hpp"
#include "replication/position_history.hpp"

namespace peerd::replication {
namespace {

constexpr int kShortestPiece_log2_ns = 22, kLongestPiece_log2_ns = 27;

bool is_zero(const Vec3& v) { return v.isZero(0.0); }

// For n = 0 to 3 the sum of (-x2)^k / ((n+1)(n+2)..(n+2k)), k <= 5: 1 / ((n + 2k - 1)(n + 2k)), from the last k on.
constexpr auto kSeriesSteps = [] {
  std::array<std::array<double, 4>, 5> steps{};
  for (int k = 5; k > 0; --k) {
    for (int n = 0; n < 4; ++n) steps[std::size_t(5 - k)][std::size_t(n)] = 1.0 / ((n + 2 * k - 1) * (n + 2 * k));
  }
  return steps;
}();

// With w = rate and x = w t: cos x, (sin x)/w, (1 - cos x)/w^2, (t - (sin x)/w)/w^2, and 1, t, t^2/2, t^3/6 as w -> 0.
struct Waves {
  double c0, c1, c2, c3;
};
[[gnu::always_inline]] inline Waves waves(double rate, double t) {
  if (rate == 0.0) return {1.0, t, 0.5 * t * t, t * t * t / 6.0};
  const double x = rate * t, x2 = x * x;
  if (x2 < 0.05) {  // the next terms are below 4e-17 of the first
    using Lanes = Eigen::Array4d;
    Lanes s = Lanes::Ones();
    for (const auto& steps : kSeriesSteps) s = 1.0 - s * (x2 * Eigen::Map<const Lanes>(steps.data()));
    return {s[0], t * s[1], 0.5 * t * t * s[2], t * t * t / 6.0 * s[3]};
  }
  const auto [sin, cos] = sin_cos(x);
  const double per_rate = 1.0 / rate, per_rate2 = per_rate * per_rate;
  return {cos, sin * per_rate, (1.0 - cos) * per_rate2, (t - sin * per_rate) * per_rate2};
}

// Position relative to the base and derivatives of the translation.
struct Translation {
  Vec3 displacement, velocity, acceleration, jerk;
};

[[gnu::always_inline]] inline Translation polynomial(const KinematicState& s, const Vec3& jerk, double t) {
  return {t * (s.velocity + (0.5 * t) * (s.acceleration + (t / 3.0) * jerk)),
          s.velocity + t * (s.acceleration + (0.5 * t) * jerk), s.acceleration + t * jerk, jerk};
}

[[gnu::always_inline]] inline Translation oscillating(const KinematicState& s, const Vec3& jerk, const Vec3& rate,
                                                      double t) {
  Translation out;
  for (int i = 0; i < 3; ++i) {
    const auto [c0, c1, c2, c3] = waves(rate[i], t);
    const double v = s.velocity[i], a = s.acceleration[i], j = jerk[i];
    out.displacement[i] = v * t + a * c2 + j * c3;
    out.velocity[i] = v + a * c1 + j * c2;
    out.acceleration[i] = a * c0 + j * c1;
    out.jerk[i] = j * c0 - a * rate[i] * rate[i] * c1;
  }
  return out;
}

// The acceleration's part along the axis stays, the rest turns: a'' = -rate^2 a, with a' = axis x a.
struct Turn {
  [[gnu::always_inline]] inline Turn(const KinematicState& s, const Vec3& axis_rate)
      : state(s), rate(axis_rate.norm()) {
    if (rate == 0.0) return;
    const Vec3 axis = axis_rate / rate;
    along = s.acceleration.dot(axis) * axis;
    across = s.acceleration - along;
    jerk = axis_rate.cross(across);
  }
  [[gnu::always_inline]] inline Translation at(double t) const {
    if (rate == 0.0) return polynomial(state, Vec3::Zero(), t);
    const auto [c0, c1, c2, c3] = waves(rate, t);
    return {t * (state.velocity + (0.5 * t) * along) + c2 * across + c3 * jerk,
            state.velocity + t * along + c1 * across + c2 * jerk, along + c0 * across + c1 * jerk,
            c0 * jerk - (rate * rate * c1) * across};
  }

  const KinematicState& state;
  double rate;
  Vec3 along, across, jerk;
};

// Until friction has stopped it [s]; none: it never does.
std::optional<double> stop_s(const Vec3& velocity, const Vec3& acceleration) {
  const double closing = -velocity.dot(acceleration);
  if (closing <= 0.0) return std::nullopt;
  return velocity.squaredNorm() / closing;
}

// Inlined: what a caller does not use of it is not computed.
[[gnu::always_inline]] inline Translation translation(const MotionModel& m, double t) {
  switch (m.kind) {
    case MotionKind::kThird:
      return polynomial(m.state, m.jerk, t);
    case MotionKind::kTurning:
      return Turn(m.state, m.rate_rad_s).at(t);
    case MotionKind::kOscillating:
      return oscillating(m.state, m.jerk, m.rate_rad_s, t);
    case MotionKind::kSliding: {
      const auto stop = stop_s(m.state.velocity, m.state.acceleration);
      if (stop && t >= *stop) {
        return {polynomial(m.state, Vec3::Zero(), *stop).displacement, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
      }
      if (!stop) return {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
      return polynomial(m.state, Vec3::Zero(), t);
    }
    case MotionKind::kFirst:
    case MotionKind::kSecond:
    case MotionKind::kHistory:
      break;
  }
  return polynomial(m.state, Vec3::Zero(), t);
}

Vec3 displacement(const MotionModel& m, double t) { return translation(m, t).displacement; }

void place(const MotionModel& m, const Translation& moved, KinematicState& out) {
  out.position = m.state.position + moved.displacement;
  out.velocity = moved.velocity;
  out.acceleration = moved.acceleration;
}

void turn(const MotionModel& m, double t, KinematicState& out) {
  const Vec3 &w = m.state.angular_velocity_body, &alpha = m.angular_acceleration_body;
  if (is_zero(w) && is_zero(alpha)) return;
  if (m.kind == MotionKind::kSliding && !is_zero(alpha)) {
    const auto stop = stop_s(w, alpha);
    if (!stop || t >= *stop) {
      const double until = stop.value_or(0.0);
      out.orientation = (m.state.orientation * quat_exp(until * (w + (0.5 * until) * alpha))).normalized();
      out.angular_velocity_body.setZero();
      return;
    }
  }
  out.orientation = (m.state.orientation * quat_exp(t * (w + (0.5 * t) * alpha))).normalized();
  out.angular_velocity_body = w + t * alpha;
}

bool translates_by_pieces(const MotionModel& m) {
  return m.kind == MotionKind::kThird || m.kind == MotionKind::kTurning || m.kind == MotionKind::kOscillating;
}

// At a steadily growing rate: its mean is that in the middle.
bool turns_about_one_axis(const MotionModel& m) {
  return m.kind != MotionKind::kSliding && is_zero(m.state.angular_velocity_body.cross(m.angular_acceleration_body));
}

bool is_cut(const MotionModel& m) { return translates_by_pieces(m) || !is_zero(m.angular_acceleration_body); }

// The largest that the jerk can become: within a second, for a constant jerk it is itself.
double jerk_bound(const MotionModel& m) {
  switch (m.kind) {
    case MotionKind::kThird:
      return m.jerk.norm();
    case MotionKind::kTurning:
      return m.rate_rad_s.norm() * m.state.acceleration.norm();
    case MotionKind::kOscillating:
      return m.jerk.norm() + m.rate_rad_s.cwiseProduct(m.state.acceleration).norm();
    default:
      return 0.0;
  }
}

Duration piece_length(const MotionModel& m) {
  const double jerk = jerk_bound(m), alpha = m.angular_acceleration_body.norm();
  int log2_ns = kLongestPiece_log2_ns;
  for (; log2_ns > kShortestPiece_log2_ns; --log2_ns) {
    const double h = to_seconds(Duration{std::int64_t{1} << log2_ns});
    if (jerk * h * h * h <= 125.0 * kPieceError_m && alpha * h * h <= 8.0 * kPieceError_rad) break;
  }
  return Duration{std::int64_t{1} << log2_ns};
}

// Rounded up, so that what has stopped stands; the way left before that is below a nanosecond's. Later than in 31 years
// (more nanoseconds than fit) is never.
std::optional<Duration> stop_after(const std::optional<double>& stop) {
  if (!stop || *stop > 1e9) return std::nullopt;
  const Duration after{static_cast<std::int64_t>(std::ceil(*stop * 1e9))};
  // The product may have been rounded down to a whole number.
  return to_seconds(after) < *stop ? after + Duration{1} : after;
}

struct Bounds {
  Duration begin{0};
  std::optional<Duration> end;
  bool cut = false;  // of the grid, not natively of constant acceleration and spin
};

Bounds bounds_at(const MotionModel& m, Duration since_base) {
  Bounds b;
  const auto cut_at = [&](std::optional<Duration> at) {
    if (!at) return;
    if (*at <= since_base) {
      b.begin = std::max(b.begin, *at);
    } else {
      b.end = b.end ? std::min(*b.end, *at) : *at;
    }
  };
  const Duration lasts = from_seconds(kModelLasts_s);
  if (is_cut(m)) {
    cut_at(lasts);
    if (since_base < lasts) {
      const Duration h = piece_length(m);
      b.begin = since_base / h * h;
      cut_at(b.begin + h);
      b.cut = true;
    }
  }
  if (m.kind == MotionKind::kSliding) {
    cut_at(stop_after(stop_s(m.state.velocity, m.state.acceleration)));
    cut_at(stop_after(stop_s(m.state.angular_velocity_body, m.angular_acceleration_body)));
  }
  return b;
}

}  // namespace

const char* to_string(MotionKind kind) {
  switch (kind) {
    case MotionKind::kFirst:
      return "first";
    case MotionKind::kSecond:
      return "second";
    case MotionKind::kHistory:
      return "history";
    case MotionKind::kThird:
      return "third";
    case MotionKind::kTurning:
      return "turning";
    case MotionKind::kOscillating:
      return "oscillating";
    case MotionKind::kSliding:
      return "sliding";
  }
  return "?";
}

bool within_limits(const MotionModel& m) {
  const bool turning = m.kind == MotionKind::kTurning, oscillating = m.kind == MotionKind::kOscillating;
  if (m.kind == MotionKind::kFirst && !is_zero(m.state.acceleration)) return false;
  if (m.kind != MotionKind::kThird && !oscillating && !is_zero(m.jerk)) return false;
  if (!turning && !oscillating && !is_zero(m.rate_rad_s)) return false;
  if (oscillating && m.rate_rad_s.minCoeff() < 0.0) return false;
  const double rate = turning ? m.rate_rad_s.norm() : m.rate_rad_s.cwiseAbs().maxCoeff();
  return m.rate_rad_s.allFinite() && rate <= kRateMax_rad_s && m.jerk.norm() <= kJerkMax_m_s3 &&
         m.angular_acceleration_body.norm() <= kSpinAccelerationMax_rad_s2;  // which no NaN's norm is
}

KinematicState evaluate(const MotionModel& m, double dt_s) {
  assert(dt_s >= 0.0);
  const bool ends = is_cut(m) && dt_s > kModelLasts_s;
  const double t = ends ? kModelLasts_s : dt_s;
  KinematicState out = m.state;
  place(m, translation(m, t), out);
  if (ends) out.acceleration.setZero();
  turn(m, t, out);
  return ends ? advance(out, dt_s - t) : out;
}

Vec3 position_after(const MotionModel& m, double dt_s) {
  if (is_cut(m) && dt_s > kModelLasts_s) return evaluate(m, dt_s).position;
  return m.state.position + displacement(m, dt_s);
}

Quat orientation_after(const MotionModel& m, double dt_s) {
  if (is_cut(m) && dt_s > kModelLasts_s) return evaluate(m, dt_s).orientation;
  KinematicState out = m.state;
  turn(m, dt_s, out);
  return out.orientation;
}

MotionModel rebased(const MotionModel& m, double dt_s) {
  MotionModel out = m;
  out.state = evaluate(m, dt_s);
  const bool stopped = m.kind == MotionKind::kSliding && is_zero(out.state.velocity);
  const bool spin_stopped = m.kind == MotionKind::kSliding && is_zero(out.state.angular_velocity_body);
  if (is_cut(m) && dt_s > kModelLasts_s) return {out.state};
  if (stopped) out.state.acceleration.setZero();
  if (spin_stopped) out.angular_acceleration_body.setZero();
  if (translates_by_pieces(m) && m.kind != MotionKind::kTurning) out.jerk = translation(m, dt_s).jerk;
  return out;
}

Duration piece_begin(const MotionModel& m, Duration since_base) { return bounds_at(m, since_base).begin; }

std::optional<Duration> piece_end(const MotionModel& m, Duration since_base) { return bounds_at(m, since_base).end; }

MotionPiece piece_at(const MotionModel& m, Duration since_base) {
  assert(since_base >= Duration{0});
  const Bounds b = bounds_at(m, since_base);
  const double begin_s = to_seconds(b.begin);
  if (!b.cut) return {b.begin, b.end, evaluate(m, begin_s)};
  const double h = to_seconds(*b.end - b.begin);
  MotionModel there = m;  // from begin on
  const Translation moved = translation(m, begin_s);
  place(m, moved, there.state);
  turn(m, begin_s, there.state);
  MotionPiece piece{b.begin, b.end, there.state};
  if (turns_about_one_axis(m)) {
    piece.state.angular_velocity_body += (0.5 * h) * m.angular_acceleration_body;
  } else if (!is_zero(m.angular_acceleration_body) && piece.state.angular_velocity_body.norm() * h < 2.0) {
    // More than half a turn within a piece has no shortest way to tell its turns from; such spins keep their own.
    const Quat end = orientation_after(m, begin_s + h);
    piece.state.angular_velocity_body = spin_between(piece.state.orientation, end, h);
  }
  if (translates_by_pieces(m)) {
    there.jerk = moved.jerk;
    // From there its waves have hardly turned: short series in place of sines. Polynomials cost the same from the base.
    const auto way = [&](double dt) -> Vec3 {
      return m.kind == MotionKind::kThird ? displacement(m, begin_s + dt) - moved.displacement
                                          : displacement(there, dt);
    };
    const Vec3 pm = way(0.5 * h), p1 = way(h);
    piece.state.velocity = (4.0 * pm - p1) / h;
    piece.state.acceleration = (4.0 / (h * h)) * (p1 - 2.0 * pm);
  }
  return piece;
}

MotionModel sliding_to_rest(const KinematicState& state, double friction_m_s2) {
  MotionModel m = state;
  m.kind = MotionKind::kSliding;
  const double speed = state.velocity.norm();
  m.state.acceleration.setZero();
  if (speed > 0.0) m.state.acceleration = -(friction_m_s2 / speed) * state.velocity;
  return m;
}

MotionModel after_contact(const MotionModel& m, const KinematicState& after, const Vec3& n, bool mirrored) {
  MotionModel out = m;
  out.state = after;
  if (!mirrored) return {after};
  if (m.kind == MotionKind::kTurning) {  // no rotation any more: its mirror image
    const Vec3 axis = m.rate_rad_s;
    const double rate = axis.norm();
    out.kind = MotionKind::kOscillating;
    out.jerk = axis.cross(m.state.acceleration);
    out.rate_rad_s = Vec3::Constant(rate);
  }
  if (m.kind == MotionKind::kSliding) {  // friction turns with the velocity
    const double speed2 = m.state.velocity.squaredNorm();
    if (speed2 > 0.0) out.state.acceleration = (m.state.acceleration.dot(m.state.velocity) / speed2) * after.velocity;
    return out;
  }
  out.jerk -= 2.0 * n.dot(out.jerk) * n;
  return out;
}

}  // namespace peerd::replication
