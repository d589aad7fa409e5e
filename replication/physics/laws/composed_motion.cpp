#include "replication/physics/laws/composed_motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <boost/container/small_vector.hpp>

#include "core/transform.hpp"
#include "replication/physics/laws/position_history.hpp"

namespace peerd::replication {
namespace {

constexpr int kShortest_log2_ns = 16, kLongest_log2_ns = 27;
// Nothing turns farther within a piece [rad]: two orientations say the shorter way between them only.
constexpr double kTurnMax_rad = 0.5;
// The rounding of a composed position, in parts of all lengths that go into it.
constexpr double kPositionRounding = 0x1p-46;

// The law of each timeline that is in force at an instant, and since when.
struct Level {
  const MotionModel* law;
  SimTime from;
  bool begun;  // else the timeline begins later, and the object stands where it begins

  [[nodiscard]] KinematicState at(SimTime t) const {
    if (!begun) return at_rest(law->state.pose());
    return t <= from ? law->state : evaluate(*law, to_seconds(t - from));
  }
};
using Levels = boost::container::small_vector<Level, 8>;

Levels levels_at(Chain chain, SimTime t) {
  Levels levels;
  for (const Timeline* timeline : chain) {
    const Timeline::Segment& s = timeline->segment_at(t);
    levels.push_back({&s.model, s.from, t >= s.from});
  }
  return levels;
}

KinematicState state_of(const Levels& levels, SimTime t) {
  // From the bottom up, so that each carrier is a law of its own, whose spin does not change.
  KinematicState state = levels.back().at(t);
  for (std::size_t i = levels.size() - 1; i-- > 0;) state = composed(levels[i].at(t), state);
  return state;
}

// Bounds of the composed motion of a point: those in the node's frame, taken from each level into the one above.
MotionBounds bounds_of(const Levels& levels, SimTime t, double h_s, const MotionBounds& in_node = {}) {
  const auto of = [&](const Level& level) {
    MotionBounds b;
    if (level.begun) return bounds_within(*level.law, to_seconds(t - level.from), h_s);
    b.distance_m = level.law->state.position.norm();
    return b;
  };
  MotionBounds all = in_node;
  for (std::size_t i = levels.size(); i-- > 0;) {
    const MotionBounds c = of(levels[i]);
    const double w = c.spin_rad_s, alpha = c.spin_acceleration_rad_s2, turn2 = w * w + alpha;
    all.jerk_m_s3 = c.jerk_m_s3 + (w * w * w + 3.0 * w * alpha) * all.distance_m + 3.0 * turn2 * all.speed_m_s +
                    3.0 * w * all.acceleration_m_s2 + all.jerk_m_s3;
    all.acceleration_m_s2 =
        c.acceleration_m_s2 + turn2 * all.distance_m + 2.0 * w * all.speed_m_s + all.acceleration_m_s2;
    all.speed_m_s = c.speed_m_s + w * all.distance_m + all.speed_m_s;
    all.distance_m += c.distance_m;
    all.spin_acceleration_rad_s2 += alpha + w * all.spin_rad_s;
    all.spin_rad_s += w;
  }
  return all;
}

bool turns(const MotionModel& law) {
  return !law.state.angular_velocity_body.isZero(0.0) || !law.angular_acceleration_body.isZero(0.0);
}

}  // namespace

KinematicState composed(const KinematicState& carrier, const KinematicState& relative) {
  const Mat3 R = carrier.orientation.toRotationMatrix();
  const Vec3 &w = carrier.angular_velocity_body, &x = relative.position;
  KinematicState out;
  out.position = carrier.position + multiply(R, x);
  out.velocity = carrier.velocity + multiply(R, Vec3(w.cross(x) + relative.velocity));
  out.acceleration = carrier.acceleration +
                     multiply(R, Vec3(w.cross(w.cross(x)) + 2.0 * w.cross(relative.velocity) + relative.acceleration));
  out.orientation = normalized(multiply(carrier.orientation, relative.orientation));
  const Mat3 from_carrier = relative.orientation.conjugate().toRotationMatrix();
  out.angular_velocity_body = relative.angular_velocity_body + multiply(from_carrier, w);
  return out;
}

KinematicState relative_to(const KinematicState& carrier, const KinematicState& state) {
  const Quat back = carrier.orientation.conjugate();
  const Mat3 R = back.toRotationMatrix();
  const Vec3& w = carrier.angular_velocity_body;
  KinematicState out;
  out.position = multiply(R, Vec3(state.position - carrier.position));
  const Vec3& x = out.position;
  out.velocity = multiply(R, Vec3(state.velocity - carrier.velocity)) - w.cross(x);
  out.acceleration =
      multiply(R, Vec3(state.acceleration - carrier.acceleration)) - w.cross(w.cross(x)) - 2.0 * w.cross(out.velocity);
  out.orientation = normalized(multiply(back, state.orientation));
  const Mat3 from_carrier = out.orientation.conjugate().toRotationMatrix();
  out.angular_velocity_body = state.angular_velocity_body - multiply(from_carrier, w);
  return out;
}

double error_of_piece_m(const MotionBounds& b, double extent_m, double h_s) {
  assert(extent_m >= 0.0 && h_s >= 0.0);
  return b.jerk_m_s3 * h_s * h_s * h_s / 124.0 + extent_m * b.spin_acceleration_rad_s2 * h_s * h_s / 7.0;
}

KinematicState composed_at(Chain chain, SimTime t) {
  assert(!chain.empty());
  return state_of(levels_at(chain, t), t);
}

KinematicState composed_at(Chain chain, SimTime law_at, SimTime t) {
  assert(!chain.empty() && law_at <= t);
  return state_of(levels_at(chain, law_at), t);
}

std::optional<SimTime> smooth_until(Chain chain, SimTime t) {
  std::optional<SimTime> until;
  for (const Timeline* timeline : chain) {
    const Timeline::Span span = timeline->smooth_around(t);
    if (span.end) until = until ? std::min(*until, *span.end) : *span.end;
  }
  return until;
}

MotionBounds composed_bounds(Chain chain, SimTime t, double h_s, const MotionBounds& in_node) {
  return bounds_of(levels_at(chain, t), t, h_s, in_node);
}

ComposedPiece composed_piece(Chain chain, SimTime t, double extent_m, double error_max_m) {
  assert(!chain.empty() && extent_m >= 0.0 && error_max_m > 0.0);
  const Levels levels = levels_at(chain, t);
  ComposedPiece piece;
  std::optional<SimTime> begin;
  bool exact = true;
  piece.still = true;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const Timeline::Span span = chain[i]->smooth_around(t);
    if (span.begin) begin = begin ? std::max(*begin, *span.begin) : *span.begin;
    if (span.end) piece.end = piece.end ? std::min(*piece.end, *span.end) : *span.end;
    const MotionModel& law = *levels[i].law;
    if (!levels[i].begun) continue;
    const bool is_carrier = i + 1 < levels.size();
    exact = exact && is_one_piece(law) && !(is_carrier && turns(law));
    piece.still = piece.still && is_motionless(levels[i].at(t)) && is_one_piece(law);
  }
  piece.begin = begin.value_or(t);
  if (piece.still || exact) {
    piece.state = state_of(levels, piece.begin);
    if (piece.still) piece.state = at_rest(piece.state.pose());
    return piece;
  }
  const Duration longest{std::int64_t{1} << kLongest_log2_ns};
  const SimTime window = std::max(piece.begin, floor_to(t, longest));
  const SimTime window_end =
      piece.end ? std::min(*piece.end, floor_to(t, longest) + longest) : floor_to(t, longest) + longest;
  assert(window <= t && t < window_end);
  const MotionBounds bounds = bounds_of(levels, window, to_seconds(window_end - window));
  int log2_ns = kLongest_log2_ns;
  const auto length_s = [&] { return to_seconds(Duration{std::int64_t{1} << log2_ns}); };
  while (log2_ns > kShortest_log2_ns && (error_of_piece_m(bounds, extent_m, length_s()) > error_max_m ||
                                         bounds.spin_rad_s * length_s() > kTurnMax_rad)) {
    --log2_ns;
  }
  const Duration step{std::int64_t{1} << log2_ns};
  piece.begin = std::max(window, floor_to(t, step));
  piece.end = std::min(window_end, floor_to(t, step) + step);
  const double h = to_seconds(*piece.end - piece.begin);
  const SimTime half = piece.begin + (*piece.end - piece.begin) / 2;
  piece.state = state_of(levels, piece.begin);
  const Pose first = piece.state.pose(), last = state_of(levels, *piece.end).pose();
  const double m = to_seconds(half - piece.begin);
  const Vec3 to_middle = state_of(levels, half).position - first.position, to_end = last.position - first.position;
  // The parabola through the three places, of which the second is within a nanosecond of the middle. A piece of one
  // nanosecond has no time in its middle, and is a straight line.
  piece.state.acceleration = m > 0.0 ? Vec3(2.0 * (to_end / h - to_middle / m) / (h - m)) : Vec3::Zero();
  piece.state.velocity = to_end / h - (0.5 * h) * piece.state.acceleration;
  piece.state.angular_velocity_body = spin_between(first.orientation, last.orientation, h);
  piece.error_m = error_of_piece_m(bounds, extent_m, h) + kPositionRounding * (bounds.distance_m + extent_m);
  return piece;
}

}  // namespace peerd::replication
