#include "replication/membership.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/worlds.hpp"

namespace peerd::replication {
namespace {

using namespace test;
using Heard = Membership::Heard;
constexpr PeerId kTwo{2}, kThree{3}, kFive{5};

Echo echo(std::uint32_t highest, std::uint32_t missing) { return {kTwo, highest, 0s, highest, missing, 0.0}; }

TEST(Receipt, HasWhatCameSinceTheLastLoss) {
  Receipt receipt{10, 10, 3};  // the first echo: of what came before nothing is known
  EXPECT_FALSE(receipt.has(10));
  receipt.on_echo(echo(15, 3));
  EXPECT_TRUE(receipt.has(11) && receipt.has(15));
  EXPECT_FALSE(receipt.has(16));
  receipt.on_echo(echo(20, 4));  // one of 16 to 20 was lost, or one came late: which is not said
  for (std::uint32_t number = 1; number < 30; ++number) EXPECT_FALSE(receipt.has(number));
  receipt.on_echo(echo(18, 3));  // overtaken
  receipt.on_echo(echo(25, 4));
  EXPECT_FALSE(receipt.has(20));
  EXPECT_TRUE(receipt.has(21));
}

TEST(Membership, KnowsOnePeerByItsBoot) {
  Membership members(2s);
  EXPECT_EQ(members.on_datagram(host(0s), kTwo, 10), Heard::kJoined);
  EXPECT_EQ(members.on_datagram(host(1s), kTwo, 10), Heard::kKnown);
  EXPECT_EQ(members.on_datagram(host(1s), kThree, 1), Heard::kJoined);
  EXPECT_EQ(members.on_datagram(host(1s), kTwo, 9), Heard::kStale);
  EXPECT_EQ(members.on_datagram(host(1s), kTwo, 11), Heard::kRestarted);
  EXPECT_EQ(members.on_datagram(host(1s), kTwo, 10), Heard::kStale);
  EXPECT_EQ(members.all().size(), 2u);
}

TEST(Membership, ARestartForgetsTheEarlierLife) {
  Membership members(2s);
  members.on_datagram(host(0s), kTwo, 10);
  members.find(kTwo)->last_sequence[ObjectId{1}] = 100;
  members.find(kTwo)->synchronised = true;
  members.on_datagram(host(1s), kTwo, 11);
  EXPECT_TRUE(members.find(kTwo)->last_sequence.empty());
  EXPECT_FALSE(members.find(kTwo)->synchronised);
}

TEST(Membership, AStaleDatagramIsNoSignOfLife) {
  Membership members(2s);
  members.on_datagram(host(0s), kTwo, 10);
  members.on_datagram(host(1s), kTwo, 9);
  EXPECT_EQ(members.next_expiry(), host(2s));
}

TEST(Membership, SilenceExpiresAscendingAndAtOnce) {
  Membership members(2s);
  EXPECT_EQ(members.next_expiry(), std::nullopt);
  for (PeerId p : {kFive, kTwo, kThree}) members.on_datagram(host(0s), p, 1);
  members.on_datagram(host(1s), kThree, 1);
  EXPECT_EQ(members.next_expiry(), host(2s));
  EXPECT_TRUE(members.expire(host(2s) - 1ns).empty());
  const auto lost = members.expire(host(2s));  // what next_expiry names is due then, or a driver would spin
  ASSERT_EQ(lost.size(), 2u);
  EXPECT_EQ(lost[0].first, kTwo);
  EXPECT_EQ(lost[1].first, kFive);
  EXPECT_EQ(members.find(kTwo), nullptr);
  EXPECT_NE(members.find(kThree), nullptr);
  EXPECT_EQ(members.next_expiry(), host(3s));
}

TEST(Membership, LowestCountsTheSynchronisedOnly) {
  Membership members(2s);
  for (PeerId p : {kFive, kTwo, kThree}) members.on_datagram(host(0s), p, 1);
  EXPECT_EQ(members.lowest_synchronised(), std::nullopt);
  members.find(kFive)->synchronised = true;
  EXPECT_EQ(members.lowest_synchronised(), kFive);
  members.find(kThree)->synchronised = true;
  EXPECT_EQ(members.lowest_synchronised(), kThree);
  EXPECT_TRUE(members.remove(kThree).has_value());
  EXPECT_FALSE(members.remove(kThree).has_value());
  EXPECT_EQ(members.lowest_synchronised(), kFive);
}

}  // namespace
}  // namespace peerd::replication
