#pragma once
#include <array>
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "peerd/net/greeting/address_numbers.hpp"

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

// The header of a datagram on its way through relays (peerd/net/relay): that of a region, and the number of relays that
// may still pass it on, so that none goes round for ever.
//
//    0        1                          5        6
//   +--------+--------+--------+--------+--------+--------+- - - - - -+
//   |  0x53  |              region               |  hops  |  datagram |
//   +--------+--------+--------+--------+--------+--------+- - - - - -+
inline constexpr std::size_t kRelayHeaderBytes = 6;
inline constexpr std::uint8_t kRelayHopsMax = 16;
struct RelayHeader {
  RegionId region;
  std::uint8_t hops = kRelayHopsMax;
};
[[nodiscard]] std::array<std::byte, kRelayHeaderBytes> relay_header(const RelayHeader& header);
// None where the bytes do not begin with such a header, or its hops are more than the most.
[[nodiscard]] std::optional<RelayHeader> read_relay_header(std::span<const std::byte> bytes);

// The note that the two ends of a link with a relay add to each greeting. Times are nanoseconds of the sender's host
// clock (Unix time at its start, and from then on steady); counts are of this link, modulo 2^32.
//
//    0          8          16         20         24         28         32       33
//   +- - - - - +- - - - - +- - - - - +- - - - - +- - - - - +- - - - - +--------+- - - - - -+
//   |  sent at |  echoed  |   held   |   sent   | received |  offset  | #path  | #path x 4 |
//   +- - - - - +- - - - - +- - - - - +- - - - - +- - - - - +- - - - - +--------+- - - - - -+
inline constexpr std::size_t kRelayPathMax = 16;
struct LinkNote {
  std::int64_t sent_at_ns = 0;           // when this note left; each is later than the one before
  std::int64_t echoed_ns = 0;            // sent_at_ns of the last note that came from the receiver; 0: none
  std::uint32_t held_us = 0;             // between the arrival of that note and this one's leaving
  std::uint32_t datagrams_out = 0;       // to the receiver
  std::uint32_t datagrams_in = 0;        // from the receiver
  std::uint32_t group_offset = 0;        // GroupPlan::offset of the sender's world, on an island
  std::vector<std::uint32_t> path = {};  // instances of the relays from the sender up to the root; empty: it is a peer
  bool detached = false;                 // a relay that is to have a parent, and has none at present
};

// A greeting, which is sent by unicast, or on an island to which a relay is joined (peerd/net/relay), announces its
// sender, the regions that it wants, and the peers that it knows.
//
//    0        1          5          11         17       18       19       20
//   +--------+- - - - - +- - - - - +- - - - - +--------+--------+--------+- - - - - - - +- - - - - - - - - - - - - -+
//   |  0x47  | instance |  number  |   echo   | flags  |#regions| #peers |  #regions    |  #peers x (port 2,        |
//   |        |          |          |          |        |0xFF all|        |  x 4         |  address 4 or, IPv6, 16)  |
//   +--------+- - - - - +- - - - - +- - - - - +--------+--------+--------+- - - - - - - +- - - - - - - - - - - - - -+
//
// The number is different for each address that is greeted (AddressNumbers::number_for). Datagrams go only to addresses
// that have echoed their own number: a forged source address does not receive its number, the number of another address
// does not help, and an unverified address is never sent more bytes than it seemed to send.
inline constexpr std::byte kGreetingMark{0x47};
struct Greeting {
  std::uint32_t instance = 0;          // of the sender's process, which may have several addresses
  std::uint64_t number = 0;            // to be echoed by the receiver; kAddressNumberBits bits
  std::uint64_t echo = 0;              // the last number that the receiver sent to the sender; 0: none
  bool reply = false;                  // a reply is wanted; the greeting is bare: it has no regions and no peers
  bool leaving = false;                // the sender leaves
  bool all_regions = false;            // the sender wants more regions than fit
  std::vector<RegionId> regions = {};  // the regions that the sender wants, ascending
  std::vector<asio::ip::udp::endpoint> peers = {};  // peers that the sender knows; none with a note
  std::optional<LinkNote> link = {};                // to and from relays; it stands behind the regions
};
inline constexpr std::size_t kGreetingRegionsMax = 200, kGreetingPeersMax = 20;
inline constexpr std::size_t kGreetingMaxBytes = 20 + 4 * kGreetingRegionsMax + 18 * kGreetingPeersMax;
static_assert(33 + 4 * kRelayPathMax <= 18 * kGreetingPeersMax, "a note takes the place of the peers");
static_assert(kGreetingMaxBytes <= 1200);  // as all datagrams of peers, so that networks do not fragment them

// Encodes to at most kGreetingMaxBytes: surplus peers are left out, and too many regions become all regions.
[[nodiscard]] std::vector<std::byte> encode(const Greeting& greeting, bool v4);
// None where the bytes are not exactly one greeting.
[[nodiscard]] std::optional<Greeting> decode_greeting(std::span<const std::byte> bytes, bool v4);

}  // namespace peerd::net
