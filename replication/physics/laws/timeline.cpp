#include "replication/physics/laws/timeline.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {
namespace {

constexpr auto begins_after = [](SimTime t, const Timeline::Segment& s) { return t < s.from; };

}  // namespace

void Timeline::replace_from(SimTime t, const MotionModel& model, std::optional<ObjectId> cause) {
  piece_.end = std::min(piece_.end, t);
  if (last_.from < t) {
    past_.push_back(last_);
  } else {
    while (!past_.empty() && past_.back().from >= t) past_.pop_back();
  }
  set_last(t, model, cause);
  assert(past_.empty() || past_.back().from < last_.from);
}

void Timeline::change_frame(const Pose& frame) {
  for (Segment& s : past_) s.model = in_frame(frame, s.model);
  last_.model = in_frame(frame, last_.model);
  piece_.end = SimTime::min();
}

void Timeline::truncate_from(SimTime t) {
  piece_.end = std::min(piece_.end, t);
  for (; !past_.empty() && last_.from >= t; past_.pop_back()) last_ = past_.back();
  assert(past_.empty() || past_.back().from < last_.from);
}

void Timeline::forget_before(SimTime t) {
  const std::size_t first = index_at(t);
  if (first == 0) return;
  past_.erase(past_.begin(), past_.begin() + static_cast<std::ptrdiff_t>(first));
  assert(begin() <= t);
  if (piece_.first <= begin()) piece_.end = SimTime::min();
}

// The index of the segment in force at t; 0 before the first one.
std::size_t Timeline::index_at(SimTime t) const {
  if (last_.from <= t) return past_.size();
  const auto next = std::upper_bound(past_.begin(), past_.end(), t, begins_after);
  return next == past_.begin() ? 0 : static_cast<std::size_t>(next - past_.begin()) - 1;
}

const Timeline::Segment& Timeline::segment_at(SimTime t) const {
  return last_.from <= t ? last_ : segment(index_at(t));
}

std::optional<SimTime> Timeline::last_change_until(SimTime t) const {
  const Segment& s = segment_at(t);
  const bool stays =
      is_motionless(s.model.state) && s.model.jerk.isZero(0.0) && s.model.angular_acceleration_body.isZero(0.0);
  if (t < s.from || (&s == &segment(0) && stays)) return std::nullopt;
  return in_piece(t) ? piece_.begin : s.from + piece_begin(s.model, t - s.from);
}

std::optional<SimTime> Timeline::next_change_after(SimTime t) const {
  const std::size_t i = index_at(t);
  const Segment& s = segment(i);
  if (t < s.from) return s.from;
  std::optional<SimTime> change;
  if (&s != &last_) change = segment(i + 1).from;
  if (const auto end = piece_end(s.model, t - s.from); end && (!change || s.from + *end < *change)) {
    change = s.from + *end;
  }
  assert(!change || *change > t);
  return change;
}

KinematicState Timeline::at_other_piece(SimTime t) const {
  const std::size_t i = index_at(t);
  const Segment& s = segment(i);
  if (t <= s.from) return s.model.state;
  const MotionPiece piece = piece_at(s.model, t - s.from);
  piece_.begin = s.from + piece.begin;
  piece_.first = std::max(piece_.begin, s.from + Duration{1});
  piece_.end = piece.end ? s.from + *piece.end : SimTime::max();
  if (&s != &last_) piece_.end = std::min(piece_.end, segment(i + 1).from);
  piece_.state = piece.state;
  assert(in_piece(t));
  return advance(piece_.state, to_seconds(t - piece_.begin));
}

KinematicState Timeline::exact_at(SimTime t) const {
  const Segment& s = segment_at(t);
  return t <= s.from ? s.model.state : evaluate(s.model, to_seconds(t - s.from));
}

Timeline::Span Timeline::smooth_around(SimTime t) const {
  const std::size_t i = index_at(t);
  const Segment& s = segment(i);
  if (t < s.from) return {std::nullopt, s.from};
  const SmoothSpan law = smooth_span(s.model, t - s.from);
  Span span{s.from + law.begin, std::nullopt};
  if (law.end) span.end = s.from + *law.end;
  if (&s != &last_ && (!span.end || segment(i + 1).from < *span.end)) span.end = segment(i + 1).from;
  assert(!span.end || *span.end > t);
  return span;
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
