#pragma once
#include <cstdint>

#include "replication/physics/laws/swept_bound.hpp"
#include "replication/physics/world/part_query.hpp"

namespace peerd::replication {

// The bound of a part as it goes on from s until `end`, or until a law or what flexes it changes: a box of its vertices
// and of all that their speeds may add. For parts whose way no piece describes.
[[nodiscard]] SweptBound swept_bound_of_way(const MovingPart& part, SimTime s, SimTime end);

// Finds the first contact of two sides in [from, until). All motions go on without a change from `begin` <= from until
// then, those by coarse pieces included; the search begins at `begin` as long as it finds nothing before `from`,
// because contact times must not depend on when they are asked for. Exact motion is searched as it is. Composed motion
// is searched by coarse pieces with a margin of their error, and from what they find on by fine ones: a contact is
// never late, and the parts are then no farther apart than 1e-6 m and twice the errors of the fine pieces. A law that
// pieces only come near (motion_model.hpp) is searched like that where the two meet as polygons; those that answer each
// other meet as they are predicted, by the law's own pieces. Flexible parts are searched in the same two ways
// (flexible_contact.hpp). Where the query has a TickDetection, that searches instead, and says what touches.
// `searches` counts calls of collision.
[[nodiscard]] PartContact first_part_contact(const PartQuery& query, SimTime begin, SimTime from, SimTime until,
                                             std::uint64_t& searches);

// Whether the two sides touch at t, or are nearer than contact times leave them.
[[nodiscard]] bool parts_touch(const PartQuery& query, SimTime t);

// For two sides that touch at t: an instant, after t and no later than `until`, before which they certainly go on to
// touch, by how deep they are in each other; but at least kTouchCheck, so that two that part for less may not be seen
// to.
inline constexpr Duration kTouchCheck{std::int64_t{1} << 20};
[[nodiscard]] SimTime parts_touch_until(const PartQuery& query, SimTime t, SimTime until);

}  // namespace peerd::replication
