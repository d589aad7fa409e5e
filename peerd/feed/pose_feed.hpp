#pragma once
#include <boost/circular_buffer.hpp>
#include <cstdint>
#include <expected>
#include <optional>

#include "core/kinematics.hpp"
#include "core/time.hpp"

namespace peerd::feed {

// What a program says of an object at one instant. World frame, SI units.
struct PoseSample {
  Vec3 position = Vec3::Zero();
  std::optional<Quat> orientation{};            // of about unit length; none: as in the pose before
  std::optional<Vec3> velocity{};               // [m/s]; what is not given is found from the poses before
  std::optional<Vec3> acceleration{};           // [m/s^2]
  std::optional<Vec3> angular_velocity_body{};  // [rad/s], body frame
  bool jump = false;                            // it was put there: the poses before do not tell how it moves
};

// Why a pose was not used.
enum class Refusal : std::uint8_t {
  kObject,        // not fed here
  kTime,          // no Unix time
  kTooOld,        // before now - kAgeMax
  kTooFarAhead,   // after now + kAheadMax
  kDuplicate,     // there is one of that instant already
  kPosition,      // beyond kPositionMax_m
  kOrientation,   // no quaternion of about unit length
  kVelocity,      // beyond kSpeedMax_m_s
  kAcceleration,  // beyond kAccelerationMax_m_s2
  kSpin,          // beyond kSpinMax_rad_s
};
inline constexpr int kRefusals = static_cast<int>(Refusal::kSpin) + 1;
[[nodiscard]] const char* to_string(Refusal);  // a word, for counters
[[nodiscard]] const char* sentence(Refusal);   // for whoever sent it

// Farther or faster than this is not a world of metres and seconds but a broken program; with what follows from it
// while the object coasts, all stays where an update can tell of it (1e12, and 1e4 rad/s: replication/wire/codec.cpp).
inline constexpr double kPositionMax_m = 1e9, kSpeedMax_m_s = 1e6, kAccelerationMax_m_s2 = 1e6, kSpinMax_rad_s = 1e4;
inline constexpr Duration kAgeMax = std::chrono::seconds(1), kAheadMax = std::chrono::milliseconds(250);

// The poses of one object, as a program sends them, made into its state at any instant about now: the program's rate
// and phase are not the peer's ticks'. Sans-IO: all times come as arguments.
//
// The state at t is that of the parabola through the pose next to t and two before it (position_history.hpp), or
// through that pose with the velocity that it names and one before it. It does not lag. Where poses tell their time,
// are at most d apart and heard at most j after it, the position is off by at most
//   M/6 e (e + g)(e + 2 g),   e = d + j,   g = d where all are at least kSpacing apart, else d + kSpacing
// with M the largest |third derivative| (remainder of Newton's interpolation formula), as long as e is not more than
// what the parabola reaches back, 2 g or a little less. Beyond that the motion goes straight on.
class PoseFeed {
 public:
  // Poses that the parabola goes through are at least so far apart: nearer ones would make noise of position into noise
  // of velocity, and poses without a time of their own have that of their arrival, which queues make uneven.
  static constexpr Duration kSpacing = std::chrono::milliseconds(10);
  static constexpr Duration kSpacingUnstamped = std::chrono::milliseconds(40);

  // place: where it stands before the first pose. Without a pose for longer than `stale` it stands where it then is.
  PoseFeed(const Pose& place, Duration stale) : place_(place), stale_(stale) {}

  // A pose of `at`, or else of now, its arrival. Poses may come in any order.
  std::expected<void, Refusal> push(HostTime now, std::optional<HostTime> at, const PoseSample& pose);

  [[nodiscard]] bool begun() const { return !poses_.empty(); }
  // Whether the last pose is longer ago than `stale`.
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
