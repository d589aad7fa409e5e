#pragma once
#include "collision/contact/body.hpp"
#include "core/kinematics.hpp"
#include "replication/motion/timeline.hpp"

namespace peerd::replication {

// Where a body can be from some instant on, as long as its timeline's piece and the time that searches look ahead last:
// the box of its bounding sphere's centre, and the sphere's radius. It holds the path at constant acceleration, the
// tangents that a search may take in its place, and all that rounding can add.
struct SweptBound {
  // The piece in force at `s`, in [from, until): what the bound is of.
  std::optional<SimTime> last_change, next_change;  // Timeline's, at s
  bool still = false;                               // neither moves nor turns nor is accelerated at s
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  double radius_m = 0.0;
  SimTime from = SimTime::max(), until = SimTime::min();  // the instants s that it answers for: [from, until)

  [[nodiscard]] bool answers_for(SimTime s) const { return s >= from && s < until; }
};

// Of the instant s; the sweep begins at `begin` <= s or where the piece does, and ends at `end` > s or where the piece
// does.
[[nodiscard]] SweptBound swept_bound(const Timeline& timeline, const collision::Body& body, SimTime s, SimTime begin,
                                     SimTime end);

// Certainly apart all the while that both bounds hold, so that first_contact() would answer kSeparated. NaN is not.
[[nodiscard]] bool apart(const SweptBound& a, const SweptBound& b, CollisionType type);

}  // namespace peerd::replication
