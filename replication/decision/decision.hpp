#pragma once
#include <cstdint>
#include <optional>

#include "collision/query/view_query.hpp"
#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/wire/decision_policy.hpp"

namespace peerd::replication {

// One of the two objects and who runs it, as everybody knows them.
struct Contender {
  PeerId owner;
  std::optional<KinematicState> state;  // published; none: not known so far back
  Duration latency{0};                  // how late its owner hears of others
  bool sees = false;                    // its owner's field of view has both
};

// The peer that decides whether the two collided, and how (seed 4.4.4): the one that runs them, or of two owners the
// one by `policy`. kNobody for two scene objects, which do not move. `server`: kNobody where it is not here.
[[nodiscard]] PeerId decider(DecisionPolicy policy, const Contender& a, const Contender& b, PeerId server);
[[nodiscard]] PeerId decider_by_id(PeerId owner_a, PeerId owner_b);

// By how much a peer that hears of others `latency` late misjudges where such an object is [m]: |v| dt + |a| L^2 / 2.
// dt = 1 ms: what session clocks differ by, all that a steady velocity can do wrong. What accelerates is about to
// accelerate otherwise, and that is heard of L late.
[[nodiscard]] double expected_error_m(const KinematicState& other, Duration latency);

// The instant whose states decide a contact: `lookback` before the last whole 125 ms. The two owners' contact times
// differ by a little; on a grid they still take the same states, but for one in (125 ms / difference).
[[nodiscard]] SimTime decided_as_of(SimTime contact, Duration lookback);

// Whether a camera sees anything of a box.
[[nodiscard]] bool sees(const collision::Camera& camera, const WorldBox& box);

}  // namespace peerd::replication
