#include "peerd/net/relay/island.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/peerd/net/relay/relay_fixture.hpp"

namespace peerd::relay::island_test {

using namespace relay::testing_support;
using testing::ElementsAre;

using IslandTest = RelayFixture;

// A region that no other island wants does not leave its own, and is not even received by the relay there.
TEST_F(IslandTest, WhatNobodyElseWantsStaysOnItsIsland) {
  RelayUnderTest root(io, 0), left(io, 1, {0}), right(io, 2, {0});
  left.join_island(0), right.join_island(1);
  for (auto* each : {&root, &left, &right}) each->relay->start();
  Peer a(on_island(0), {0, 5}), a2(on_island(0), {0, 5}), b(on_island(1), {0, 6});
  ASSERT_TRUE(run_until(io, [&] { return left.relay->table().wanted_by_others(0).regions.size() == 2; }));
  finish();
  const auto before = left.relay->networks()[0]->counters().packets_in;
  for (int i = 0; i < 50; ++i) a.send(5, "local");
  a.send(0, "done");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty() && a2.heard.size() == 51; }));
  EXPECT_THAT(b.heard, ElementsAre("0 done"));
  EXPECT_LT(left.relay->networks()[0]->counters().packets_in - before, 50u);
}

// Both hear all of the island; exactly one passes it on, and the other one when the first is gone.
TEST_F(IslandTest, OfTwoRelaysOnAnIslandOneIsActive) {
  RelayUnderTest root(io, 0);
  auto one = std::make_unique<RelayUnderTest>(io, 1, std::vector{0u});
  auto two = std::make_unique<RelayUnderTest>(io, 2, std::vector{0u});
  Island *const island_of_one = &one->join_island(0), *const island_of_two = &two->join_island(0);
  root.relay->start(), one->relay->start(), two->relay->start();
  Peer a(on_island(0)), b(by_relay({0}));
  ASSERT_TRUE(run_until(io, [&] {
    return (island_of_one->is_active() != island_of_two->is_active()) && root.relay->neighbours().count() == 3 &&
           b.can_send(0);
  }));
  int sent = 0;
  ASSERT_TRUE(run_until(io, [&] {
    if (b.heard.empty()) a.send(0, std::to_string(sent++));
    return !b.heard.empty();
  }));
  b.heard.clear();
  for (int i = 0; i < 20; ++i) a.send(0, "once");
  b.send(0, "back once");
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() >= 20 && !a.heard.empty(); }));
  EXPECT_EQ(std::ranges::count(b.heard, "0 once"), 20);
  EXPECT_THAT(a.heard, ElementsAre("0 back once"));
  (island_of_one->is_active() ? one : two).reset();
  b.heard.clear();
  ASSERT_TRUE(run_until(io, [&] {
    a.send(0, "by the other");
    return !b.heard.empty();
  }));
}

// The relay is there first, and others elsewhere want a region before anybody is on its island.
TEST_F(IslandTest, TheFirstPeerOfAnIslandIsHeardInRegionsThatAreWantedAlready) {
  RelayUnderTest relay(io, 0);
  const Island& island = relay.join_island(0);
  relay.relay->start();
  Peer single(by_relay({0}), {0, 5});
  ASSERT_TRUE(run_until(io, [&] { return island.is_active() && relay.peers() == 1; }));
  finish();
  Peer first(on_island(0), {0, 9});
  ASSERT_TRUE(run_until(io, [&] { return single.can_send(9); }));
  finish();
  first.send(5, "wanted before");
  ASSERT_TRUE(run_until(io, [&] { return !single.heard.empty(); }));
  EXPECT_THAT(single.heard, ElementsAre("5 wanted before"));
}

// The relay has two interfaces, here two sockets: what one of them sends there the other one does not take.
TEST_F(IslandTest, ARelayThatIsOnANetworkTwiceDoesNotHearItself) {
  RelayUnderTest relay(io, 0);
  relay.join_island(0), relay.join_island(0);
  relay.relay->start();
  Peer single(by_relay({0})), member(on_island(0));
  ASSERT_TRUE(run_until(io, [&] {
    return single.can_send(0) && relay.relay->networks()[0]->is_active() && relay.relay->networks()[1]->is_active() &&
           relay.relay->networks()[0]->peers() == 1 && relay.relay->networks()[1]->peers() == 1;
  }));
  ASSERT_TRUE(run_until(io, [&] {
    return std::ranges::any_of(
        relay.said, [](const std::string& line) { return line.find("on that network twice") != std::string::npos; });
  }));
  finish();
  single.send(0, "once");
  ASSERT_TRUE(run_until(io, [&] { return member.heard.size() >= 2; }));  // by each of the two
  finish();
  EXPECT_LE(member.heard.size(), 2u);
  EXPECT_THAT(single.heard, testing::IsEmpty());
}

}  // namespace peerd::relay::island_test
