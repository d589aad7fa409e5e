#include "replication/physics/laws/motion_model.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/rotate_body.hpp"
#include "core/sin_cos.hpp"
#include "replication/physics/laws/position_history.hpp"

namespace peerd::replication {
namespace {

constexpr int kShortestPiece_log2_ns = 22, kLongestPiece_log2_ns = 27;
static_assert(kShortestPiece_log2_ns < kLongestPiece_log2_ns);

bool is_zero(const Vec3& v) { return v.isZero(0.0); }

// Four series by Horner's rule at once, from the last term on.
constexpr int kTerms = 7;
using Series = std::array<std::array<double, 4>, kTerms>;
[[gnu::always_inline]] inline std::array<double, 4> sum_of(const Series& series, double x) {
  using Lanes [[gnu::vector_size(16)]] = double;
  Lanes low{}, high{};
#pragma GCC unroll 7
  for (const auto& [a, b, c, d] : series) {
    low = low * x + Lanes{a, b};
    high = high * x + Lanes{c, d};
  }
  return {low[0], low[1], high[0], high[1]};
}

constexpr double factorial(int n) { return n < 2 ? 1.0 : n * factorial(n - 1); }

// (-1)^k / (2k + n)!, n = 0 to 3.
constexpr Series kWaves = [] {
  Series series{};
  for (int k = 0; k < kTerms; ++k) {
    for (int n = 0; n < 4; ++n) {
      series[std::size_t(kTerms - 1 - k)][std::size_t(n)] = (k % 2 == 0 ? 1.0 : -1.0) / factorial(2 * k + n);
    }
  }
  return series;
}();

// With w = rate and x = w t: cos x, (sin x)/w, (1 - cos x)/w^2, (t - (sin x)/w)/w^2, and 1, t, t^2/2, t^3/6 as w -> 0.
struct Waves {
  double c0, c1, c2, c3;
};
[[gnu::always_inline]] inline Waves waves(double rate, double t) {
  if (rate == 0.0) return {1.0, t, 0.5 * t * t, t * t * t / 6.0};
  const double x = rate * t, x2 = x * x;
  if (x2 < 0.125) {  // the next terms are below 6e-18 of the first
    const auto s = sum_of(kWaves, x2);
    return {s[0], t * s[1], t * t * s[2], t * t * t * s[3]};
  }
  const auto [sin, cos] = sin_cos(x);
  const double per_rate = 1.0 / rate, per_rate2 = per_rate * per_rate;
  return {cos, sin * per_rate, (1.0 - cos) * per_rate2, (t - sin * per_rate) * per_rate2};
}

// The parabola through d(0) = 0, d(h/2) and d(h), where d(t) = v t + a c2 + j c3 as above: it begins with velocity
// v + va a + vj j and has acceleration aa a + aj j.
struct Parabola {
  double va, vj, aa, aj;
};

// The series of (4 c(h/2) - c(h)) / h and 4 (c(h) - 2 c(h/2)) / h^2, term by term, over h, h^2, 1 and h.
constexpr Series kParabola = [] {
  Series series{};
  for (int k = 0; k < kTerms; ++k) {
    const double quarters = 1.0 / static_cast<double>(1 << (2 * k)), sign = k % 2 == 0 ? 1.0 : -1.0;
    const double c2 = sign / factorial(2 * k + 2), c3 = sign / factorial(2 * k + 3);
    series[std::size_t(kTerms - 1 - k)] = {(quarters - 1.0) * c2, (0.5 * quarters - 1.0) * c3,
                                           (4.0 - 2.0 * quarters) * c2, (4.0 - quarters) * c3};
  }
  return series;
}();

[[gnu::always_inline]] inline Parabola parabola(double rate, double h) {
  assert(h > 0.0);
  const double x = rate * h, x2 = x * x;
  if (x2 < 0.125) {
    const auto s = sum_of(kParabola, x2);
    return {h * s[0], h * h * s[1], s[2], h * s[3]};
  }
  const Waves half = waves(rate, 0.5 * h), whole = waves(rate, h);
  return {(4.0 * half.c2 - whole.c2) / h, (4.0 * half.c3 - whole.c3) / h, 4.0 / (h * h) * (whole.c2 - 2.0 * half.c2),
          4.0 / (h * h) * (whole.c3 - 2.0 * half.c3)};
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

// A turning motion: the acceleration's part along the axis stays, the rest turns: a'' = -rate^2 a, with a' = axis x a.
struct Turn {
  [[gnu::always_inline]] inline Turn(const KinematicState& s, const Vec3& axis_rate)
      : state(s), rate(axis_rate.norm()) {
    if (rate > 0.0) {
      const Vec3 axis = axis_rate / rate;
      along = s.acceleration.dot(axis) * axis;
    }
    across = s.acceleration - along;
    jerk = axis_rate.cross(across);
  }
  [[gnu::always_inline]] inline Translation at(double t) const {
    const auto [c0, c1, c2, c3] = waves(rate, t);
    return {t * (state.velocity + (0.5 * t) * along) + c2 * across + c3 * jerk,
            state.velocity + t * along + c1 * across + c2 * jerk, along + c0 * across + c1 * jerk,
            c0 * jerk - (rate * rate * c1) * across};
  }

  const KinematicState& state;
  double rate;
  Vec3 along = Vec3::Zero(), across, jerk;
};

// The time until friction has stopped the object [s]; none: it never does.
std::optional<double> stop_s(const Vec3& velocity, const Vec3& acceleration) {
  const double closing = -velocity.dot(acceleration);
  if (closing <= 0.0) return std::nullopt;
  return velocity.squaredNorm() / closing;
}

// Inlined, so that the parts that a caller does not use are not computed.
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
      out.orientation = rotated_in_body_frame(m.state.orientation, until * (w + (0.5 * until) * alpha));
      out.angular_velocity_body.setZero();
      return;
    }
  }
  out.orientation = rotated_in_body_frame(m.state.orientation, t * (w + (0.5 * t) * alpha));
  out.angular_velocity_body = w + t * alpha;
}

bool translates_by_pieces(const MotionModel& m) {
  return m.kind == MotionKind::kThird || m.kind == MotionKind::kTurning || m.kind == MotionKind::kOscillating;
}

// A spin about one axis grows steadily: its mean within a piece is its value in the middle.
bool turns_about_one_axis(const MotionModel& m) {
  return m.kind != MotionKind::kSliding && is_zero(m.state.angular_velocity_body.cross(m.angular_acceleration_body));
}

bool is_cut(const MotionModel& m) { return translates_by_pieces(m) || !is_zero(m.angular_acceleration_body); }

// The largest jerk that the model can reach [m/s^3]: within a second, a constant jerk is the bound itself.
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

// The time of the stop, rounded up, so that an object that has stopped stands; the way left before that is below a
// nanosecond's. A stop later than in 31 years (more nanoseconds than fit) counts as never.
std::optional<Duration> stop_after(const std::optional<double>& stop) {
  if (!stop || *stop > 1e9) return std::nullopt;
  const Duration after{static_cast<std::int64_t>(std::ceil(*stop * 1e9))};
  // The product may have been rounded down to a whole number.
  return to_seconds(after) < *stop ? after + Duration{1} : after;
}

struct Bounds {
  Duration begin{0};
  std::optional<Duration> end;
  bool cut = false;  // a piece of the grid, not natively of constant acceleration and spin
};

Bounds bounds_at(const MotionModel& m, Duration since_base) {
  const SmoothSpan smooth = smooth_span(m, since_base);
  Bounds b{smooth.begin, smooth.end};
  if (is_cut(m) && since_base < from_seconds(kModelLasts_s)) {
    const Duration h = piece_length(m), cell = since_base / h * h;
    b.begin = std::max(b.begin, cell);
    b.end = b.end ? std::min(*b.end, cell + h) : cell + h;
    b.cut = true;
  }
  assert(b.begin <= since_base && (!b.end || *b.end > since_base));
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
  const auto within = [](const Vec3& v, double most) { return v.squaredNorm() <= most * most; };  // no NaN is
  const bool rate_within = turning ? within(m.rate_rad_s, kRateMax_rad_s)
                                   : m.rate_rad_s.allFinite() && m.rate_rad_s.cwiseAbs().maxCoeff() <= kRateMax_rad_s;
  return rate_within && within(m.jerk, kJerkMax_m_s3) &&
         within(m.angular_acceleration_body, kSpinAccelerationMax_rad_s2);
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
  assert(dt_s >= 0.0);
  if (is_cut(m) && dt_s > kModelLasts_s) return evaluate(m, dt_s).position;
  return m.state.position + displacement(m, dt_s);
}

Quat orientation_after(const MotionModel& m, double dt_s) {
  assert(dt_s >= 0.0);
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

SmoothSpan smooth_span(const MotionModel& m, Duration since_base) {
  assert(since_base >= Duration{0});
  SmoothSpan span;
  const auto cut_at = [&](std::optional<Duration> at) {
    if (!at) return;
    if (*at <= since_base) {
      span.begin = std::max(span.begin, *at);
    } else {
      span.end = span.end ? std::min(*span.end, *at) : *at;
    }
  };
  if (is_cut(m)) cut_at(from_seconds(kModelLasts_s));
  if (m.kind == MotionKind::kSliding) {
    cut_at(stop_after(stop_s(m.state.velocity, m.state.acceleration)));
    cut_at(stop_after(stop_s(m.state.angular_velocity_body, m.angular_acceleration_body)));
  }
  return span;
}

bool is_one_piece(const MotionModel& m) { return !is_cut(m); }

MotionBounds bounds_within(const MotionModel& m, double dt_s, double h_s) {
  assert(dt_s >= 0.0 && h_s > 0.0);
  const KinematicState at = evaluate(m, dt_s);
  const bool over = is_cut(m) && dt_s >= kModelLasts_s;
  MotionBounds b;
  b.jerk_m_s3 = over ? 0.0 : jerk_bound(m);
  b.acceleration_m_s2 = at.acceleration.norm() + h_s * b.jerk_m_s3;
  b.speed_m_s = at.velocity.norm() + h_s * b.acceleration_m_s2;
  b.distance_m = at.position.norm() + h_s * b.speed_m_s;
  const double alpha = over ? 0.0 : m.angular_acceleration_body.norm();
  const double spin = m.state.angular_velocity_body.norm(), until_s = dt_s + h_s;
  b.spin_rad_s = at.angular_velocity_body.norm() + h_s * alpha;
  // A spin that does not keep its axis makes the turn the exponential of a vector that turns itself.
  b.spin_acceleration_rad_s2 = alpha * (1.0 + until_s * (spin + alpha * until_s));
  return b;
}

Duration piece_begin(const MotionModel& m, Duration since_base) { return bounds_at(m, since_base).begin; }

std::optional<Duration> piece_end(const MotionModel& m, Duration since_base) { return bounds_at(m, since_base).end; }

MotionPiece piece_at(const MotionModel& m, Duration since_base) {
  assert(since_base >= Duration{0});
  const Bounds b = bounds_at(m, since_base);
  const double begin_s = to_seconds(b.begin);
  if (!b.cut) return {b.begin, b.end, evaluate(m, begin_s)};
  assert(b.end && *b.end > b.begin);
  const double h = to_seconds(*b.end - b.begin);
  const Translation moved = translation(m, begin_s);
  MotionPiece piece{b.begin, b.end, m.state};
  place(m, moved, piece.state);
  turn(m, begin_s, piece.state);
  if (turns_about_one_axis(m)) {
    piece.state.angular_velocity_body += (0.5 * h) * m.angular_acceleration_body;
  } else if (!is_zero(m.angular_acceleration_body) && piece.state.angular_velocity_body.norm() * h < 2.0) {
    // More than half a turn within a piece has no shortest way to tell its turns from; such spins keep their own.
    const Quat end = orientation_after(m, begin_s + h);
    piece.state.angular_velocity_body = spin_between(piece.state.orientation, end, h);
  }
  Vec3 &velocity = piece.state.velocity, &acceleration = piece.state.acceleration;
  if (m.kind == MotionKind::kThird) {
    const Vec3 half = displacement(m, begin_s + 0.5 * h) - moved.displacement,
               whole = displacement(m, begin_s + h) - moved.displacement;
    velocity = (4.0 * half - whole) / h;
    acceleration = (4.0 / (h * h)) * (whole - 2.0 * half);
  } else if (m.kind == MotionKind::kTurning) {
    const Vec3 along = Turn(m.state, m.rate_rad_s).along, across = moved.acceleration - along;
    const auto [va, vj, aa, aj] = parabola(m.rate_rad_s.norm(), h);
    velocity += va * across + vj * moved.jerk;
    acceleration = along + aa * across + aj * moved.jerk;
  } else if (m.kind == MotionKind::kOscillating) {
    for (int i = 0; i < 3; ++i) {
      const auto [va, vj, aa, aj] = parabola(m.rate_rad_s[i], h);
      velocity[i] += va * moved.acceleration[i] + vj * moved.jerk[i];
      acceleration[i] = aa * moved.acceleration[i] + aj * moved.jerk[i];
    }
  }
  return piece;
}

MotionModel in_frame(const Pose& frame, const MotionModel& m) {
  const Quat back = frame.orientation.conjugate();
  const Mat3 R = back.toRotationMatrix();
  const bool is_turned = R != Mat3(Mat3::Identity());
  MotionModel out = m;
  out.state.position = multiply(R, Vec3(m.state.position - frame.position));
  if (!is_turned) return out;
  out.state.velocity = multiply(R, m.state.velocity);
  out.state.acceleration = multiply(R, m.state.acceleration);
  out.state.orientation = normalized(multiply(back, m.state.orientation));
  out.jerk = multiply(R, m.jerk);
  out.rate_rad_s = multiply(R, m.rate_rad_s);
  if (m.kind == MotionKind::kOscillating) {
    out.jerk.setZero();
    out.rate_rad_s.setZero();
    out.kind = MotionKind::kSecond;
  }
  return out;
}

MotionModel sliding_to_rest(const KinematicState& state, double friction_m_s2) {
  assert(!(friction_m_s2 < 0.0));
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
  if (m.kind == MotionKind::kTurning) {  // its mirror image is no rotation any more
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
