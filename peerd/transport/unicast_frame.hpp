#pragma once
#include <array>
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "peerd/transport/transport.hpp"

namespace peerd::net {

// The region header precedes a datagram whose destination does not identify its region: by unicast, and where regions
// share groups. UDP itself has no field for it: ports identify processes, and routers preserve nothing else. Numbers
// are big-endian.
//
//    0        1                          5
//   +--------+--------+--------+--------+--------+- - - - - -+
//   |  0x52  |              region               |  datagram |
//   +--------+--------+--------+--------+--------+- - - - - -+
inline constexpr std::size_t kRegionHeaderBytes = 5;
[[nodiscard]] std::array<std::byte, kRegionHeaderBytes> region_header(RegionId region);
// None where the bytes do not begin with a region header.
[[nodiscard]] std::optional<RegionId> read_region_header(std::span<const std::byte> bytes);

// A greeting, which is sent by unicast only, announces its sender, the regions that it wants, and the peers that it
// knows.
//
//    0        1          5          11         17       18       19       20
//   +--------+- - - - - +- - - - - +- - - - - +--------+--------+--------+- - - - - - - +- - - - - - - - - - - - - -+
//   |  0x47  | instance |  number  |   echo   | flags  |#regions| #peers |  #regions    |  #peers x (port 2,        |
//   |        |          |          |          |        |0xFF all|        |  x 4         |  address 4 or, IPv6, 16)  |
//   +--------+- - - - - +- - - - - +- - - - - +--------+--------+--------+- - - - - - - +- - - - - - - - - - - - - -+
//
// The number is different for each address that is greeted (KnownPeers::number_for). Datagrams go only to addresses
// that have echoed their own number: a forged source address does not receive its number, the number of another address
// does not help, and an unverified address is never sent more bytes than it seemed to send.
inline constexpr int kAddressNumberBits = 48;
struct Greeting {
  std::uint32_t instance = 0;          // of the sender's process, which may have several addresses
  std::uint64_t number = 0;            // to be echoed by the receiver; kAddressNumberBits bits
  std::uint64_t echo = 0;              // the last number that the receiver sent to the sender; 0: none
  bool reply = false;                  // a reply is wanted; the greeting is bare: it has no regions and no peers
  bool leaving = false;                // the sender leaves
  bool all_regions = false;            // the sender wants more regions than fit
  std::vector<RegionId> regions = {};  // the regions that the sender wants, ascending
  std::vector<asio::ip::udp::endpoint> peers = {};  // peers that the sender knows
};
inline constexpr std::size_t kGreetingRegionsMax = 200, kGreetingPeersMax = 20;
inline constexpr std::size_t kGreetingMaxBytes = 20 + 4 * kGreetingRegionsMax + 18 * kGreetingPeersMax;
static_assert(kGreetingMaxBytes <= 1200);  // as all datagrams of peers, so that networks do not fragment them

// Encodes to at most kGreetingMaxBytes: surplus peers are left out, and too many regions become all regions.
[[nodiscard]] std::vector<std::byte> encode(const Greeting& greeting, bool v4);
// None where the bytes are not exactly one greeting.
[[nodiscard]] std::optional<Greeting> decode_greeting(std::span<const std::byte> bytes, bool v4);

}  // namespace peerd::net
