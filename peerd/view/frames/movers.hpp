#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/scene.hpp"
#include "replication/peer/peer.hpp"

namespace peerd::view {

// The instances of a scene that move as rigid bodies, depth-first: each with what is below it down to the next mover. A
// picture has one node for each, by their order, and behind them one node for all that stands.
struct Movers {
  static constexpr std::uint32_t kNone = ~0U;

  std::vector<ObjectId> ids;
  std::vector<std::uint32_t> above;  // the nearest mover above, by index; kNone: there is none
  // Whether a peer knows where it is. The others are moved by the world's own file, in the frame of the one above, and
  // nothing can meet them.
  std::vector<bool> of_peer;
};

// The movers of a world that no peer runs: what the world moves itself, and what peers may: what its file gives to the
// founder of a session, and the Transforms that interests and KeySensors name.
[[nodiscard]] Movers movers_of(const Scene& scene);
// The movers of a peer's world as it is now: the carriers of its model, what somebody owns or has owned (`before`: what
// they were until now), and what the file moves besides.
[[nodiscard]] Movers movers_of(const replication::Peer& peer, const Movers& before = {});

}  // namespace peerd::view
