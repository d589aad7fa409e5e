#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>

#include "collision/contact/contact_time.hpp"
#include "core/time.hpp"
#include "replication/motion/composed_motion.hpp"
#include "replication/motion/flexible_parts.hpp"
#include "replication/motion/swept_bound.hpp"

namespace peerd::replication {

// A part of an end of an interest, and what moves it in the frame in which it is to meet others: a rigid body, or a
// flexible part, whose chain is empty where nothing carries it.
struct MovingPart {
  Chain chain;
  const collision::Body* body = nullptr;
  FlexibleParts* flexible = nullptr;  // where there is no body
  std::uint32_t form = 0;             // in `flexible`

  // No vertex of the body is farther from the part's origin [m].
  [[nodiscard]] double reach_m() const { return body->center.norm() + body->radius_m; }
};

// The bound of a part as it goes on from s until `end`, or until a law or what flexes it changes: a box of its vertices
// and of all that their speeds may add. For parts whose way no piece describes.
[[nodiscard]] SweptBound swept_bound_of_way(const MovingPart& part, SimTime s, SimTime end);

// Two sides that may meet: a part each, or for CollisionType::kBox all parts of two ends.
struct PartQuery {
  std::span<const MovingPart> a, b;
  CollisionType type = CollisionType::kWitness;
  collision::MeetAs as = collision::MeetAs::kSolids;

  [[nodiscard]] bool is_flexible() const {
    const auto flexes = [](const MovingPart& part) { return part.flexible != nullptr; };
    return std::ranges::any_of(a, flexes) || std::ranges::any_of(b, flexes);
  }
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
// late, and the parts are then no farther apart than 1e-6 m and the errors of the two fine pieces. Flexible parts are
// searched in the same two ways (flexible_contact.hpp). `searches` counts calls of collision.
[[nodiscard]] PartContact first_part_contact(const PartQuery& query, SimTime begin, SimTime from, SimTime until,
                                             std::uint64_t& searches);

// Whether the two sides touch at t, or are nearer than contact times leave them.
[[nodiscard]] bool parts_touch(const PartQuery& query, SimTime t);

// For two sides that touch at t: an instant, after t and no later than `until`, before which they certainly go on to
// touch, by how deep they are in each other; but at least kTouchCheck, so that two that part for less may not be seen to.
inline constexpr Duration kTouchCheck{std::int64_t{1} << 20};
[[nodiscard]] SimTime parts_touch_until(const PartQuery& query, SimTime t, SimTime until);

}  // namespace peerd::replication
