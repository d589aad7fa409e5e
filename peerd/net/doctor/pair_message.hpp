#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/time.hpp"

namespace peerd::doctor {

// The two ways between computers that are tried.
enum class Path : std::uint8_t { kUnicast, kMulticast };

enum class TcpState : std::uint8_t { kUntried, kWorks, kRefused, kNoAnswer };

// Datagrams of the stream by which loss is measured, on each path.
inline constexpr std::size_t kStream = 200;

// The datagrams that the sender has received on one path from the session that it names.
struct Heard {
  bool any = false;
  std::uint16_t stream = 0;         // different datagrams of the stream, at most kStream
  std::uint16_t largest_bytes = 0;  // the longest datagram

  friend bool operator==(const Heard&, const Heard&) = default;
};

// The one kind of datagram of `peerd doctor --with`. Each has all that its sender knows, so that any of them is enough,
// and none is an answer: each side sends by its own schedule, to the computer that its user has named and to the group.
//
//   0      "peerd=" and the version of the format, 1
//   7      path by which it was sent (0 unicast, 1 multicast)
//   8      session of the sender: random, for one run
//  16      session of the other side that it has heard; 0: none
//  24      time of sending by the sender's clock [ns since the Unix epoch]
//  32      time of sending that the last datagram of the other side has; 0: none
//  40      how long ago that datagram came [ns]
//  48      number in the stream, from 1; 0: none of the stream
//  50      TCP port at which the sender listens; 0: none
//  52      whether TCP to the other side works (TcpState)
//  53      1 where the sender has sent all of its stream and of its long datagrams, else 0
//  54      of unicast: whether any was received (1), how many of the stream (2), the longest [bytes] (2)
//  59      of multicast: the same
//  64      zeros up to the length that is tried
//
// Numbers have the least significant byte first.
struct PairMessage {
  Path path = Path::kUnicast;
  std::uint64_t session = 0;
  std::uint64_t other = 0;
  HostTime sent{};
  HostTime echo_sent{};
  Duration echo_held{0};
  std::uint16_t in_stream = 0;
  std::uint16_t tcp_port = 0;
  TcpState tcp = TcpState::kUntried;
  bool complete = false;
  Heard unicast, multicast;

  friend bool operator==(const PairMessage&, const PairMessage&) = default;
};

inline constexpr std::size_t kPairMessage_bytes = 64;

// The datagram has `size_bytes` bytes, at least kPairMessage_bytes.
[[nodiscard]] std::vector<std::byte> encode(const PairMessage& message, std::size_t size_bytes);
// Parses hostile input. The result is none where the bytes are no such datagram.
[[nodiscard]] std::optional<PairMessage> decode_pair_message(std::span<const std::byte> datagram);

}  // namespace peerd::doctor
