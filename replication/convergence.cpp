#include "replication/convergence.hpp"

namespace peerd::replication {
namespace {

// The shorter way around, at a rate that is nearly even. Two opposite orientations have no way: the later one.
Quat between(const Quat& from, const Quat& to, double part) {
  const double sign = from.dot(to) < 0.0 ? -1.0 : 1.0;
  const Quat mixed((1.0 - part) * from.coeffs() + (part * sign) * to.coeffs());
  return mixed.norm() > 0x1p-20 ? mixed.normalized() : to;
}

}  // namespace

// After last_, and before the end of the way.
Convergence::Drawn Convergence::blended(SimTime t, const KinematicState& ghost) const {
  const double s = to_seconds(t - from_->at), over = to_seconds(policy_.over), part = s / over;
  const Vec3& p0 = from_->pose.position;
  const Vec3& v0 = from_->velocity;
  Drawn out{t, {ghost.position, between(from_->pose.orientation, ghost.orientation, part)}, ghost.velocity};
  const KinematicState end = advance(ghost, over - s);
  switch (policy_.method) {
    case ConvergenceMethod::kJump:
      break;
    case ConvergenceMethod::kLinear: {
      // From here straight on to where it ends, however the ghost has turned since.
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
    case ConvergenceMethod::kParabola: {
      const Vec3 bend = (end.position - p0 - over * v0) / (over * over);
      out.pose.position = p0 + s * (v0 + s * bend);
      out.velocity = v0 + (2.0 * s) * bend;
      break;
    }
  }
  return out;
}

Pose Convergence::shown(SimTime t, const KinematicState& ghost, std::uint64_t revision, const MayPass& may_pass) {
  const bool news = revision_ && *revision_ != revision;
  revision_ = revision;
  if (news && last_ && policy_.method != ConvergenceMethod::kJump && policy_.over > Duration{0}) from_ = last_;
  if (from_ && t - from_->at >= policy_.over) from_.reset();
  Drawn drawn{t, ghost.pose(), ghost.velocity};
  if (from_ && t > last_->at) {
    const Drawn way = blended(t, ghost);
    if (may_pass(last_->pose.position, way.pose.position)) {
      drawn = way;
    } else {
      ++blocked_;
      from_.reset();
    }
  } else if (from_) {
    return last_->pose;
  }
  last_ = drawn;
  return drawn.pose;
}

}  // namespace peerd::replication
