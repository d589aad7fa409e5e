#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/ids.hpp"

namespace peerd::discovery {

// A Beacon is the answer of a peer to a question, outside of any session: enough to find its world and ask for more. It
// grants nothing, and has a format of its own, so that it can be read whatever version the peer speaks.
struct Beacon {
  std::uint32_t protocol = 0;  // the version of its datagrams (replication::kProtocolVersion)
  std::uint64_t session = 0;   // of its world and regions (ReplicationSettings::session_hash): peers with another one
                               // do not meet
  PeerId peer{1};
  std::uint64_t incarnation = 0;
  std::uint16_t snapshot_port = 0;  // TCP, at the address that the beacon came from; 0: it gives its world to nobody
  std::string world, name;          // of the world and of the peer, at most kNameMax_bytes each
  bool sealed = false;              // who does not have its key is not heard

  friend bool operator==(const Beacon&, const Beacon&) = default;
};
inline constexpr std::size_t kNameMax_bytes = 63;

// A question has kQuestion_bytes, and a beacon at most so many: nobody makes peers send more than he sends himself.
inline constexpr std::size_t kQuestion_bytes = 192;

// The question to all peers: who is here?
[[nodiscard]] std::vector<std::byte> question();
[[nodiscard]] bool is_question(std::span<const std::byte> datagram);

// Longer names are cut.
[[nodiscard]] std::vector<std::byte> encode(const Beacon& beacon);
// Parses hostile input; none: it is no beacon. Bytes of names that a terminal does not show as text are replaced by
// "?".
[[nodiscard]] std::optional<Beacon> decode(std::span<const std::byte> datagram);

}  // namespace peerd::discovery
