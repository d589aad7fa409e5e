#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/least_change.hpp"
#include "replication/physics/world/moving_objects.hpp"
#include "replication/physics/world/watched_pair.hpp"

namespace peerd::replication {

// Objects that touch each other at one instant, as far as they give way, and what they give way to.
struct ContactIsland {
  static constexpr std::uint32_t kNone = MovingObjects::kNone;

  std::vector<std::uint32_t> objects;       // of `bodies`: indices, or kNone for one that does not give way
  std::vector<std::uint32_t> reached_from;  // of `bodies`: the neighbour that led to it; kNone: asked for
  std::vector<ConstrainedBody> bodies;
  std::vector<OneSided> constraints;
  std::vector<std::uint32_t> pairs;  // of each constraint
};
enum class Touching : std::uint8_t { kBearing, kAny };  // the pairs that bear, or all of the burst
enum class Quantity : std::uint8_t { kVelocity, kAcceleration };

// The island around those of these objects that give way at t.
[[nodiscard]] ContactIsland island_of(const WorldModel& model, const MovingObjects& objects, const WatchedPairs& pairs,
                                      std::span<const std::uint32_t> around, SimTime t, Touching which,
                                      Quantity quantity);

// Whether a body of the island, which is of velocities, moves and gives way to nothing.
[[nodiscard]] bool is_driven(const ContactIsland& island);

// The values become those that the constraints allow. Returns the pairs that had to be left out: of them one comes
// and gives way to nothing, and the other has no room.
[[nodiscard]] std::vector<std::uint32_t> solve(ContactIsland& island);

}  // namespace peerd::replication
