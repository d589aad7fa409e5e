#pragma once
#include "replication/physics/world/moving_objects.hpp"
#include "replication/physics/world/watched_pair.hpp"

namespace peerd::replication {

// A bound of the rounding of a speed or an acceleration along a normal, in parts of its size.
inline constexpr double kRounding = 0x1p-46;

// In a heap, what approaches more slowly than this stays, whatever its restitution [m/s].
inline constexpr double kRestSpeed_m_s = 0.05;
// So it is in a crowd (contact_island.hpp), for which each bounce costs a solution of all.
inline constexpr double kCrowdRestSpeed_m_s = 0.5;

// The authority in a contact: the outcome that counts.
enum class ContactAuthority : std::uint8_t {
  kAsPublished,  // this world's, but for an object with an update of a later time, which contains the outcome
  kLocal,        // this world's, also for an object with a later update: its owner leaves the decision to this peer
  kDeferred      // the contact is reported once, as deferred, and the two objects go on
};

// The answers of the two objects of a pair to its contact.
struct ContactAnswer {
  ContactAuthority authority;
  MotionModel before_a, before_b, after_a, after_b;
  bool a_responds, b_responds;

  // Whether one of them moves otherwise from then on.
  [[nodiscard]] bool changes_motion() const;
};

// Whether the later update of an object that does not respond to a contact holds its part of it: its owner has seen
// the first contact of the burst. What this peer owns has had none that this world does not know.
[[nodiscard]] inline bool is_in_later_update(const MovingObject& o, const WatchedPair& pair) {
  return o.role == Role::kPredicted && pair.in_burst <= 1;
}

// Returns what the responses of the two objects make of the contact that the pair has.
[[nodiscard]] ContactAnswer answer_to(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair,
                                      ContactAuthority authority);

// Two that close although their centres do not approach along the normal: a turning body strikes with a corner, and its
// spin ends; or the normal is not that of the place where they close, and they go back the way they came.
[[nodiscard]] ContactAnswer answer_to_closing(const WorldModel& model, const MovingObjects& objects,
                                              const WatchedPair& pair, const ContactAnswer& answer);

// Whether the contact is a resting one without a blow: the two approach no faster than they would part to come to rest
// again, and do so.
[[nodiscard]] bool lasts_at(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair);

// Whether the two would part for no more than kShortestFlight_s.
[[nodiscard]] bool comes_to_rest_at(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair,
                                    const ContactAnswer& answer);

// Whether each of the two responds by IMPULSE, as it would at any contact of that time, or responds to nothing at all.
[[nodiscard]] bool exchanges_momentum(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair,
                                      const ContactAnswer& answer);

// The energy along the normal with which the two would part by the answer [J]; of two that give way, half of it for
// each one that this peer owns.
[[nodiscard]] double own_energy_of_parting_j(const WorldModel& model, const MovingObjects& objects,
                                             const WatchedPair& pair, const ContactAnswer& answer);

}  // namespace peerd::replication
