#include "replication/session/membership.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/worlds.hpp"

namespace peerd::replication::membership_test {

using namespace test;
using Heard = Membership::Heard;
constexpr PeerId kTwo{2}, kThree{3}, kFive{5};

Echo echo(const Received& received) { return {kTwo, received.highest, 0s, received, 0.0}; }

TEST(Receipt, HasWhatCameSinceTheFirst) {
  Receipt receipt(Received{10, 10, ~std::uint64_t{0}});  // of what came before nothing is known
  EXPECT_FALSE(receipt.has(10));
  receipt.on_echo(echo({20, 2, ~std::uint64_t{0b100}}));  // all but 18
  receipt.on_echo(echo({15, 15, ~std::uint64_t{0}}));     // overtaken
  for (std::uint32_t number = 1; number < 30; ++number) {
    EXPECT_EQ(receipt.has(number), number > 10 && number <= 20 && number != 18) << number;
    EXPECT_EQ(receipt.lacks(number), number == 18) << number;
  }
}

TEST(Receipt, SaysOfWhatIsLongAgoOnlyThatItCame) {
  Receipt receipt(Received{10, 10, ~std::uint64_t{0}});
  receipt.on_echo(echo({200, 1, ~std::uint64_t{0b10}}));
  EXPECT_TRUE(receipt.has(137) && receipt.lacks(199));
  EXPECT_FALSE(receipt.has(136) || receipt.lacks(136));
  receipt.on_echo(echo({200, 100, ~std::uint64_t{0}}));  // 199 came late
  EXPECT_TRUE(receipt.has(101));
  EXPECT_FALSE(receipt.has(100) || receipt.lacks(100));
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

TEST(Membership, RemovesOnce) {
  Membership members(2s);
  for (PeerId p : {kFive, kTwo, kThree}) members.on_datagram(host(0s), p, 1);
  EXPECT_TRUE(members.remove(kThree).has_value());
  EXPECT_FALSE(members.remove(kThree).has_value());
}

}  // namespace peerd::replication::membership_test
