#pragma once
#include "core/ids.hpp"

namespace peerd::replication {

// Runs nothing: the owner of scene objects.
inline constexpr PeerId kNobody{0};

// Who decides whether two objects collided, and how (seed 4.4.4): the one peer that runs them, or of two peers the one
// with the lower id. kNobody for two scene objects, which do not move.
[[nodiscard]] constexpr PeerId decider_by_id(PeerId owner_a, PeerId owner_b) {
  if (owner_a == kNobody) return owner_b;
  if (owner_b == kNobody) return owner_a;
  return owner_a < owner_b ? owner_a : owner_b;
}

}  // namespace peerd::replication
