#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace peerd::record {

// A UDP datagram with the headers that it has, or would have, on the wire: IPv4 (RFC 791) or IPv6 (RFC 8200),
// unfragmented and without options, then UDP (RFC 768), with all checksums.
struct UdpPacket {
  boost::asio::ip::udp::endpoint from, to;  // of one family
  std::span<const std::byte> payload;       // at most 65,487 bytes
};

[[nodiscard]] std::vector<std::byte> encode(const UdpPacket& packet);

// Decodes packets of the form that encode() makes; none for other bytes. The payload points into `bytes`.
[[nodiscard]] std::optional<UdpPacket> decode_udp_packet(std::span<const std::byte> bytes);

}  // namespace peerd::record
