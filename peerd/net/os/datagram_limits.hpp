#pragma once
#include <cstddef>

namespace peerd::net {

// The longest datagram [bytes] of a peer that is read or sent. Peers send at most 1,200 bytes; an Ethernet frame holds
// 1,472.
inline constexpr std::size_t kMaxDatagramBytes = 1500;

// The number of datagrams that one system call reads or sends.
inline constexpr std::size_t kBatch = 32;

}  // namespace peerd::net
