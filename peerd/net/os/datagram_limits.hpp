#pragma once
#include <cstddef>

namespace peerd::net {

// The longest datagram [bytes] of a peer that is read; an Ethernet frame holds 1,472.
inline constexpr std::size_t kMaxDatagramBytes = 1500;

// The longest datagram [bytes] that a peer sends, sealed and framed: what the least MTU of IPv6, 1,280, leaves behind
// the headers of IPv6 and UDP. Longer ones would be cut into fragments where tunnels have that MTU.
inline constexpr std::size_t kSentDatagramMax_bytes = 1280 - 40 - 8;

// The number of datagrams that one system call reads or sends.
inline constexpr std::size_t kBatch = 32;

}  // namespace peerd::net
