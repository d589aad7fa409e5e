#pragma once
#include <cstdint>
#include <optional>

#include "collision/query/view_query.hpp"
#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/motion_model.hpp"
#include "replication/wire/decision_policy.hpp"

namespace peerd::replication {

// One of the two objects of a contact with its owner, by published states.
struct Contender {
  PeerId owner;
  std::optional<KinematicState> state;  // the published state; none: it is not known so far back
  Duration latency{0};                  // how late its owner receives other peers
  bool sees = false;                    // its owner's field of view contains both objects
};

// The peer that decides whether the two collided, and how (Ohlenburg 2003, section 4.4.4): the owner of both, or of
// two owners the one by `policy`. kNobody for two scene objects, which do not move. `server`: kNobody where the server
// is not in the session.
[[nodiscard]] PeerId decider(DecisionPolicy policy, const Contender& a, const Contender& b, PeerId server);
[[nodiscard]] PeerId decider_by_id(PeerId owner_a, PeerId owner_b);

// The error [m] that a peer which receives others `latency` late makes in the position of such an object: |v| dt + |a|
// L^2 / 2. dt = 1 ms: what session clocks differ by, which is all the error of a steady velocity. An object that
// accelerates is about to accelerate otherwise, and its updates come L late.
[[nodiscard]] double expected_error_m(const KinematicState& other, Duration latency);

// The instant whose states decide a contact: `lookback` before the last whole 125 ms. The two owners' contact times
// differ by a little; on a grid they still take the same states, but for one in (125 ms / difference).
[[nodiscard]] SimTime decided_as_of(SimTime contact, Duration lookback);

// Whether a contact or a decision on it changes the motion of one of its two objects.
template <class Contact>
[[nodiscard]] bool changes_motion_of(ObjectId object, const Contact& c) {
  return (object == c.collider && !moves_alike(c.collider_before, c.collider_after)) ||
         (object == c.collidee && !moves_alike(c.collidee_before, c.collidee_after));
}

// Whether a camera sees anything of a box.
[[nodiscard]] bool sees(const collision::Camera& camera, const WorldBox& box);

}  // namespace peerd::replication
