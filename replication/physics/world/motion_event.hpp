#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/scene/scene.hpp"
#include "core/shape_polygon.hpp"
#include "core/time.hpp"

namespace peerd::replication {

struct ContactEvent {
  SimTime at;  // the contact time, rounded down to a nanosecond so that nothing is inside anything
  ObjectId collider, collidee;
  Vec3 normal = Vec3::Zero();  // in the world frame: world.md says of what; facing the collider
  KinematicState collider_before, collidee_before, collider_after, collidee_after;
  CollisionType type = CollisionType::kWitness;  // of the interest
  bool rests = false;                            // the two rest against each other from then on, or would if deferred
  // Where the two rest: their accelerations if nothing bore them [m/s^2, world frame].
  Vec3 collider_free = Vec3::Zero(), collidee_free = Vec3::Zero();
  bool deferred = false;  // nobody responded: another peer decides; the states after are what the outcome would be here
  TouchedPolygons polygons{};  // only of what a peer puts out (contact_polygons.hpp)
};

// Two bodies overlap when their pair is checked for the first time, as soon as one of them moves. They part as they
// will; if they approach or are pressed together, that is answered once, by their responses.
struct BodiesOverlap {
  SimTime at;
  ObjectId collider, collidee;
};

// Contacts of `object` after `since` that were reported are retracted; those that still hold are reported again.
struct ContactsRetracted {
  ObjectId object;
  SimTime since;
  std::optional<ObjectId> partner{};  // only contacts with it are retracted; none: those with anything
  bool of_ghosts_alone = false;       // contacts that an owner has found with its own objects stand

  // Whether a contact of those two at that time is one of them.
  [[nodiscard]] bool retracts(SimTime at, ObjectId a, ObjectId b) const {
    if (at <= since || (a != object && b != object)) return false;
    return !partner || a == *partner || b == *partner;
  }
};

// An event of a MotionWorld.
using MotionEvent = std::variant<ContactEvent, ContactsRetracted, BodiesOverlap>;

// The work of a MotionWorld since it was made.
struct MotionCounters {
  std::uint64_t contact_searches = 0;  // calls into collision
  std::uint64_t searches_far = 0;      // searches without such a call, because the bounds of the two are apart
  std::uint64_t searches_skipped = 0;  // pairs whose cached answer still stood
  std::uint64_t searches_put_off = 0;  // part pairs that stopped before such a call (MotionWorld::put_off())
  std::uint64_t contacts = 0;
  std::uint64_t contacts_undone = 0;  // predicted contacts that were retracted
  std::uint64_t came_to_rest = 0;     // contacts in which two came to rest against each other
  std::uint64_t jammed = 0;           // contacts answered for all that touched, because no answer for two ended them
  std::uint64_t overlapped = 0;       // searches that began inside another object
  std::uint64_t unsupported = 0;      // pairs that collision can't answer yet
  std::uint64_t failed = 0;           // searches that hit their iteration cap
  std::uint64_t capped = 0;           // advance() had found kContactsMax contacts and stopped all that met any more
  std::uint64_t islands = 0;          // islands of which velocities or accelerations were solved
  std::uint64_t largest_island = 0;   // objects of the largest of them; of two worlds the greater one
  // The energy [J] with which objects that this peer owns would have parted, of the contacts that ended their flight.
  double rest_energy_j = 0.0;

  void note_island(std::size_t objects) {
    if (objects == 0) return;
    ++islands;
    largest_island = std::max<std::uint64_t>(largest_island, objects);
  }
  MotionCounters& operator+=(const MotionCounters& other);
};

}  // namespace peerd::replication
