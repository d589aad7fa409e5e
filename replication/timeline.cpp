#include "replication/timeline.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {
namespace {

constexpr auto begins_after = [](SimTime t, const Timeline::Segment& s) { return t < s.from; };

}  // namespace

void Timeline::replace_from(SimTime t, const MotionModel& model, std::optional<ObjectId> cause) {
  while (!segments_.empty() && segments_.back().from >= t) segments_.pop_back();
  segments_.push_back({t, model, cause});
}

void Timeline::truncate_from(SimTime t) {
  while (segments_.size() > 1 && segments_.back().from >= t) segments_.pop_back();
}

void Timeline::forget_before(SimTime t) {
  const auto keep = std::upper_bound(segments_.begin(), segments_.end(), t, begins_after);
  if (keep - segments_.begin() > 1) segments_.erase(segments_.begin(), keep - 1);
}

const Timeline::Segment& Timeline::segment_at(SimTime t) const {
  assert(!segments_.empty());
  const auto next = std::upper_bound(segments_.begin(), segments_.end(), t, begins_after);
  return next == segments_.begin() ? segments_.front() : *(next - 1);
}

std::optional<SimTime> Timeline::last_change_until(SimTime t) const {
  const Segment& s = segment_at(t);
  const KinematicState& base = s.model.state;
  const bool stands = base.velocity.isZero(0.0) && base.acceleration.isZero(0.0) &&
                      base.angular_velocity_body.isZero(0.0) && s.model.jerk.isZero(0.0) &&
                      s.model.angular_acceleration_body.isZero(0.0);
  if (t < s.from || (&s == segments_.data() && stands)) return std::nullopt;
  return s.from + piece_begin(s.model, t - s.from);
}

std::optional<SimTime> Timeline::next_change_after(SimTime t) const {
  const auto next = std::upper_bound(segments_.begin(), segments_.end(), t, begins_after);
  std::optional<SimTime> change;
  if (next != segments_.end()) change = next->from;
  if (next == segments_.begin()) return change;
  const Segment& s = *(next - 1);
  if (const auto end = piece_end(s.model, t - s.from); end && (!change || s.from + *end < *change)) {
    change = s.from + *end;
  }
  return change;
}

KinematicState Timeline::at(SimTime t) const {
  const Segment& s = segment_at(t);
  if (t <= s.from) return s.model.state;
  const MotionPiece piece = piece_at(s.model, t - s.from);
  return advance(piece.state, to_seconds(t - s.from - piece.begin));
}

MotionModel Timeline::model_at(SimTime t) const {
  const Segment& s = segment_at(t);
  if (t <= s.from) return s.model;
  MotionModel model = rebased(s.model, to_seconds(t - s.from));
  const KinematicState state = at(t);
  model.state.position = state.position;
  model.state.orientation = state.orientation;
  return model;
}

}  // namespace peerd::replication
