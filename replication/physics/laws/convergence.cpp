#include "replication/physics/laws/convergence.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {
namespace {

// An object may be drawn so far behind the ghost on its way, and a place there is looked for in so many steps. Beyond
// twice the latency of half a second nothing is won.
constexpr Duration kTrailMax = std::chrono::seconds(2);
constexpr int kTrailSteps = 64;
// A step that cuts a corner is halved so often.
constexpr int kHalvings = 6;

// The orientation at that part of the shorter way around, at a rate that is nearly even. Two opposite orientations
// have no shorter way: the result is the later one.
Quat between(const Quat& from, const Quat& to, double part) {
  assert(part >= 0.0 && part <= 1.0);
  const double sign = from.dot(to) < 0.0 ? -1.0 : 1.0;
  const Quat mixed((1.0 - part) * from.coeffs() + (part * sign) * to.coeffs());
  return mixed.norm() > 0x1p-20 ? mixed.normalized() : to;
}

}  // namespace

// The pose at t, which is after last_ and before the end of the way.
Convergence::Drawn Convergence::blended(SimTime t, const KinematicState& ghost) const {
  assert(from_ && last_ && t > last_->at && way_.over > Duration{0});
  const double s = to_seconds(t - from_->at), over = to_seconds(way_.over), part = s / over;
  const Vec3& p0 = from_->pose.position;
  const Vec3& v0 = from_->velocity;
  Drawn out{t, {ghost.position, between(from_->pose.orientation, ghost.orientation, part)}, ghost.velocity};
  const KinematicState end = advance(ghost, over - s);
  switch (way_.method) {
    case ConvergenceMethod::kJump:
      break;
    case ConvergenceMethod::kLinear: {
      // The object goes from here straight to where the way ends, however the ghost has turned since.
      const Vec3 from = last_->pose.position;
      const double left = over - to_seconds(last_->at - from_->at);
      out.velocity = (end.position - from) / left;
      out.pose.position = from + out.velocity * to_seconds(t - last_->at);
      break;
    }
    case ConvergenceMethod::kCubic: {
      const Vec3 blended_velocity = v0 + (ghost.velocity - v0) * part;
      const Vec3 old = p0 + s * (blended_velocity + (0.5 * s) * ghost.acceleration);
      out.pose.position = old + (ghost.position - old) * part;
      out.velocity = (out.pose.position - last_->pose.position) / to_seconds(t - last_->at);
      break;
    }
    case ConvergenceMethod::kAdaptive:  // adapt() has chosen another one
    case ConvergenceMethod::kParabola: {
      const Vec3 bend = (end.position - p0 - over * v0) / (over * over);
      out.pose.position = p0 + s * (v0 + s * bend);
      out.velocity = v0 + (2.0 * s) * bend;
      break;
    }
  }
  return out;
}

// The latest time at which the ghost was at a place that the object may reach at once.
std::optional<SimTime> Convergence::reachable(SimTime t, const MayPass& may_pass, const GhostPoseAt& was) const {
  assert(last_ && was);
  for (int i = 0; i <= kTrailSteps; ++i) {
    const SimTime earlier = t - i * (kTrailMax / kTrailSteps);
    const auto pose = was(earlier);
    if (!pose) break;
    if (may_pass(last_->pose.position, pose->position)) return earlier;
  }
  return std::nullopt;
}

// The object goes on along the ghost's way, so fast that it catches up when the time of the way back is over; more
// slowly where a straight step would cut a corner, and ahead where the next part of the way is barred by now. None:
// nothing is free.
std::optional<Convergence::Drawn> Convergence::trailing(SimTime t, const MayPass& may_pass, const GhostPoseAt& was) {
  assert(from_ && last_ && trail_ && t > last_->at);
  const auto draw = [&](SimTime at) -> std::optional<Drawn> {
    const auto pose = was(at);
    if (!pose || !may_pass(last_->pose.position, pose->position)) return std::nullopt;
    trail_ = {at, t};
    return Drawn{t, *pose, (pose->position - last_->pose.position) / to_seconds(t - last_->at)};
  };
  const Duration left = std::max(Duration{0}, from_->at + way_.over - t), step = t - last_->at;
  const double part = static_cast<double>(left.count()) / static_cast<double>((left + step).count());
  const Duration behind = std::max(Duration{0}, last_->at - trail_->at);
  const SimTime wanted = t - Duration{static_cast<std::int64_t>(part * static_cast<double>(behind.count()))};
  const Duration on = wanted - trail_->at;
  for (int i = 0; i < kHalvings; ++i) {
    if (auto drawn = draw(trail_->at + on / (1 << i))) return drawn;
  }
  for (int i = 1; wanted < t && i <= kTrailSteps; ++i) {
    if (auto drawn = draw(wanted + i * (t - wanted) / kTrailSteps)) return drawn;
  }
  // The place that reachable() has found.
  if (const auto pose = was(trail_->at); pose && may_pass(last_->pose.position, pose->position)) {
    const bool moves = pose->position != last_->pose.position;
    if (moves || t - trail_->moved_at <= way_.over) {
      if (moves) trail_->moved_at = t;
      return Drawn{t, *pose, (pose->position - last_->pose.position) / to_seconds(t - last_->at)};
    }
    return std::nullopt;
  }
  const bool may_stay = may_pass(last_->pose.position, last_->pose.position);
  if (!may_stay || t - trail_->moved_at > way_.over) return std::nullopt;
  return Drawn{t, last_->pose, Vec3::Zero()};
}

// Ohlenburg 2003, section 4.2.3: first-order convergence where the angle between the three positions is large. How
// large is not said there; from 165 degrees on they count as a line. The way back takes the time between the last two
// updates, after which another one is to be expected, and no longer than the policy says.
void Convergence::adapt(SimTime t, const Vec3& ghost) {
  constexpr double kCosLine = -0.9659258262890683;  // of 165 degrees
  way_ = {ConvergenceMethod::kParabola, policy_.over};
  if (last_change_) way_.over = std::min(policy_.over, t - last_change_->at);
  if (last_change_ && change_before_) {
    const Vec3 back = change_before_->position - last_change_->position, on = ghost - last_change_->position;
    if (back.dot(on) <= kCosLine * back.norm() * on.norm()) way_.method = ConvergenceMethod::kLinear;
  }
  change_before_ = last_change_;
  last_change_ = Change{t, ghost};
}

Pose Convergence::shown(SimTime t, const KinematicState& ghost, std::uint64_t revision, const MayPass& may_pass,
                        const GhostPoseAt& was) {
  const bool ghost_changed = revision_ && *revision_ != revision;
  revision_ = revision;
  if (ghost_changed && policy_.method == ConvergenceMethod::kAdaptive) adapt(t, ghost.position);
  if (ghost_changed && last_ && way_.method != ConvergenceMethod::kJump && way_.over > Duration{0}) {
    from_ = last_;
    trail_.reset();
  }
  if (from_ && !trail_ && t - from_->at >= way_.over) from_.reset();
  if (from_ && t <= last_->at) return last_->pose;
  std::optional<Drawn> way;
  if (from_ && !trail_) {
    way = blended(t, ghost);
    if (!may_pass(last_->pose.position, way->pose.position)) {
      way.reset();
      const auto at = was ? reachable(t, may_pass, was) : std::nullopt;
      if (at) {
        trail_ = {*at, t};
        ++detours_;
      }
    }
  }
  if (trail_) way = trailing(t, may_pass, was);
  if (from_ && !way) ++blocked_;
  const bool caught_up = trail_ && way && trail_->at >= t;
  if (!way || caught_up) {
    from_.reset();
    trail_.reset();
  }
  assert(!trail_ || from_);
  last_ = way.value_or(Drawn{t, ghost.pose(), ghost.velocity});
  return last_->pose;
}

}  // namespace peerd::replication
