#pragma once
#include <cstdint>

#include "replication/physics/world/part_query.hpp"

namespace peerd::replication {

// Contacts of which a side is flexible. Time is cut into steps in which every vertex, those of rigid parts included, is
// taken to go straight on; what its way bends off is bounded by its acceleration, |a| h^2 / 8, and is a margin of the
// search. Steps are coarse at first, and fine where two sides come near (kCoarseError_m, kFineError_m). Answers are
// never late, and early by a distance of at most the margin of a fine step and 1e-6 m.
[[nodiscard]] PartContact first_flexible_contact(const PartQuery& query, SimTime from, SimTime until,
                                                 std::uint64_t& searches);

[[nodiscard]] bool flexible_parts_touch(const PartQuery& query, SimTime t);
// A time for which two sides that touch at t certainly go on to [s], by how deep they are in each other; 0 where
// nothing is known.
[[nodiscard]] double flexible_parts_touch_for_s(const PartQuery& query, SimTime t, SimTime until);

}  // namespace peerd::replication
