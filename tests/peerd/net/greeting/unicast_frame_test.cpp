#include "peerd/net/greeting/unicast_frame.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/must.hpp"
#include "tests/net/listener.hpp"

namespace peerd::net::unicast_frame_test {

using testing::ElementsAre;
using testing_support::bytes_of;

constexpr const char* kV4[] = {"192.0.2.1", "203.0.113.254"};
constexpr const char* kV6[] = {"2001:db8::1", "2001:db8:ffff:ffff:ffff:ffff:ffff:fffe"};

Greeting greeting(bool v4) {
  Greeting g{.instance = 0x81020304, .number = 0xA1A2A3A4A5A6, .echo = 0xF1F2F3F4F5F6, .reply = true};
  g.regions = {RegionId{0}, RegionId{7}, RegionId{0xFFFF'FFFF}};
  for (const char* address : v4 ? kV4 : kV6) g.peers.emplace_back(asio::ip::make_address(address), 47474);
  return g;
}

TEST(RegionHeader, IsTheMarkAndTheRegion) {
  EXPECT_THAT(region_header(RegionId{0x01020304}),
              ElementsAre(std::byte{0x52}, std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4}));
  EXPECT_EQ(read_region_header(region_header(RegionId{0xFFFF'FFFF})), RegionId{0xFFFF'FFFF});
  EXPECT_FALSE(read_region_header({}));
  EXPECT_FALSE(read_region_header(bytes_of("R123")));
  EXPECT_FALSE(read_region_header(bytes_of("G1234")));
}

TEST(RelayHeader, IsTheMarkTheRegionAndTheHops) {
  const auto bytes = relay_header({RegionId{0x01020304}, 5});
  EXPECT_THAT(bytes,
              ElementsAre(std::byte{0x53}, std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4}, std::byte{5}));
  const auto read = must(read_relay_header(bytes));
  EXPECT_EQ(read.region, RegionId{0x01020304});
  EXPECT_EQ(read.hops, 5);
  EXPECT_FALSE(read_relay_header(std::span(bytes).first(5)));
  EXPECT_FALSE(read_relay_header(bytes_of("S1234\x11")));  // more hops than any datagram begins with
  EXPECT_FALSE(read_relay_header(bytes_of("R12345")));
}

TEST(LinkNotes, ComeBackAsTheyWere) {
  Greeting sent{.instance = 1, .number = 2, .echo = 3, .regions = {RegionId{0}, RegionId{9}}};
  sent.link = LinkNote{.sent_at_ns = 0x0102030405060708,
                       .echoed_ns = -5,
                       .held_us = 7,
                       .datagrams_out = 0xFFFF'FFFF,
                       .datagrams_in = 8,
                       .group_offset = 4096,
                       .path = {11, 12, 13},
                       .detached = true};
  const auto bytes = encode(sent, true);
  const auto read = decode_greeting(bytes, true);
  ASSERT_TRUE(read && read->link);
  EXPECT_EQ(read->regions, sent.regions);
  EXPECT_EQ(read->link->sent_at_ns, sent.link->sent_at_ns);
  EXPECT_EQ(read->link->echoed_ns, -5);
  EXPECT_EQ(read->link->held_us, 7u);
  EXPECT_EQ(read->link->datagrams_out, 0xFFFF'FFFFu);
  EXPECT_EQ(read->link->datagrams_in, 8u);
  EXPECT_EQ(read->link->group_offset, 4096u);
  EXPECT_EQ(read->link->path, sent.link->path);
  EXPECT_TRUE(read->link->detached);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_greeting(std::span(bytes).first(size), true)) << size;
  }
}

TEST(LinkNotes, NeedNoMoreRoomThanGreetingsHave) {
  Greeting longest{.regions = {}};
  for (std::uint32_t i = 0; i < kGreetingRegionsMax; ++i) longest.regions.push_back(RegionId{i});
  longest.link = LinkNote{.path = std::vector<std::uint32_t>(kRelayPathMax, 1)};
  const auto bytes = encode(longest, false);
  EXPECT_LE(bytes.size(), kGreetingMaxBytes);
  EXPECT_TRUE(decode_greeting(bytes, false));
}

class Greetings : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Families, Greetings, testing::Bool(), [](const auto& c) { return c.param ? "V4" : "V6"; });

TEST_P(Greetings, ComeBackAsTheyWere) {
  const bool v4 = GetParam();
  for (const bool reply : {false, true}) {
    for (const bool leaving : {false, true}) {
      Greeting sent = greeting(v4);
      sent.reply = reply, sent.leaving = leaving;
      const auto got = must(decode_greeting(encode(sent, v4), v4));
      EXPECT_EQ(got.instance, sent.instance);
      EXPECT_EQ(got.number, sent.number);
      EXPECT_EQ(got.echo, sent.echo);
      EXPECT_EQ(got.reply, reply);
      EXPECT_EQ(got.leaving, leaving);
      EXPECT_FALSE(got.all_regions);
      EXPECT_EQ(got.regions, sent.regions);
      EXPECT_EQ(got.peers, sent.peers);
    }
  }
}

TEST_P(Greetings, TheShortestIsNoLongerThanTheOneThatAsksForIt) {
  EXPECT_EQ(encode({.instance = 1, .number = 2, .reply = true}, GetParam()).size(), 20u);
  EXPECT_EQ(encode({.instance = 1, .number = 2, .echo = 3}, GetParam()).size(), 20u);
}

TEST_P(Greetings, WhatDoesNotFitIsAllRegionsAndFewerPeers) {
  const bool v4 = GetParam();
  Greeting sent = greeting(v4);
  sent.regions.clear();
  for (std::uint32_t i = 0; i < kGreetingRegionsMax; ++i) sent.regions.push_back(RegionId{i});
  while (sent.peers.size() <= kGreetingPeersMax) sent.peers.push_back(sent.peers.front());
  auto bytes = encode(sent, v4);
  EXPECT_LE(bytes.size(), kGreetingMaxBytes);
  auto got = must(decode_greeting(bytes, v4));
  EXPECT_EQ(got.regions, sent.regions);
  EXPECT_EQ(got.peers.size(), kGreetingPeersMax);
  sent.regions.push_back(RegionId{1000});
  got = must(decode_greeting(encode(sent, v4), v4));
  EXPECT_TRUE(got.all_regions);
  EXPECT_TRUE(got.regions.empty());
}

// Only the bytes of a whole greeting are a greeting; input is hostile.
TEST_P(Greetings, NoPartAndNoMoreOfOneIsOne) {
  const auto bytes = encode(greeting(GetParam()), GetParam());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_greeting(std::span(bytes).first(size), GetParam())) << size;
  }
  auto longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(decode_greeting(longer, GetParam()));
  EXPECT_FALSE(decode_greeting(bytes, !GetParam())) << "the other family's addresses have another length";
}

TEST_P(Greetings, RegionsThatDoNotAscendAreRefused) {
  for (const auto& regions : {std::vector{RegionId{7}, RegionId{7}}, std::vector{RegionId{8}, RegionId{7}}}) {
    Greeting wrong = greeting(GetParam());
    wrong.regions = regions;
    EXPECT_FALSE(decode_greeting(encode(wrong, GetParam()), GetParam()));
  }
}

TEST_P(Greetings, ChangedBytesAreRefusedOrAGreeting) {
  std::mt19937_64 random(1);
  const auto good = encode(greeting(GetParam()), GetParam());
  for (int i = 0; i < 20'000; ++i) {
    auto bytes = good;
    bytes.resize(random() % 1200);
    for (int changes = 0; changes < 4 && !bytes.empty(); ++changes)
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    if (const auto got = decode_greeting(bytes, GetParam())) {
      EXPECT_EQ(encode(*got, GetParam()), bytes) << "one text for each greeting";
    }
  }
}

}  // namespace peerd::net::unicast_frame_test
