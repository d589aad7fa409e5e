#include "peerd/net/greeting/unicast_frame.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::net {
namespace {

using asio::ip::udp;

constexpr std::byte kRegionMark{0x52}, kRelayMark{0x53};
constexpr std::uint64_t kReply = 1, kLeaving = 2, kLink = 4, kDetached = 8, kFlags = 15;
constexpr std::uint64_t kAllRegions = 0xFF;
constexpr int kInstanceBytes = 4, kNumberBytes = kAddressNumberBits / 8;

void put(std::vector<std::byte>& out, std::uint64_t value, int size_bytes) {
  for (int shift = 8 * (size_bytes - 1); shift >= 0; shift -= 8) out.push_back(static_cast<std::byte>(value >> shift));
}

// Takes numbers off the front. `good` becomes false with the first number that is missing.
struct Cursor {
  std::span<const std::byte> left;
  bool good = true;

  std::uint64_t take(std::size_t size_bytes) {
    good = good && left.size() >= size_bytes;
    if (!good) return 0;
    std::uint64_t value = 0;
    for (const std::byte byte : left.first(size_bytes)) value = value << 8 | std::to_integer<std::uint64_t>(byte);
    left = left.subspan(size_bytes);
    return value;
  }
};

void put(std::vector<std::byte>& out, const udp::endpoint& peer, bool v4) {
  assert(peer.address().is_v4() == v4);
  put(out, peer.port(), 2);
  if (v4) return put(out, peer.address().to_v4().to_uint(), 4);
  for (const unsigned char byte : peer.address().to_v6().to_bytes()) put(out, byte, 1);
}

udp::endpoint take_peer(Cursor& from, bool v4) {
  const auto port = static_cast<std::uint16_t>(from.take(2));
  if (v4) return {asio::ip::address_v4(static_cast<std::uint32_t>(from.take(4))), port};
  asio::ip::address_v6::bytes_type bytes{};
  for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(from.take(1));
  return {asio::ip::address_v6(bytes), port};
}

void put(std::vector<std::byte>& out, const LinkNote& note) {
  put(out, static_cast<std::uint64_t>(note.sent_at_ns), 8);
  put(out, static_cast<std::uint64_t>(note.echoed_ns), 8);
  for (const std::uint32_t value : {note.held_us, note.datagrams_out, note.datagrams_in, note.group_offset}) {
    put(out, value, 4);
  }
  assert(note.path.size() <= kRelayPathMax);
  put(out, note.path.size(), 1);
  for (const std::uint32_t relay : note.path) put(out, relay, kInstanceBytes);
}

LinkNote take_note(Cursor& from, bool detached) {
  LinkNote note{.detached = detached};
  note.sent_at_ns = static_cast<std::int64_t>(from.take(8));
  note.echoed_ns = static_cast<std::int64_t>(from.take(8));
  for (std::uint32_t* const value : {&note.held_us, &note.datagrams_out, &note.datagrams_in, &note.group_offset}) {
    *value = static_cast<std::uint32_t>(from.take(4));
  }
  const std::uint64_t relays = from.take(1);
  from.good = from.good && relays <= kRelayPathMax;
  for (std::uint64_t i = 0; i < relays && from.good; ++i) {
    note.path.push_back(static_cast<std::uint32_t>(from.take(kInstanceBytes)));
  }
  return note;
}

}  // namespace

std::array<std::byte, kRegionHeaderBytes> region_header(RegionId region) {
  return {kRegionMark, static_cast<std::byte>(region.value >> 24), static_cast<std::byte>(region.value >> 16),
          static_cast<std::byte>(region.value >> 8), static_cast<std::byte>(region.value)};
}

std::optional<RegionId> read_region_header(std::span<const std::byte> bytes) {
  if (bytes.size() < kRegionHeaderBytes || bytes.front() != kRegionMark) return std::nullopt;
  Cursor cursor{bytes.subspan(1)};
  return RegionId{static_cast<std::uint32_t>(cursor.take(4))};
}

std::array<std::byte, kRelayHeaderBytes> relay_header(const RelayHeader& header) {
  const std::uint32_t region = header.region.value;
  return {kRelayMark,
          static_cast<std::byte>(region >> 24),
          static_cast<std::byte>(region >> 16),
          static_cast<std::byte>(region >> 8),
          static_cast<std::byte>(region),
          static_cast<std::byte>(header.hops)};
}

std::optional<RelayHeader> read_relay_header(std::span<const std::byte> bytes) {
  if (bytes.size() < kRelayHeaderBytes || bytes.front() != kRelayMark) return std::nullopt;
  Cursor cursor{bytes.subspan(1)};
  RelayHeader header{RegionId{static_cast<std::uint32_t>(cursor.take(4))}};
  header.hops = static_cast<std::uint8_t>(cursor.take(1));
  return header.hops <= kRelayHopsMax ? std::optional(header) : std::nullopt;
}

std::vector<std::byte> encode(const Greeting& greeting, bool v4) {
  assert(!greeting.link || greeting.peers.empty());
  const bool all = greeting.all_regions || greeting.regions.size() > kGreetingRegionsMax;
  const std::size_t peers = std::min(greeting.peers.size(), kGreetingPeersMax);
  std::vector<std::byte> out{kGreetingMark};
  put(out, greeting.instance, kInstanceBytes);
  put(out, greeting.number, kNumberBytes);
  put(out, greeting.echo, kNumberBytes);
  const std::uint64_t link = !greeting.link ? 0 : kLink | (greeting.link->detached ? kDetached : 0);
  put(out, (greeting.reply ? kReply : 0) | (greeting.leaving ? kLeaving : 0) | link, 1);
  put(out, all ? kAllRegions : greeting.regions.size(), 1);
  put(out, peers, 1);
  if (!all) {
    for (const RegionId region : greeting.regions) put(out, region.value, 4);
  }
  for (const udp::endpoint& peer : std::span(greeting.peers).first(peers)) put(out, peer, v4);
  if (greeting.link) put(out, *greeting.link);
  assert(out.size() <= kGreetingMaxBytes);
  return out;
}

std::optional<Greeting> decode_greeting(std::span<const std::byte> bytes, bool v4) {
  if (bytes.empty() || bytes.front() != kGreetingMark) return std::nullopt;
  Cursor cursor{bytes.subspan(1)};
  Greeting greeting;
  greeting.instance = static_cast<std::uint32_t>(cursor.take(kInstanceBytes));
  greeting.number = cursor.take(kNumberBytes);
  greeting.echo = cursor.take(kNumberBytes);
  const std::uint64_t flags = cursor.take(1);
  greeting.reply = (flags & kReply) != 0;
  greeting.leaving = (flags & kLeaving) != 0;
  const std::uint64_t regions = cursor.take(1), peers = cursor.take(1);
  greeting.all_regions = regions == kAllRegions;
  const bool linked = (flags & kLink) != 0, detached = (flags & kDetached) != 0;
  if (flags > kFlags || (detached && !linked) || (linked && peers > 0)) return std::nullopt;
  if ((!greeting.all_regions && regions > kGreetingRegionsMax) || peers > kGreetingPeersMax) return std::nullopt;
  for (std::uint64_t i = 0; !greeting.all_regions && i < regions && cursor.good; ++i) {
    greeting.regions.push_back(RegionId{static_cast<std::uint32_t>(cursor.take(4))});
  }
  for (std::uint64_t i = 0; i < peers && cursor.good; ++i) greeting.peers.push_back(take_peer(cursor, v4));
  if (linked) greeting.link = take_note(cursor, detached);
  const bool ascending = std::ranges::adjacent_find(greeting.regions, [](RegionId a, RegionId b) {
                           return !(a < b);
                         }) == greeting.regions.end();
  if (!cursor.good || !cursor.left.empty() || !ascending) return std::nullopt;
  return greeting;
}

}  // namespace peerd::net
