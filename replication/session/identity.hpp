#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/ids.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// What a program that starts asks before it speaks as a peer: is one of that id alive in that world? Another life of
// the same peer would take it for its successor and give way, and the other peers would drop what it says.
struct IdentityQuestion {
  PeerId id;
  std::uint64_t incarnation = 1;  // of the program that asks
  std::uint64_t world_hash = 0;   // of the session, as in introductions
};

// The datagram of the question, to all peers (kWholeScene). To be repeated, for datagrams get lost.
[[nodiscard]] Bytes encode(const IdentityQuestion& question);

// Whether a datagram says that a peer of that id is alive.
[[nodiscard]] bool answers(std::span<const std::byte> datagram, const IdentityQuestion& question);

}  // namespace peerd::replication
