#include "peerd/net/known_peers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace peerd::net {
namespace {

using namespace std::chrono_literals;
using asio::ip::udp;
using testing::ElementsAre;
using testing::IsEmpty;
using Outcome = KnownPeers::Outcome;

constexpr std::uint64_t kUs = 1;

udp::endpoint at(const char* address, std::uint16_t port = 4000) { return {asio::ip::make_address(address), port}; }
const udp::endpoint kA = at("192.0.2.1"), kB = at("192.0.2.2"), kC = at("192.0.2.3");

Greeting from(std::uint64_t instance, std::vector<RegionId> regions = {}, std::vector<udp::endpoint> peers = {}) {
  return {.instance = instance, .echo = kUs, .regions = std::move(regions), .peers = std::move(peers)};
}
std::vector<udp::endpoint> addresses(const KnownPeers& known) {
  std::vector<udp::endpoint> all;
  for (const auto& peer : known.peers()) all.push_back(peer.at);
  return all;
}

TEST(KnownPeers, SeedsAreGreetedUntilTheyAnswerAndAgainWhenTheyAreGone) {
  KnownPeers known({.instance = kUs, .seeds = {kA, kB, kA}});
  EXPECT_THAT(known.candidates(), ElementsAre(kA, kB));
  EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, from(2)), Outcome::kNew);
  EXPECT_EQ(known.on_greeting(HostTime{2s}, kA, from(2)), Outcome::kKnown);
  EXPECT_THAT(known.candidates(), ElementsAre(kB));
  known.forget(HostTime{7s});
  EXPECT_THAT(addresses(known), ElementsAre(kA));
  known.forget(HostTime{7s + 1ns});
  EXPECT_THAT(addresses(known), IsEmpty());
  EXPECT_THAT(known.candidates(), ElementsAre(kA, kB));
}

// An address that somebody made up doesn't hear our instance, so it can't echo it.
TEST(KnownPeers, WhoDoesNotEchoUsIsAStrangerAndIsBelievedNothing) {
  KnownPeers known({.instance = kUs});
  for (const std::uint64_t echo : {std::uint64_t{0}, std::uint64_t{99}}) {
    Greeting g = from(2, {}, {kC});
    g.echo = echo;
    EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, g), Outcome::kStranger);
  }
  EXPECT_THAT(known.peers(), IsEmpty());
  EXPECT_THAT(known.candidates(), IsEmpty());
}

TEST(KnownPeers, AStrangersGoodbyeRemovesNobody) {
  KnownPeers known({.instance = kUs});
  known.on_greeting(HostTime{1s}, kA, from(2));
  Greeting forged{.instance = 2, .echo = 0, .leaving = true};
  EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, forged), Outcome::kStranger);
  EXPECT_EQ(known.peers().size(), 1u);
  forged.echo = kUs;
  EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, forged), Outcome::kLeft);
  EXPECT_THAT(known.peers(), IsEmpty());
}

TEST(KnownPeers, OurOwnAddressAmongTheSeedsIsFoundOut) {
  KnownPeers known({.instance = kUs, .seeds = {kA, kB}});
  EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, {.instance = kUs}), Outcome::kOwn);
  EXPECT_THAT(known.candidates(), ElementsAre(kB));
  EXPECT_THAT(known.peers(), IsEmpty());
  known.on_greeting(HostTime{1s}, kB, from(2, {}, {kA}));
  EXPECT_THAT(known.candidates(), IsEmpty()) << "nor is it greeted because another names it";
}

TEST(KnownPeers, TheNamedAreGreetedForSomeRounds) {
  KnownPeers known({.instance = kUs});
  known.on_greeting(HostTime{1s}, kA, from(2, {}, {kB, kC, at("0.0.0.0"), at("224.0.0.1"), at("192.0.2.9", 0)}));
  EXPECT_THAT(known.candidates(), ElementsAre(kB, kC));
  known.on_greeting(HostTime{2s}, kB, from(3));
  EXPECT_THAT(known.candidates(), ElementsAre(kC));
  known.forget(HostTime{4s + 1ns});
  EXPECT_THAT(known.candidates(), IsEmpty());
}

TEST(KnownPeers, AProcessWithTwoAddressesIsOnePeer) {
  KnownPeers known({.instance = kUs});
  known.on_greeting(HostTime{1s}, kA, from(2));
  EXPECT_EQ(known.on_greeting(HostTime{1s}, kB, from(2)), Outcome::kTwice);
  EXPECT_THAT(addresses(known), ElementsAre(kA));
}

TEST(KnownPeers, WhoStartsAgainAtAnAddressReplacesTheOldOne) {
  KnownPeers known({.instance = kUs});
  known.on_greeting(HostTime{1s}, kA, from(2, {RegionId{1}}));
  EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, from(3)), Outcome::kNew);
  ASSERT_EQ(known.peers().size(), 1u);
  EXPECT_EQ(known.peers().front().instance, 3u);
  EXPECT_FALSE(KnownPeers::wants(known.peers().front(), RegionId{1}));
}

TEST(KnownPeers, ARegionGoesToWhoWantsIt) {
  KnownPeers known({.instance = kUs});
  known.on_greeting(HostTime{1s}, kA, from(2, {RegionId{1}, RegionId{5}}));
  Greeting all = from(3);
  all.all_regions = true;
  known.on_greeting(HostTime{1s}, kB, all);
  const auto& some = known.peers()[0];
  EXPECT_TRUE(KnownPeers::wants(some, RegionId{5}));
  EXPECT_FALSE(KnownPeers::wants(some, RegionId{2}));
  EXPECT_TRUE(KnownPeers::wants(known.peers()[1], RegionId{2}));
  known.on_greeting(HostTime{2s}, kA, from(2, {RegionId{2}}));
  EXPECT_FALSE(KnownPeers::wants(known.peers()[0], RegionId{5}));
  EXPECT_TRUE(KnownPeers::wants(known.peers()[0], RegionId{2}));
}

TEST(KnownPeers, NoMoreThanAreAllowed) {
  KnownPeers known({.instance = kUs, .most = 3});
  std::vector<udp::endpoint> many;
  for (std::uint16_t port = 1; port <= 10; ++port) many.push_back(at("192.0.2.7", port));
  for (std::uint64_t i = 0; i < 3; ++i) {
    EXPECT_EQ(
        known.on_greeting(HostTime{1s}, at("192.0.2.8", static_cast<std::uint16_t>(i + 1)), from(i + 2, {}, many)),
        Outcome::kNew);
  }
  EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, from(50)), Outcome::kFull);
  EXPECT_EQ(known.peers().size(), 3u);
  EXPECT_EQ(known.candidates().size(), 3u);
}

TEST(KnownPeers, ItNamesTheOthersAndInTurnsWhereTheyAreMany) {
  KnownPeers known({.instance = kUs});
  known.on_greeting(HostTime{1s}, kA, from(2));
  known.on_greeting(HostTime{1s}, kB, from(3));
  known.on_greeting(HostTime{1s}, at("127.0.0.1"), from(4));
  EXPECT_THAT(known.introductions(known.peers()[0], 0), ElementsAre(kB)) << "another computer's 127.0.0.1 is another";
  EXPECT_THAT(known.introductions(known.peers()[2], 0), ElementsAre(kA, kB));
  for (std::uint16_t i = 0; i < 60; ++i)
    known.on_greeting(HostTime{1s}, at("192.0.2.100", static_cast<std::uint16_t>(i + 1)), from(10u + i));
  std::set<udp::endpoint> named;
  for (std::size_t round = 0; round < 4; ++round) {
    const auto some = known.introductions(known.peers()[0], round);
    EXPECT_LE(some.size(), kGreetingPeersMax);
    named.insert(some.begin(), some.end());
  }
  EXPECT_EQ(named.size(), 61u) << "all but itself and the loopback address";
}

}  // namespace
}  // namespace peerd::net
