#include "peerd/peer/record/udp_packet.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <ranges>

namespace peerd::record {
namespace {

namespace ip = boost::asio::ip;

constexpr std::size_t kIpv4_bytes = 20, kIpv6_bytes = 40, kUdp_bytes = 8;
constexpr std::size_t kPayloadMax_bytes = 65'535 - kIpv6_bytes - kUdp_bytes;
constexpr std::uint8_t kUdpProtocol = 17;
constexpr std::uint8_t kHopLimit = 1;  // the default of a peer's datagrams; nothing here depends on it

void put(std::vector<std::byte>& out, std::uint64_t value, int size_bytes) {
  for (int shift = 8 * (size_bytes - 1); shift >= 0; shift -= 8) out.push_back(static_cast<std::byte>(value >> shift));
}

void put(std::vector<std::byte>& out, const ip::address& address) {
  const auto append = [&](const auto& bytes) {
    for (const unsigned char byte : bytes) out.push_back(static_cast<std::byte>(byte));
  };
  address.is_v4() ? append(address.to_v4().to_bytes()) : append(address.to_v6().to_bytes());
}

std::uint32_t number16(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint32_t>(bytes[at]) << 8 | std::to_integer<std::uint32_t>(bytes[at + 1]);
}

// RFC 1071: the ones' complement sum of 16-bit words, whose complement is the checksum. `sum` is that of the preceding
// bytes, of even number.
std::uint32_t add_words(std::uint32_t sum, std::span<const std::byte> bytes) {
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) sum += number16(bytes, i);
  if (bytes.size() % 2 != 0) sum += std::to_integer<std::uint32_t>(bytes.back()) << 8;
  while (sum >> 16 != 0) sum = (sum & 0xFFFF) + (sum >> 16);
  return sum;
}

void set16(std::vector<std::byte>& out, std::size_t at, std::uint32_t value) {
  out[at] = static_cast<std::byte>(value >> 8);
  out[at + 1] = static_cast<std::byte>(value);
}

template <class Address>
ip::address address_at(std::span<const std::byte> bytes, std::size_t at) {
  typename Address::bytes_type raw;
  std::ranges::transform(bytes.subspan(at, raw.size()), raw.begin(), std::to_integer<unsigned char>);
  return Address(raw);
}

}  // namespace

std::vector<std::byte> encode(const UdpPacket& packet) {
  assert(packet.from.address().is_v4() == packet.to.address().is_v4() && packet.payload.size() <= kPayloadMax_bytes);
  const std::size_t udp_bytes = kUdp_bytes + packet.payload.size();
  const bool v4 = packet.to.address().is_v4();
  std::vector<std::byte> out;
  out.reserve(kIpv6_bytes + udp_bytes);
  if (v4) {
    put(out, 0x45'00, 2);  // version, words of this header; type of service
    put(out, kIpv4_bytes + udp_bytes, 2);
    put(out, 0, 2);
    put(out, 0x40'00, 2);  // do not fragment
    put(out, kHopLimit, 1);
    put(out, kUdpProtocol, 1);
    put(out, 0, 2);  // checksum
  } else {
    put(out, 0x6000'0000, 4);
    put(out, udp_bytes, 2);
    put(out, kUdpProtocol, 1);
    put(out, kHopLimit, 1);
  }
  const std::size_t addresses_at = out.size();
  put(out, packet.from.address());
  put(out, packet.to.address());
  const std::size_t udp_at = out.size();
  if (v4) set16(out, 10, ~add_words(0, out));
  put(out, packet.from.port(), 2);
  put(out, packet.to.port(), 2);
  put(out, udp_bytes, 2);
  put(out, 0, 2);
  out.insert(out.end(), packet.payload.begin(), packet.payload.end());
  // The sum includes the pseudo header: addresses, length, protocol.
  std::uint32_t sum = kUdpProtocol + static_cast<std::uint32_t>(udp_bytes);
  sum = add_words(sum, std::span(out).subspan(addresses_at));
  const std::uint32_t checksum = ~sum & 0xFFFF;
  set16(out, udp_at + 6, checksum == 0 ? 0xFFFF : checksum);  // 0 says that there is none
  return out;
}

std::optional<UdpPacket> decode_udp_packet(std::span<const std::byte> bytes) {
  if (bytes.empty()) return std::nullopt;
  const bool v4 = bytes[0] == std::byte{0x45};
  const std::size_t ip_bytes = v4 ? kIpv4_bytes : kIpv6_bytes;
  if (bytes.size() < ip_bytes + kUdp_bytes || bytes.size() - ip_bytes - kUdp_bytes > kPayloadMax_bytes) {
    return std::nullopt;
  }
  const auto port = [&](std::size_t at) { return static_cast<std::uint16_t>(number16(bytes, ip_bytes + at)); };
  UdpPacket packet;
  packet.payload = bytes.subspan(ip_bytes + kUdp_bytes);
  if (v4) {
    packet.from = {address_at<ip::address_v4>(bytes, 12), port(0)};
    packet.to = {address_at<ip::address_v4>(bytes, 16), port(2)};
  } else {
    packet.from = {address_at<ip::address_v6>(bytes, 8), port(0)};
    packet.to = {address_at<ip::address_v6>(bytes, 24), port(2)};
  }
  if (!std::ranges::equal(encode(packet), bytes)) return std::nullopt;
  return packet;
}

}  // namespace peerd::record
