#include "peerd/peer/record/udp_packet.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "tests/must.hpp"

namespace peerd::record::udp_packet_test {

namespace ip = boost::asio::ip;

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

ip::udp::endpoint at(const char* address, std::uint16_t port) { return {ip::make_address(address), port}; }

// The checksums were verified by hand: the words of the header add up to 0xFFFF, and so do those of the datagram with
// the pseudo header.
TEST(UdpPacket, HasTheBytesOfItsStandards) {
  const auto bytes = encode({at("10.0.0.1", 47474), at("239.192.0.0", 47474), bytes_of("abc")});
  const unsigned char expected[] = {0x45, 0x00, 0x00, 0x1F, 0x00, 0x00, 0x40, 0x00, 0x01, 0x11, 0x7F,
                                    0x0B, 0x0A, 0x00, 0x00, 0x01, 0xEF, 0xC0, 0x00, 0x00,  //
                                    0xB9, 0x72, 0xB9, 0x72, 0x00, 0x0B, 0x00, 0x00, 'a',  'b',  'c'};
  ASSERT_EQ(bytes.size(), sizeof expected);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (i == 10 || i == 11 || i == 26 || i == 27) continue;  // the checksums, see below
    EXPECT_EQ(std::to_integer<unsigned>(bytes[i]), expected[i]) << "byte " << i;
  }
  const auto word = [&](std::size_t i) {
    return std::to_integer<unsigned>(bytes[i]) << 8 |
           (i + 1 < bytes.size() ? std::to_integer<unsigned>(bytes[i + 1]) : 0);
  };
  const auto folded = [](unsigned sum) { return (sum & 0xFFFF) + (sum >> 16); };
  unsigned header = 0, datagram = 17 + 11;
  for (std::size_t i = 0; i < 20; i += 2) header += word(i);
  for (std::size_t i = 12; i < bytes.size(); i += 2) datagram += word(i);
  EXPECT_EQ(folded(header), 0xFFFFu);
  EXPECT_EQ(folded(datagram), 0xFFFFu);
}

TEST(UdpPacket, WhatIsEncodedDecodesAndNoBitMayDiffer) {
  for (const bool v4 : {true, false}) {
    for (const std::string_view payload : {std::string_view(""), std::string_view("odd"), std::string_view("even")}) {
      const UdpPacket packet{v4 ? at("192.0.2.1", 1) : at("2001:db8::1", 1),
                             v4 ? at("239.192.0.7", 65535) : at("ff15::1:0:7", 65535), bytes_of(payload)};
      auto bytes = encode(packet);
      const auto back = must(decode_udp_packet(bytes));
      EXPECT_EQ(back.from, packet.from);
      EXPECT_EQ(back.to, packet.to);
      EXPECT_TRUE(std::ranges::equal(back.payload, packet.payload));
      for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        const auto mask = static_cast<std::byte>(1 << bit % 8);
        bytes[bit / 8] ^= mask;
        EXPECT_FALSE(decode_udp_packet(bytes)) << "bit " << bit;
        bytes[bit / 8] ^= mask;
      }
      for (std::size_t size = 0; size < bytes.size(); ++size) {
        EXPECT_FALSE(decode_udp_packet(std::span(bytes).first(size))) << size << " bytes";
      }
    }
  }
}

}  // namespace peerd::record::udp_packet_test
