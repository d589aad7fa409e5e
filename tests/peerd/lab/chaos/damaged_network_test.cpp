#include "peerd/lab/chaos/damaged_network.hpp"

#include <gtest/gtest.h>

namespace peerd::chaos::damaged_network_test {

constexpr sim::VirtualTime kNow{std::chrono::seconds(1)};
constexpr RegionId kRegion{0};

replication::Bytes some(std::size_t size) {
  replication::Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 7);
  return bytes;
}

DamagedNetwork network_of(std::size_t peers, double damage) {
  DamagedNetwork network(5, peers, {{}, damage});
  for (std::size_t i = 0; i < peers; ++i) network.join(i, kRegion);
  return network;
}

TEST(DamagedNetwork, ReachesAllOthersOfARegion) {
  DamagedNetwork network = network_of(3, 0.0);
  network.leave(2, kRegion);
  network.send(kNow, 0, kRegion, some(10));
  ASSERT_FALSE(network.idle());
  const auto arrival = network.take_next();
  EXPECT_EQ(arrival.delivery.to, 1u);
  EXPECT_FALSE(arrival.is_damaged);
  EXPECT_EQ(*arrival.delivery.datagram, some(10));
  EXPECT_TRUE(network.idle());
}

TEST(DamagedNetwork, DamageIsCountedAndChangesTheChecksum) {
  DamagedNetwork network = network_of(2, 0.5);
  for (int i = 0; i < 2000; ++i) network.send(kNow, 0, kRegion, some(1 + i % 40));
  std::uint64_t damaged = 0, shorter = 0;
  while (!network.idle()) {
    const auto arrival = network.take_next();
    const auto size = static_cast<std::size_t>(1 + arrival.delivery.number % 40);
    const bool is_same = *arrival.delivery.datagram == some(size);
    EXPECT_EQ(arrival.is_damaged, !is_same);
    if (!arrival.is_damaged) continue;
    ++damaged;
    shorter += arrival.delivery.datagram->size() < size ? 1 : 0;
    EXPECT_NE(checksum(*arrival.delivery.datagram), checksum(some(size)));
  }
  EXPECT_EQ(network.counters().damaged, damaged);
  EXPECT_GT(damaged, 800u);
  EXPECT_LT(damaged, 1200u);
  EXPECT_GT(shorter, 100u);
}

TEST(DamagedNetwork, ACutHasADirectionAndEndsWithTheLastOne) {
  DamagedNetwork network = network_of(2, 0.0);
  const auto passes = [&](std::size_t from) {
    network.send(kNow, from, kRegion, some(3));
    const bool any = !network.idle();
    while (!network.idle()) (void)network.take_next();
    return any;
  };
  network.cut(0, 1, true);
  network.cut(0, 1, true);
  EXPECT_FALSE(passes(0));
  EXPECT_TRUE(passes(1));
  network.cut(0, 1, false);
  EXPECT_FALSE(passes(0));
  network.cut(0, 1, false);
  EXPECT_TRUE(passes(0));
  network.cut(1, 0, true);
  network.mend_all();
  EXPECT_TRUE(passes(1));
  EXPECT_EQ(network.counters().cut, 2u);
}

TEST(DamagedNetwork, WhatIsPutOffComesThenInItsOrder) {
  DamagedNetwork network = network_of(2, 0.0);
  network.send(kNow, 0, kRegion, some(1));
  network.send(kNow, 0, kRegion, some(2));
  const sim::VirtualTime later = kNow + std::chrono::seconds(3);
  const auto first = network.take_next();
  network.put_off(network.take_next(), later);
  network.put_off(first, later);
  EXPECT_EQ(network.next_arrival(), later);
  EXPECT_EQ(network.take_next().delivery.datagram->size(), 1u);
  EXPECT_EQ(network.take_next().delivery.datagram->size(), 2u);
}

// RFC 1071, section 3, with the length that a header would have.
TEST(DamagedNetwork, TheChecksumIsThatOfTheInternet) {
  const replication::Bytes example{std::byte{0x00}, std::byte{0x01}, std::byte{0xf2}, std::byte{0x03},
                                   std::byte{0xf4}, std::byte{0xf5}, std::byte{0xf6}, std::byte{0xf7}};
  EXPECT_EQ(checksum(example), static_cast<std::uint16_t>(~(0xddf2 + 8)));
}

}  // namespace peerd::chaos::damaged_network_test
