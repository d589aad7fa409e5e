#pragma once
#include <cstdint>
#include <vector>

#include "core/least_change.hpp"
#include "replication/physics/world/moving_objects.hpp"
#include "replication/physics/world/watched_pair.hpp"

namespace peerd::replication {

// Objects that touch each other at one instant, as far as they give way, and what they give way to.
struct ContactIsland {
  static constexpr std::uint32_t kNone = MovingObjects::kNone;

  std::vector<std::uint32_t> objects;  // of `bodies`: indices, or kNone for one that does not give way
  std::vector<ConstrainedBody> bodies;
  std::vector<OneSided> constraints;
  std::vector<std::uint32_t> pairs;  // of each constraint
};
enum class Touching : std::uint8_t { kBearing, kAny };  // the pairs that bear, or all of the burst
enum class Quantity : std::uint8_t { kVelocity, kAcceleration };

// The island around two objects at t.
[[nodiscard]] ContactIsland island_of(const WorldModel& model, const MovingObjects& objects, const WatchedPairs& pairs,
                                      std::size_t a, std::size_t b, SimTime t, Touching which, Quantity quantity);

// The values become those that the constraints allow. Returns the pairs that had to be left out: of them one comes
// and gives way to nothing, and the other has no room.
[[nodiscard]] std::vector<std::uint32_t> solve(ContactIsland& island);

}  // namespace peerd::replication
