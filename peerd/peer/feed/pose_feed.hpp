#pragma once
#include <boost/circular_buffer.hpp>
#include <cstdint>
#include <expected>
#include <optional>

#include "core/kinematics.hpp"
#include "core/time.hpp"

namespace peerd::feed {

// A statement of an external program about an object at one instant, in the world frame and SI units.
struct PoseSample {
  Vec3 position = Vec3::Zero();
  std::optional<Quat> orientation{};            // of about unit length; none: as in the pose before
  std::optional<Vec3> velocity{};               // [m/s]; none: derived from the poses before
  std::optional<Vec3> acceleration{};           // [m/s^2]; none: derived from the poses before
  std::optional<Vec3> angular_velocity_body{};  // [rad/s], body frame; none: derived from the poses before
  bool jump = false;                            // the object was placed: the poses before say nothing of its motion
};

// Why a pose was not used.
enum class Refusal : std::uint8_t {
  kObject,        // no external program moves this object here
  kTime,          // not a Unix time
  kTooOld,        // before now - kAgeMax
  kTooFarAhead,   // after now + kAheadMax
  kDuplicate,     // a pose of that instant is known already
  kPosition,      // beyond kPositionMax_m
  kOrientation,   // not a quaternion of about unit length
  kVelocity,      // beyond kSpeedMax_m_s
  kAcceleration,  // beyond kAccelerationMax_m_s2
  kSpin,          // beyond kSpinMax_rad_s
};
inline constexpr int kRefusals = static_cast<int>(Refusal::kSpin) + 1;
[[nodiscard]] const char* to_string(Refusal);  // one word, for the names of counters
[[nodiscard]] const char* sentence(Refusal);   // one sentence, for the sender of the pose

// A program that goes beyond these limits is broken. They also keep whatever follows from a pose while its object
// coasts within the ranges of an update (1e12 m and 1e4 rad/s: replication/wire/codec.cpp).
inline constexpr double kPositionMax_m = 1e9, kSpeedMax_m_s = 1e6, kAccelerationMax_m_s2 = 1e6, kSpinMax_rad_s = 1e4;
inline constexpr Duration kAgeMax = std::chrono::seconds(1), kAheadMax = std::chrono::milliseconds(250);

// Turns the poses of one object, as an external program sends them, into the object's state at any instant near the
// present: the program's rate and phase are independent of the peer's ticks. Sans-IO: all times are arguments.
//
// The state at t is that of the parabola through the pose next to t and two poses before it (position_history.hpp), or
// through that pose with the velocity that it names and one pose before it. The state does not lag. Where poses name
// their times, are at most d apart and arrive at most j late, the position is off by at most
//   M/6 e (e + g)(e + 2 g),   e = d + j,   g = d where all poses are at least kSpacing apart, else d + kSpacing
// with M the largest |third derivative| (remainder of Newton's interpolation formula), as long as e is not more than
// the parabola's reach into the past, 2 g or a little less. Beyond that reach the motion continues along the tangent.
class PoseFeed {
 public:
  // The least distance in time between the poses of a parabola. Poses that are closer would turn noise of position into
  // noise of velocity; poses without a time have that of their arrival, which queues make uneven.
  static constexpr Duration kSpacing = std::chrono::milliseconds(10);
  static constexpr Duration kSpacingUnstamped = std::chrono::milliseconds(40);

  // `place` is where the object stands before its first pose. After `stale` without a pose the object stops where it
  // is.
  PoseFeed(const Pose& place, Duration stale) : place_(place), stale_(stale) {}

  // Takes a pose of the instant `at`; without one, of `now`, its arrival. Poses may arrive in any order.
  std::expected<void, Refusal> push(HostTime now, std::optional<HostTime> at, const PoseSample& pose);

  [[nodiscard]] bool begun() const { return !poses_.empty(); }
  // Whether the last pose is older than `stale`.
  [[nodiscard]] bool silent(HostTime t) const { return begun() && t - poses_.back().at > stale_; }
  [[nodiscard]] KinematicState at(HostTime t) const;

 private:
  struct Known {
    HostTime at;
    bool stamped;
    PoseSample pose;  // always with an orientation
  };
  using Poses = boost::circular_buffer<Known>;

  [[nodiscard]] Poses::const_iterator not_before(HostTime t) const;
  [[nodiscard]] const Known* before(const Known& later, Duration spacing) const;
  [[nodiscard]] KinematicState advanced_from(const Known& base, double dt_s) const;

  Pose place_;
  Duration stale_;
  Poses poses_;  // by time
};

}  // namespace peerd::feed
