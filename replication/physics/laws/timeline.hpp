#pragma once
#include <cassert>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/prefetch.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/motion_model.hpp"

namespace peerd::replication {

// The motion of one object over time: models, each in force from its own instant to the next one's, as pieces of
// constant acceleration and spin (motion_model.hpp). Evaluation always starts from the model's base state, so nothing
// accumulates. A timeline is for one thread at a time, reading included.
class Timeline {
 public:
  struct Segment {
    MotionModel model;  // its base is `from`
    SimTime from;
    std::optional<ObjectId> cause;  // the other object of the contact that began it; none: it was set from outside
  };

  Timeline(SimTime from, const MotionModel& model) : last_{model, from, std::nullopt} {}

  // Sets the object's motion from t on, and drops every prediction of t and later.
  void replace_from(SimTime t, const MotionModel& model, std::optional<ObjectId> cause);
  // Does the same, and forgets where the object was before t.
  void restart(SimTime t, const MotionModel& model) {
    past_.clear();
    set_last(t, model, std::nullopt);
    piece_.end = SimTime::min();
  }
  // The timeline is relative to another frame from now on, that stands still as `frame` in the one before: all its
  // laws are those of the same motion (in_frame()).
  void change_frame(const Pose& frame);
  // Forgets the segments that begin at t or later; the first one always stays.
  void truncate_from(SimTime t);
  // Forgets segments that ended before t. The segments that stay are moved, so it is better to forget many at once.
  void forget_before(SimTime t);

  // The state at t by the piece in force then. Before the first segment the object has not moved yet.
  [[nodiscard]] KinematicState at(SimTime t) const {
    return in_piece(t) ? advance(piece_.state, to_seconds(t - piece_.begin)) : at_other_piece(t);
  }
  // The state at t by the closed form of the law in force, which no piece rounds.
  [[nodiscard]] KinematicState exact_at(SimTime t) const;
  // The law in force at t, based there: the pose of at(t), with the derivatives of the closed form.
  [[nodiscard]] MotionModel model_at(SimTime t) const;
  // The segment in force at t; the instant at which it or its piece in force began (none: the object has not moved
  // yet, or it always stood there); and the instant at which the next segment or piece begins (none: never).
  [[nodiscard]] const Segment& segment_at(SimTime t) const;
  [[nodiscard]] std::optional<SimTime> last_change_until(SimTime t) const;
  [[nodiscard]] std::optional<SimTime> next_change_after(SimTime t) const;
  // The span around t in which the motion is one smooth closed form; none: it has always been, or will be for ever.
  struct Span {
    std::optional<SimTime> begin, end;
  };
  [[nodiscard]] Span smooth_around(SimTime t) const;

  // For a caller that asks for many objects in turn: fetches what at(t) reads from memory. First the piece; once that
  // is there, the law, if the piece does not answer for t.
  [[gnu::always_inline]] inline void prefetch_piece() const { prefetch(piece_); }
  [[gnu::always_inline]] inline void prefetch_law(SimTime t) const {
    if (!in_piece(t)) prefetch(last_);
  }

  [[nodiscard]] SimTime begin() const { return segment(0).from; }
  // The number of segments, at least one; their `from` strictly increases.
  [[nodiscard]] std::size_t segment_count() const { return past_.size() + 1; }
  [[nodiscard]] const Segment& segment(std::size_t i) const {
    assert(i <= past_.size());
    return i < past_.size() ? past_[i] : last_;
  }
  [[nodiscard]] const Segment& last_segment() const { return last_; }
  // The index of the first segment that begins at t or later; the number of segments where none does.
  [[nodiscard]] std::size_t first_not_before(SimTime t) const {
    const std::size_t in_force = index_at(t);
    return segment(in_force).from >= t ? in_force : in_force + 1;
  }

 private:
  // The piece that was used last. The closed form of a law costs up to ten times as much as its piece, and a caller
  // that asks where an object is now asks again soon. Only what at() returns is kept, so no answer depends on earlier
  // questions.
  struct Piece {
    SimTime first = SimTime::max(), end = SimTime::min();  // it answers for the instants in [first, end)
    SimTime begin{};
    KinematicState state;  // at begin
  };
  [[nodiscard]] bool in_piece(SimTime t) const { return t >= piece_.first && t < piece_.end; }

  [[nodiscard]] KinematicState at_other_piece(SimTime t) const;
  [[nodiscard]] std::size_t index_at(SimTime t) const;
  // Part by part: a Segment made first would be copied once more.
  void set_last(SimTime from, const MotionModel& model, std::optional<ObjectId> cause) {
    last_.model = model;
    last_.from = from;
    last_.cause = cause;
  }

  std::vector<Segment> past_;
  Segment last_;  // apart from the others, for it is mostly the one in force, and beside its piece
  mutable Piece piece_;
};

}  // namespace peerd::replication
