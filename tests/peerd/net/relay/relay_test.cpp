#include "peerd/net/relay/relay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/net/relay/relay_fixture.hpp"

namespace peerd::relay::relay_test {

using namespace relay::testing_support;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

using RelayTest = RelayFixture;

TEST_F(RelayTest, PassesARegionOnToThoseWhoWantItAlone) {
  RelayUnderTest relay(io, 0);
  relay.relay->start();
  Peer a(by_relay({0}), {0, 5}), b(by_relay({0}), {0, 5}), c(by_relay({0}), {0, 6});
  ASSERT_TRUE(run_until(io, [&] { return a.can_send(5) && a.can_send(6) && b.can_send(5) && c.can_send(5); }));
  a.send(5, "of a");
  b.send(0, "of b");
  c.send(6, "nobody else wants it");
  ASSERT_TRUE(run_until(io, [&] { return a.heard.size() == 1 && b.heard.size() == 1 && c.heard.size() == 1; }));
  EXPECT_THAT(a.heard, ElementsAre("0 of b"));
  EXPECT_THAT(b.heard, ElementsAre("5 of a"));
  EXPECT_THAT(c.heard, ElementsAre("0 of b"));
  EXPECT_EQ(c.transport->counters().out_unwanted, 1u);
  EXPECT_EQ(relay.relay->counters().forwarded, 3u);
  b.leave(5);
  ASSERT_TRUE(run_until(io, [&] { return !a.can_send(5); }));
}

// The way of a datagram: island, relay, root, relay, island; and a single peer at the root.
TEST_F(RelayTest, ATreeJoinsIslandsAndSinglePeers) {
  RelayUnderTest root(io, 0), left(io, 1, {0}), right(io, 2, {0});
  left.join_island(0), right.join_island(1);
  for (auto* each : {&root, &left, &right}) each->relay->start();
  Peer a(on_island(0), {0, 5}), a2(on_island(0), {0}), b(on_island(1), {0, 5}), c(by_relay({0}), {0, 7});
  const auto all_know = [&] {
    return left.relay->table().wanted_by_others(0).regions == std::vector{RegionId{0}, RegionId{5}, RegionId{7}} &&
           right.relay->table().wanted_by_others(0).regions == std::vector{RegionId{0}, RegionId{5}, RegionId{7}} &&
           c.can_send(5);
  };
  ASSERT_TRUE(run_until(io, all_know));
  finish();
  a.send(5, "across"), c.send(5, "to both"), b.send(7, "to the single one"), a2.send(0, "to all");
  ASSERT_TRUE(run_until(io, [&] { return a.heard.size() == 2 && b.heard.size() == 3 && c.heard.size() == 2; }));
  EXPECT_THAT(a.heard, UnorderedElementsAre("5 to both", "0 to all"));
  EXPECT_THAT(a2.heard, IsEmpty());
  EXPECT_THAT(b.heard, UnorderedElementsAre("5 across", "5 to both", "0 to all"));
  EXPECT_THAT(c.heard, UnorderedElementsAre("7 to the single one", "0 to all"));
  EXPECT_EQ(left.relay->path().size(), 2u);
  EXPECT_EQ(left.relay->path().back(), root.relay->instance());
}

TEST_F(RelayTest, RelaysInACircleAgreeOnARoot) {
  RelayUnderTest one(io, 0, {1}), two(io, 1, {2}), three(io, 2, {0});
  for (auto* each : {&one, &two, &three}) each->relay->start();
  const auto all = {&one, &two, &three};
  const auto roots = [&] {
    return std::ranges::count_if(all, [](const auto* each) { return each->relay->path().size() == 1; });
  };
  ASSERT_TRUE(run_until(io, [&] {
    return roots() == 1 && std::ranges::any_of(all, [](const auto* each) { return each->relay->path().size() == 3; });
  }));
  Peer a(by_relay({0})), b(by_relay({1})), c(by_relay({2}));
  ASSERT_TRUE(run_until(io, [&] { return a.can_send(0) && b.can_send(0) && c.can_send(0); }));
  a.send(0, "round");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty() && !c.heard.empty(); }));
  EXPECT_THAT(a.heard, IsEmpty());
  EXPECT_EQ(b.heard.size() + c.heard.size(), 2u);
}

// Whoever has not echoed its number is not heard, and gets no more bytes than it has sent.
TEST_F(RelayTest, AStrangerIsNotHeardAndGetsNoMoreThanItSent) {
  RelayUnderTest relay(io, 0);
  relay.relay->start();
  Peer a(by_relay({0}));
  ASSERT_TRUE(run_until(io, [&] { return relay.peers() == 1; }));
  udp::socket unverified(io, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  const auto header = net::relay_header({RegionId{0}});
  std::vector<std::byte> datagram(header.begin(), header.end());
  datagram.resize(100);
  net::Greeting claims{.instance = 9, .number = 1, .echo = 12'345};
  claims.link = net::LinkNote{.sent_at_ns = 1};
  claims.regions = {RegionId{0}};
  const auto greeting = net::encode(claims, true);
  unverified.send_to(asio::buffer(datagram), address(0));
  unverified.send_to(asio::buffer(greeting), address(0));
  ASSERT_TRUE(run_until(io, [&] { return relay.relay->traffic().in_stranger == 1 && unverified.available() > 0; }));
  std::array<std::byte, 2000> answer{};
  EXPECT_LE(unverified.receive(asio::buffer(answer)), greeting.size());
  EXPECT_EQ(relay.peers(), 1u);
  EXPECT_THAT(a.heard, IsEmpty());
}

TEST_F(RelayTest, DatagramsThatGoRoundEnd) {
  RelayUnderTest relay(io, 0);
  relay.relay->start();
  Peer a(by_relay({0})), b(by_relay({0}));
  ASSERT_TRUE(run_until(io, [&] { return a.can_send(0) && b.can_send(0); }));
  // A neighbour passes on what has been through all relays that it may.
  udp::socket raw(io, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  net::Greeting greeting{.instance = 7, .reply = true};
  raw.send_to(asio::buffer(net::encode(greeting, true)), address(0));
  ASSERT_TRUE(run_until(io, [&] { return raw.available() > 0; }));
  std::array<std::byte, 2000> answer{};
  const auto size = raw.receive(asio::buffer(answer));
  const auto answered = must(net::decode_greeting(std::span(answer).first(size), true));
  greeting = {.instance = 7, .number = 3, .echo = answered.number};
  greeting.link = net::LinkNote{.sent_at_ns = 1};
  raw.send_to(asio::buffer(net::encode(greeting, true)), address(0));
  ASSERT_TRUE(run_until(io, [&] { return relay.peers() == 3; }));
  for (const std::uint8_t hops : {std::uint8_t{0}, std::uint8_t{1}}) {
    const auto header = net::relay_header({RegionId{0}, hops});
    raw.send_to(asio::buffer(header), address(0));
  }
  ASSERT_TRUE(run_until(io, [&] { return a.heard.size() + b.heard.size() == 2; }));
  EXPECT_EQ(relay.relay->counters().out_of_hops, 1u);
}

TEST_F(RelayTest, ASilentPeerIsForgotten) {
  RelayUnderTest relay(io, 0);
  relay.relay->start();
  Peer a(by_relay({0}), {0, 5});
  {
    Peer b(by_relay({0}), {0, 6});
    ASSERT_TRUE(run_until(io, [&] { return relay.peers() == 2 && a.can_send(6); }));
  }
  ASSERT_TRUE(run_until(io, [&] { return relay.peers() == 1 && !a.can_send(6); }));
}

// A recorded greeting that comes as a datagram would be taken for one elsewhere.
TEST_F(RelayTest, GreetingsAreNotPassedOn) {
  RelayUnderTest relay(io, 0);
  relay.relay->start();
  Peer a(by_relay({0})), b(by_relay({0}));
  ASSERT_TRUE(run_until(io, [&] { return a.can_send(0) && b.can_send(0); }));
  a.send(0, "\x67 sealed"), a.send(0, "G open"), a.send(0, "a datagram");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty(); }));
  EXPECT_THAT(b.heard, ElementsAre("0 a datagram"));
  EXPECT_EQ(relay.relay->counters().greetings, 2u);
}

}  // namespace peerd::relay::relay_test
