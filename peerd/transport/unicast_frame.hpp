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

// What precedes a datagram where the group that it was sent to does not say its region: by unicast, whose destination
// is the receiver, and where regions share groups. UDP itself has no field that could: ports say who, and nothing else
// comes through routers unchanged. Numbers are big-endian.
//
//    0        1                          5
//   +--------+--------+--------+--------+--------+- - - - - -+
//   |  0x52  |              region               |  datagram |
//   +--------+--------+--------+--------+--------+- - - - - -+
inline constexpr std::size_t kRegionHeaderBytes = 5;
[[nodiscard]] std::array<std::byte, kRegionHeaderBytes> region_header(RegionId region);
// None: the bytes do not begin with one.
[[nodiscard]] std::optional<RegionId> read_region_header(std::span<const std::byte> bytes);

// By unicast alone: who is here, what it wants to hear, and whom it hears.
//
//    0        1          5          11         17       18       19       20
//   +--------+- - - - - +- - - - - +- - - - - +--------+--------+--------+- - - - - - - +- - - - - - - - - - - - - -+
//   |  0x47  | instance |  number  |   echo   | flags  |#regions| #peers |  #regions    |  #peers x (port 2,        |
//   |        |          |          |          |        |0xFF all|        |  x 4         |  address 4 or, IPv6, 16)  |
//   +--------+- - - - - +- - - - - +- - - - - +--------+--------+--------+- - - - - - - +- - - - - - - - - - - - - -+
//
// The number is another one for each address that is greeted (KnownPeers::number_for). Who echoes that of the address
// it greets from gets our datagrams there, and nobody else: an address that somebody made up doesn't hear its number,
// no other address's will do, and it is never sent more than it seemed to send.
inline constexpr int kAddressNumberBits = 48;
struct Greeting {
  std::uint32_t instance = 0;          // of the sender's process; its two addresses, where it has two, are one peer
  std::uint64_t number = 0;            // for the receiver to echo, kAddressNumberBits
  std::uint64_t echo = 0;              // the last number that the sender had from the receiver; 0: none
  bool reply = false;                  // wants one back; bare: tells no regions and no peers
  bool leaving = false;                // sends and wants no more
  bool all_regions = false;            // more than fit; else `regions`, ascending
  std::vector<RegionId> regions = {};  // that the sender wants to hear
  std::vector<asio::ip::udp::endpoint> peers = {};  // that the sender hears
};
inline constexpr std::size_t kGreetingRegionsMax = 200, kGreetingPeersMax = 20;
inline constexpr std::size_t kGreetingMaxBytes = 20 + 4 * kGreetingRegionsMax + 18 * kGreetingPeersMax;
static_assert(kGreetingMaxBytes <= 1200);  // as all datagrams of peers: no network cuts them in two

// At most kGreetingMaxBytes; what is more is left out of the peers and makes the regions all.
[[nodiscard]] std::vector<std::byte> encode(const Greeting& greeting, bool v4);
// None: no greeting, or not to its last byte.
[[nodiscard]] std::optional<Greeting> decode_greeting(std::span<const std::byte> bytes, bool v4);

}  // namespace peerd::net
