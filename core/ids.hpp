#pragma once
#include <cstdint>

#include "core/strong.hpp"

namespace peerd {

// The number of a peer in its session; chosen by its configuration, 0 is never a peer. The lower number decides
// collisions.
using PeerId = Strong<struct PeerIdTag, std::uint32_t>;
// The owner of scene objects, which no peer runs.
inline constexpr PeerId kNobody{0};

// A node instance of the scene: its index in depth-first file order, a USE counting as a new instance. All peers that
// load the same world text give every instance the same number.
using ObjectId = Strong<struct ObjectIdTag, std::uint32_t>;

// A region of the scene; each has a multicast group of its own.
using RegionId = Strong<struct RegionIdTag, std::uint32_t>;

}  // namespace peerd
