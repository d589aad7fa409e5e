#include "peerd/peer/feed/pose_feed.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "replication/physics/laws/position_history.hpp"

namespace peerd::feed {
namespace {

// The capacity suffices for poses at 1 kHz that are sent as far ahead as is allowed, and for the parabola's reach into
// the past.
constexpr std::size_t kPosesMax = 512;
constexpr std::size_t kPosesMin = 3;  // kept however old they are, for slow programs
constexpr Duration kMemory = std::chrono::seconds(1);

// The comparison is written so that a NaN is beyond the limit, too.
bool within(const std::optional<Vec3>& v, double most) { return !v || v->norm() <= most; }

std::optional<Refusal> reason_to_refuse(const PoseSample& p) {
  if (!(p.position.norm() <= kPositionMax_m)) return Refusal::kPosition;
  // The tolerance admits programs that print few digits, and refuses angles or zeros in the quaternion's place.
  if (p.orientation && !(p.orientation->squaredNorm() > 0.5 && p.orientation->squaredNorm() < 2.0)) {
    return Refusal::kOrientation;
  }
  if (!within(p.velocity, kSpeedMax_m_s)) return Refusal::kVelocity;
  if (!within(p.acceleration, kAccelerationMax_m_s2)) return Refusal::kAcceleration;
  if (!within(p.angular_velocity_body, kSpinMax_rad_s)) return Refusal::kSpin;
  return std::nullopt;
}

}  // namespace

const char* to_string(Refusal refusal) {
  switch (refusal) {
    case Refusal::kObject:
      return "object";
    case Refusal::kTime:
      return "time";
    case Refusal::kTooOld:
      return "too_old";
    case Refusal::kTooFarAhead:
      return "too_far_ahead";
    case Refusal::kDuplicate:
      return "duplicate";
    case Refusal::kPosition:
      return "position";
    case Refusal::kOrientation:
      return "orientation";
    case Refusal::kVelocity:
      return "velocity";
    case Refusal::kAcceleration:
      return "acceleration";
    case Refusal::kSpin:
      return "spin";
  }
  return "?";
}

const char* sentence(Refusal refusal) {
  switch (refusal) {
    case Refusal::kObject:
      return "no object of that name is moved by a program here (motion.OBJECT.outside = true), nor grabbed by this "
             "peer";
    case Refusal::kTime:
      return "\"time_s\" must be Unix time, from 0 to 9e9 s";
    case Refusal::kTooOld:
      return "it is more than 1 s old by this computer's clock; \"time_s\" is Unix time";
    case Refusal::kTooFarAhead:
      return "it is more than 0.25 s ahead of this computer's clock; \"time_s\" is Unix time";
    case Refusal::kDuplicate:
      return "there is another pose of that instant";
    case Refusal::kPosition:
      return "\"position_m\" is farther out than 1e9 m";
    case Refusal::kOrientation:
      return "\"orientation_xyzw\" is no unit quaternion";
    case Refusal::kVelocity:
      return "\"velocity_m_s\" is faster than 1e6 m/s";
    case Refusal::kAcceleration:
      return "\"acceleration_m_s2\" is more than 1e6 m/s^2";
    case Refusal::kSpin:
      return "\"angular_velocity_rad_s\" is more than 1e4 rad/s";
  }
  return "?";
}

std::expected<void, Refusal> PoseFeed::push(HostTime now, std::optional<HostTime> at, const PoseSample& pose) {
  if (const auto wrong = reason_to_refuse(pose)) return std::unexpected(*wrong);
  const HostTime t = at.value_or(now);
  if (t < now - kAgeMax) return std::unexpected(Refusal::kTooOld);
  if (t > now + kAheadMax) return std::unexpected(Refusal::kTooFarAhead);
  if (poses_.full()) poses_.set_capacity(std::clamp<std::size_t>(2 * poses_.size(), 16, kPosesMax));
  const auto next = not_before(t);
  if (next != poses_.end() && next->at == t) return std::unexpected(Refusal::kDuplicate);
  Known known{t, at.has_value(), pose};
  if (pose.orientation) {
    known.pose.orientation = pose.orientation->normalized();
  } else {
    known.pose.orientation = next == poses_.begin() ? place_.orientation : *std::prev(next)->pose.orientation;
  }
  // With kPosesMax poses the new one replaces the oldest.
  poses_.insert(poses_.begin() + (next - poses_.cbegin()), std::move(known));
  const HostTime oldest = poses_.back().at - kMemory;
  while (poses_.size() > kPosesMin && poses_.front().at < oldest) poses_.pop_front();
  return {};
}

// Returns the first pose that is not before t: most often one of the last two, or the end.
PoseFeed::Poses::const_iterator PoseFeed::not_before(HostTime t) const {
  auto at = poses_.end();
  for (int newest = 0; newest < 2; ++newest) {
    if (at == poses_.begin() || std::prev(at)->at < t) return at;
    --at;
  }
  return std::ranges::lower_bound(poses_.begin(), at, t, {}, &Known::at);
}

// Returns the newest pose that is at least `spacing` before `later` and belongs to the same run, which means that
// neither a jump nor a silence lies between the two; null where there is no such pose.
const PoseFeed::Known* PoseFeed::before(const Known& later, Duration spacing) const {
  auto at = not_before(later.at);
  while (at != poses_.begin() && !at->pose.jump && at->at - std::prev(at)->at <= stale_) {
    --at;
    if (later.at - at->at >= spacing) return &*at;
  }
  return nullptr;
}

KinematicState PoseFeed::advanced_from(const Known& base, double dt_s) const {
  const PoseSample& pose = base.pose;
  KinematicState s = at_rest({pose.position, *pose.orientation});
  const Duration spacing = base.stamped ? kSpacing : kSpacingUnstamped;
  const Known* const one = before(base, spacing);
  const Known* const two = one == nullptr ? nullptr : before(*one, spacing);
  double reach_s = 0.0;  // the parabola holds as far ahead as it reaches back, beyond that its tangent
  if (pose.velocity) {
    s.velocity = *pose.velocity;
    // A sharp turn gets no acceleration, as in position_history().
    const Vec3 newer = one == nullptr ? Vec3::Zero() : Vec3(pose.position - one->pose.position);
    const Vec3 older = two == nullptr ? newer : Vec3(one->pose.position - two->pose.position);
    if (one != nullptr && s.velocity.dot(newer) >= 0.0 && newer.dot(older) >= 0.0) {
      const Known& oldest = two == nullptr ? *one : *two;
      reach_s = to_seconds(base.at - oldest.at);
      s.acceleration = 2.0 / (reach_s * reach_s) * (reach_s * s.velocity - (pose.position - oldest.pose.position));
    }
  } else if (two != nullptr) {
    reach_s = to_seconds(base.at - two->at);
    const auto history = replication::position_history(pose.position, one->pose.position, two->pose.position,
                                                       to_seconds(base.at - one->at), to_seconds(one->at - two->at));
    s.velocity = history.velocity;
    s.acceleration = history.acceleration;
  } else if (one != nullptr) {
    s.velocity = (pose.position - one->pose.position) / to_seconds(base.at - one->at);
  }
  if (!(s.acceleration.norm() <= kAccelerationMax_m_s2)) {  // a jump that the program did not name
    s.acceleration = Vec3::Zero();
    if (!pose.velocity) s.velocity = Vec3::Zero();
  }
  if (!(s.velocity.norm() <= kSpeedMax_m_s)) s.velocity = s.acceleration = Vec3::Zero();
  if (pose.acceleration) {
    s.acceleration = *pose.acceleration;
    reach_s = to_seconds(stale_);
  }
  if (pose.angular_velocity_body) {
    s.angular_velocity_body = *pose.angular_velocity_body;
  } else if (one != nullptr) {
    s.angular_velocity_body =
        replication::spin_between(*one->pose.orientation, *pose.orientation, to_seconds(base.at - one->at));
  }
  if (dt_s <= reach_s) return advance(s, dt_s);
  s = advance(s, reach_s);
  s.acceleration = Vec3::Zero();
  return advance(s, dt_s - reach_s);
}

KinematicState PoseFeed::at(HostTime t) const {
  if (!begun()) return at_rest(place_);
  // The base is the first pose that is not before t, unless that is a later jump; else the pose before it.
  auto base = not_before(t);
  const bool after_t = base != poses_.end() && base->at > t;
  if (base == poses_.end() || (after_t && base->pose.jump && base != poses_.begin())) --base;
  const KinematicState s = advanced_from(*base, to_seconds(std::min(t - base->at, stale_)));
  return t - base->at > stale_ ? at_rest(s.pose()) : s;
}

}  // namespace peerd::feed
