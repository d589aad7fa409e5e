#pragma once
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>

#include "core/kinematics.hpp"
#include "core/time.hpp"

namespace peerd::replication {

// Two places, or orientations, that peers show of an object are the same up to this.
inline constexpr double kSamePlace_m = 1e-6, kSameAngle_rad = 4e-6;

// The law by which an object moves from one instant on. An update names one, and every receiver obeys it.
enum class MotionKind : std::uint8_t {
  kFirst = 1,        // constant velocity
  kSecond = 2,       // constant acceleration, as in ballistic flight: exact after one update
  kHistory = 3,      // like kSecond; velocity and acceleration are of the parabola through three past positions
  kThird = 4,        // constant jerk
  kTurning = 5,      // the acceleration turns about an axis: circles and helices
  kOscillating = 6,  // the acceleration obeys a'' = -rate^2 a on each world axis: springs, arcs, waves, ellipses
  kSliding = 7,      // friction: constant deceleration until the velocity is zero, then rest; its spin likewise
};
inline constexpr MotionKind kMotionKinds[] = {MotionKind::kFirst,  MotionKind::kSecond,  MotionKind::kHistory,
                                              MotionKind::kThird,  MotionKind::kTurning, MotionKind::kOscillating,
                                              MotionKind::kSliding};
[[nodiscard]] const char* to_string(MotionKind);
static_assert([] {  // the codes of the wire are the places in the list, from 1
  for (std::size_t i = 0; i < std::size(kMotionKinds); ++i) {
    if (static_cast<std::size_t>(kMotionKinds[i]) != i + 1) return false;
  }
  return true;
}());

// A law of motion with its parameters, in the world frame and SI units except where a name says body. A parameter that
// the kind does not name is zero.
struct MotionModel {
  KinematicState state;            // at the base instant
  Vec3 jerk = Vec3::Zero();        // [m/s^3] kThird, kOscillating
  Vec3 rate_rad_s = Vec3::Zero();  // kTurning: a vector along the axis; kOscillating: one rate for each axis, >= 0
  Vec3 angular_acceleration_body = Vec3::Zero();  // [rad/s^2] any kind: q(t) = q0 exp(w t + alpha t^2 / 2)
  MotionKind kind = MotionKind::kSecond;

  MotionModel() = default;
  // Constant acceleration and spin, which the rest of the project calls a motion.
  MotionModel(const KinematicState& second_order) : state(second_order) {}  // NOLINT(google-explicit-constructor)
};

// Whether the state has no velocity, acceleration or spin.
[[nodiscard]] inline bool is_motionless(const KinematicState& s) {
  return s.velocity.isZero(0.0) && s.acceleration.isZero(0.0) && s.angular_velocity_body.isZero(0.0);
}

// Whether two states of one object are at one place, as peers show it.
[[nodiscard]] inline bool is_at_same_place(const KinematicState& a, const KinematicState& b) {
  return (a.position - b.position).norm() <= kSamePlace_m &&
         a.orientation.angularDistance(b.orientation) <= kSameAngle_rad;
}

// Whether two states of one body at one instant are of one motion.
[[nodiscard]] inline bool moves_alike(const KinematicState& a, const KinematicState& b) {
  return a.position == b.position && a.velocity == b.velocity && a.acceleration == b.acceleration &&
         a.angular_velocity_body == b.angular_velocity_body;
}

// Rates above this are refused (16 turns a second): a piece of kShortestPiece must stay a small part of a turn.
inline constexpr double kRateMax_rad_s = 100.0;
// A model lasts so long [s]; then the object goes on with the velocity and spin that it has. It is twice the default
// time threshold: by then another update has come, or never will, and a third derivative would lead out of the world.
inline constexpr double kModelLasts_s = 10.0;
// Together with the limits above these bound where a model can lead: to three times the fastest spin of a record.
inline constexpr double kJerkMax_m_s3 = 1e9;
inline constexpr double kSpinAccelerationMax_rad_s2 = 2e3;
// Whether the parameters besides the state are those that the kind names, finite, and within these limits; kFirst has
// no acceleration. Receivers refuse other models.
[[nodiscard]] bool within_limits(const MotionModel& model);

// Pose and derivatives dt_s >= 0 after the base, in closed form, without accumulation.
[[nodiscard]] KinematicState evaluate(const MotionModel& model, double dt_s);
// The position and the orientation alone, each without the work of the other.
[[nodiscard]] Vec3 position_after(const MotionModel& model, double dt_s);
[[nodiscard]] Quat orientation_after(const MotionModel& model, double dt_s);
// The same motion, with a base that is dt_s >= 0 later.
[[nodiscard]] MotionModel rebased(const MotionModel& model, double dt_s);

// Contacts are computed for constant acceleration and spin, so any other motion is *predicted* in pieces of those, the
// same on all peers: on a grid of a power of two of nanoseconds from the base, which the model alone decides. A piece
// goes through the closed form's pose at both ends and its position in the middle. Between them it is off by at most
// |jerk| h^3 / 125 and |alpha| h^2 / 8; h is the longest of 2^22 to 2^27 ns (4 to 134 ms) that keeps these below
// kPieceError_m and kPieceError_rad, for jerks up to 17 km/s^3 and 180 rad/s^2; beyond those h stays at 4 ms and the
// error grows in proportion.
inline constexpr double kPieceError_m = 1e-5;
inline constexpr double kPieceError_rad = 4e-4;  // half of the step to which an update's orientation is rounded
struct MotionPiece {
  Duration begin{0};            // since the base
  std::optional<Duration> end;  // none: it lasts for ever
  KinematicState state;         // at begin
};
[[nodiscard]] MotionPiece piece_at(const MotionModel& model, Duration since_base);
// The instants at which the piece in force then begins and ends, without the work of making it.
[[nodiscard]] Duration piece_begin(const MotionModel& model, Duration since_base);
[[nodiscard]] std::optional<Duration> piece_end(const MotionModel& model, Duration since_base);

// The span of time around an instant in which the law's closed form is smooth: at its end the law goes over into
// another one (it has lasted so long, or friction has stopped something). None: never.
struct SmoothSpan {
  Duration begin{0};  // since the base
  std::optional<Duration> end;
};
[[nodiscard]] SmoothSpan smooth_span(const MotionModel& model, Duration since_base);
// Whether the closed form has constant acceleration and spin while it is smooth: one piece says all of it.
[[nodiscard]] bool is_one_piece(const MotionModel& model);

// Bounds of the closed form while it is smooth: of the distance from the frame's origin and its derivatives, of the
// spin and of its change.
struct MotionBounds {
  double distance_m = 0.0, speed_m_s = 0.0, acceleration_m_s2 = 0.0, jerk_m_s3 = 0.0;
  double spin_rad_s = 0.0, spin_acceleration_rad_s2 = 0.0;
};
// The bounds from dt_s >= 0 after the base until h_s > 0 later.
[[nodiscard]] MotionBounds bounds_within(const MotionModel& model, double dt_s, double h_s);

// The law of the same motion in another frame, that stands still as `frame` in the one before. Where that is turned
// kOscillating, whose axes are those of its frame, becomes kSecond, with the same state.
[[nodiscard]] MotionModel in_frame(const Pose& frame, const MotionModel& model);

// The law of sliding to rest from that velocity with that deceleration [m/s^2], >= 0.
[[nodiscard]] MotionModel sliding_to_rest(const KinematicState& state, double friction_m_s2);

// The model that follows one whose state a contact changed from model.state to `after`; n is the contact's normal, a
// unit vector. Where the velocity was mirrored the law goes on, as of a force that depends on where the object is: odd
// derivatives (velocity, jerk) are mirrored, even ones (acceleration) stay, so that an arc that bounces goes on as its
// mirror image (README.md has figures). Any other response (ZERO, coming to rest) ends the law.
[[nodiscard]] MotionModel after_contact(const MotionModel& model, const KinematicState& after, const Vec3& n,
                                        bool mirrored);

}  // namespace peerd::replication
