#pragma once
#include <optional>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/time.hpp"

namespace peerd::replication {

// Where one object is over time: pieces of constant acceleration, each from its own instant to the next one's.
// Evaluation always starts from the piece's base state, so nothing accumulates.
class Timeline {
 public:
  struct Segment {
    SimTime from;
    KinematicState state;           // at `from`
    std::optional<ObjectId> cause;  // the other object of the contact that began this piece; none: told from outside
  };

  Timeline(SimTime from, const KinematicState& state) : segments_{{from, state, std::nullopt}} {}

  // From t on, the object moves so; whatever was believed of t and later is gone.
  void replace_from(SimTime t, const KinematicState& state, std::optional<ObjectId> cause);
  // Forgets the pieces that begin at t or later; the first piece always stays.
  void truncate_from(SimTime t);
  // Forgets pieces that ended before t.
  void forget_before(SimTime t);

  // Before the first piece the object has not moved yet.
  [[nodiscard]] KinematicState at(SimTime t) const;
  // The piece in force at t, and when the next one begins (none: never).
  [[nodiscard]] const Segment& segment_at(SimTime t) const;
  [[nodiscard]] std::optional<SimTime> next_change_after(SimTime t) const;

  [[nodiscard]] SimTime begin() const { return segments_.front().from; }
  [[nodiscard]] const std::vector<Segment>& segments() const { return segments_; }

 private:
  std::vector<Segment> segments_;  // strictly increasing `from`; never empty
};

}  // namespace peerd::replication
