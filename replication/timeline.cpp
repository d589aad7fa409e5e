#include "replication/timeline.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {
namespace {

constexpr auto begins_after = [](SimTime t, const Timeline::Segment& s) { return t < s.from; };

}  // namespace

void Timeline::replace_from(SimTime t, const MotionModel& model, std::optional<ObjectId> cause) {
  piece_.end = std::min(piece_.end, t);
  while (!segments_.empty() && segments_.back().from >= t) segments_.pop_back();
  segments_.push_back({t, model, cause});
}

void Timeline::truncate_from(SimTime t) {
  piece_.end = std::min(piece_.end, t);
  while (segments_.size() > 1 && segments_.back().from >= t) segments_.pop_back();
}

void Timeline::forget_before(SimTime t) {
  const auto next = std::upper_bound(segments_.begin() + 1, segments_.end(), t, begins_after);
  if (next == segments_.begin() + 1) return;
  segments_.erase(segments_.begin(), next - 1);
  if (piece_.first <= begin()) piece_.end = SimTime::min();
}

const Timeline::Segment& Timeline::segment_at(SimTime t) const {
  const std::span<const Segment> all = segments();
  assert(!all.empty());
  if (all.back().from <= t) return all.back();
  const auto next = std::upper_bound(all.begin(), all.end(), t, begins_after);
  return next == all.begin() ? all.front() : *(next - 1);
}

std::optional<SimTime> Timeline::last_change_until(SimTime t) const {
  const Segment& s = segment_at(t);
  const KinematicState& base = s.model.state;
  const bool stands = base.velocity.isZero(0.0) && base.acceleration.isZero(0.0) &&
                      base.angular_velocity_body.isZero(0.0) && s.model.jerk.isZero(0.0) &&
                      s.model.angular_acceleration_body.isZero(0.0);
  if (t < s.from || (&s == &segments().front() && stands)) return std::nullopt;
  return in_piece(t) ? piece_.begin : s.from + piece_begin(s.model, t - s.from);
}

std::optional<SimTime> Timeline::next_change_after(SimTime t) const {
  const std::span<const Segment> all = segments();
  const Segment& s = segment_at(t);
  if (t < s.from) return s.from;
  std::optional<SimTime> change;
  if (&s != &all.back()) change = (&s + 1)->from;
  if (const auto end = piece_end(s.model, t - s.from); end && (!change || s.from + *end < *change)) {
    change = s.from + *end;
  }
  return change;
}

KinematicState Timeline::at(SimTime t) const {
  if (!in_piece(t)) {
    const Segment& s = segment_at(t);
    if (t <= s.from) return s.model.state;
    const MotionPiece piece = piece_at(s.model, t - s.from);
    piece_.begin = s.from + piece.begin;
    piece_.first = std::max(piece_.begin, s.from + Duration{1});
    piece_.end = piece.end ? s.from + *piece.end : SimTime::max();
    if (&s != &segments().back()) piece_.end = std::min(piece_.end, (&s + 1)->from);
    piece_.state = piece.state;
  }
  return advance(piece_.state, to_seconds(t - piece_.begin));
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
