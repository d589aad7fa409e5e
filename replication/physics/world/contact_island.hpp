#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/least_change.hpp"
#include "replication/physics/world/contact_answer.hpp"
#include "replication/physics/world/far_pairs.hpp"
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
  std::vector<std::uint32_t> pairs;     // of each constraint
  std::vector<std::uint32_t> foreseen;  // the constraints, ascending, of pairs that do not touch yet
  // For each constraint, the speed or the acceleration along its normal that it adds between its two bodies; solve()
  // sets it.
  std::vector<double> holds;
  bool is_solved = false;  // once it is solved; else rounding has hidden the solution, and all that gives way stands

  // The number of objects that give way; 0 where nothing touches.
  [[nodiscard]] std::size_t giving_way() const {
    if (constraints.empty()) return 0;
    return objects.size() - static_cast<std::size_t>(std::ranges::count(objects, kNone));
  }
};
enum class Touching : std::uint8_t { kBearing, kAny };  // the pairs that bear, or all of the burst
enum class Quantity : std::uint8_t { kVelocity, kAcceleration };

// An island with so many objects that give way is a crowd. In a crowd each contact changes the ways of all, so that
// each object would meet its neighbours again and again. A crowd foresees contacts: two that would meet within
// kForeseen_s are slowed so far that they at most touch in that time.
inline constexpr std::size_t kCrowd = 8;
inline constexpr double kForeseen_s = 0x1p-6;

[[nodiscard]] inline bool is_crowd(const ContactIsland& island) { return island.giving_way() >= kCrowd; }

// Whether no peer has to agree with others on a contact of the two.
using AnsweredAlone = std::function<bool(ObjectId collider, ObjectId collidee)>;

// The island around those of these objects that give way at t. With `foresees` also the pairs of which that is true and
// that would meet within kForeseen_s, without a bounce; nothing that comes and gives way to nothing is foreseen.
[[nodiscard]] ContactIsland island_of(const WorldModel& model, const MovingObjects& objects, const WatchedPairs& pairs,
                                      std::span<const std::uint32_t> around, SimTime t, Touching which,
                                      Quantity quantity, const AnsweredAlone& foresees = {});

// IslandParting sorts the constraints of an island whose accelerations are solved, by the velocities of its bodies. It
// has indices of constraints.
struct IslandParting {
  std::vector<std::uint32_t> released;  // that part for good
  std::vector<std::uint32_t> pressed;   // that part no more than the forces bring back within kShortestFlight_s
  bool pressed_part = false;            // some of the pressed ones part
};
// Two bodies that part more slowly than `rounding` [m/s] are at rest against each other. With `keeps_up` a pressed body
// also follows a support that moves away and gives way to nothing. Following takes energy; it is needed where the laws
// of a support and of what it bears come from two updates, whose speeds differ by their rounding.
[[nodiscard]] IslandParting parting_of(const ContactIsland& island, const MovingObjects& objects,
                                       const WatchedPairs& pairs, SimTime t, double rounding, bool keeps_up);

// Adds to an island of velocities the reverse of each given constraint of one of accelerations, so that its two bodies
// neither approach nor part.
void hold_together(ContactIsland& velocities, const ContactIsland& accelerations, std::span<const std::uint32_t> given);

// Notes at the pairs of the island by which laws they are solved at t.
void note_solved(const ContactIsland& island, const MovingObjects& objects, WatchedPairs& pairs, SimTime t);

// Whether an end of the pair that gives way at t bears, or is borne by, anything else.
[[nodiscard]] bool bears_another(const MovingObjects& objects, const WatchedPairs& pairs, const WatchedPair& pair,
                                 SimTime t);

// Two that bear each other, and give way, beside a pair that is struck, and how they move then.
struct StruckPair {
  std::uint32_t pair;
  ContactAnswer answer;
};
[[nodiscard]] std::vector<StruckPair> struck_with(const WorldModel& model, const MovingObjects& objects,
                                                  const WatchedPairs& pairs, const WatchedPair& pair, SimTime t);

// How a driven object jumps from one of its laws to the next, and what it takes along: what it bears, what it runs into
// on the straight way between the two, and all that gives way behind that.
class DrivenJump {
 public:
  struct Driver {
    std::uint32_t object;
    SimTime at, world_start;
    bool holds;         // what bears each other stays together
    bool spares_given;  // what has a law that was set for that instant keeps it, as such laws come in any order
  };
  // An object and what has run into it.
  struct RunInto {
    std::uint32_t object, by;
    Vec3 normal;    // unit, world frame, facing the object
    double free_m;  // how far `by` goes along the normal before it meets the object
  };

  // All arguments outlive this object.
  DrivenJump(const WorldModel& model, const MovingObjects& objects, WatchedPairs& pairs, FarPairs& far,
             const Driver& driver)
      : model_(model), objects_(objects), pairs_(pairs), far_(far), driver_(driver) {}

  // Whether the object keeps a law that was set for that very instant (Driver::spares_given).
  [[nodiscard]] bool is_given(std::uint32_t object) const;
  // Notes what the object meets on a straight way [m] from a place, while all else stands. One of the two gives way.
  void find_run_into(std::uint32_t object, const Pose& from, const Vec3& way);
  [[nodiscard]] const std::vector<RunInto>& met() const { return met_; }
  // Returns the ways [m] of all objects around these, as the driver goes by `way`. It solves them again until nothing
  // runs into an object that is not in met(). The objects of met() are added to `around`.
  [[nodiscard]] ContactIsland places(std::vector<std::uint32_t>& around, const Vec3& way);
  // Returns the changes of their velocities [m/s] as the driver's velocity changes by `change`.
  [[nodiscard]] ContactIsland speeds(std::span<const std::uint32_t> around, const Vec3& change) const {
    return solved(around, change, {});
  }

 private:
  [[nodiscard]] ContactIsland solved(std::span<const std::uint32_t> around, const Vec3& of_driver,
                                     std::span<const RunInto> met) const;

  const WorldModel& model_;
  const MovingObjects& objects_;
  WatchedPairs& pairs_;
  FarPairs& far_;
  const Driver driver_;
  std::vector<RunInto> met_;
};

// Whether one of the two gives way and the other stands: a wall, for all that this contact knows.
[[nodiscard]] bool stands_firm(const MovingObjects& objects, const WatchedPair& pair, SimTime t);

// Whether the two meet far too often, and nothing that they met within the burst gives way.
[[nodiscard]] bool is_trapped(const MovingObjects& objects, const WatchedPairs& pairs, const WatchedPair& pair,
                              SimTime t);

// Whether a body that gives way to nothing has a value other than zero.
[[nodiscard]] bool is_driven(const ContactIsland& island);

// Changes the values to those that the constraints allow. Where there are none, it gives up all foreseen constraints
// first, and then those of bodies that come and give way to nothing, where the other one has no room. Returns the pairs
// of the latter.
[[nodiscard]] std::vector<std::uint32_t> solve(ContactIsland& island);

}  // namespace peerd::replication
