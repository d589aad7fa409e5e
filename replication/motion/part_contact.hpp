#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "collision/contact/contact_time.hpp"
#include "core/time.hpp"
#include "replication/motion/composed_motion.hpp"

namespace peerd::replication {

// A rigid part of an end of an interest, and what moves it in the frame in which it is to meet others.
struct MovingPart {
  Chain chain;
  const collision::Body* body;

  // No vertex is farther from the part's origin [m].
  [[nodiscard]] double reach_m() const { return body->center.norm() + body->radius_m; }
};

// Two sides that may meet: a part each, or for CollisionType::kBox all parts of two ends.
struct PartQuery {
  std::span<const MovingPart> a, b;
  CollisionType type = CollisionType::kWitness;
  collision::MeetAs as = collision::MeetAs::kSolids;
};

struct PartContact {
  collision::Contact contact;  // its normal is in the frame of the parts
  SimTime at;                  // the contact time, rounded down to a nanosecond
  KinematicState a, b;         // of the first part of each side, where the search began
};

// How coarse the pieces of composed motion are at first [m], and how fine where two parts come so near.
inline constexpr double kCoarseError_m = 1e-3, kFineError_m = 5e-7;

// Finds the first contact of two sides in [from, until). All motions go on without a change from `begin` <= from until
// then, those by coarse pieces included; the search begins at `begin` as long as it finds nothing before `from`, because
// contact times must not depend on when they are asked for. Exact motion is searched as it is. Composed motion is
// searched by coarse pieces with a margin of their error, and from what they find on by fine ones: a contact is never
// late, and the parts are then no farther apart than 1e-6 m and the errors of the two fine pieces. `searches` counts
// calls of collision.
[[nodiscard]] PartContact first_part_contact(const PartQuery& query, SimTime begin, SimTime from, SimTime until,
                                             std::uint64_t& searches);

// Whether the two sides touch at t, or are nearer than contact times leave them.
[[nodiscard]] bool parts_touch(const PartQuery& query, SimTime t);

// For two sides that touch at t: an instant, after t and no later than `until`, before which they are taken to go on to
// touch. Boxes certainly do; polygons are looked at every kTouchCheck.
inline constexpr Duration kTouchCheck{std::int64_t{1} << 20};
[[nodiscard]] SimTime parts_touch_until(const PartQuery& query, SimTime t, SimTime until);

}  // namespace peerd::replication
