#include "peerd/net/greeting/known_peers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace peerd::net::known_peers_test {

using namespace std::chrono_literals;
using asio::ip::udp;
using testing::ElementsAre;
using testing::IsEmpty;
using Outcome = KnownPeers::Outcome;

constexpr SipKey kKey{1, 2};

udp::endpoint at(const char* address, std::uint16_t port = 4000) { return {asio::ip::make_address(address), port}; }
const udp::endpoint kA = at("192.0.2.1"), kB = at("192.0.2.2"), kC = at("192.0.2.3");

Greeting from(std::uint32_t instance, std::vector<RegionId> regions = {}, std::vector<udp::endpoint> peers = {}) {
  return {.instance = instance, .number = 7, .regions = std::move(regions), .peers = std::move(peers)};
}
// A greeting of a peer that receives at that address.
Outcome echoed(KnownPeers& known, HostTime now, const udp::endpoint& at, Greeting greeting) {
  greeting.echo = known.number_for(at);
  return known.on_greeting(now, at, greeting);
}
std::vector<udp::endpoint> addresses(const KnownPeers& known) {
  std::vector<udp::endpoint> all;
  for (const auto& peer : known.peers()) all.push_back(peer.at);
  return all;
}

TEST(KnownPeers, SeedsAreGreetedUntilTheyAnswerAndAgainWhenTheyAreGone) {
  KnownPeers known({.key = kKey, .seeds = {kA, kB, kA}});
  EXPECT_THAT(known.candidates(), ElementsAre(kA, kB));
  EXPECT_EQ(echoed(known, HostTime{1s}, kA, from(2)), Outcome::kNew);
  EXPECT_EQ(echoed(known, HostTime{2s}, kA, from(2)), Outcome::kKnown);
  EXPECT_THAT(known.candidates(), ElementsAre(kB));
  known.forget(HostTime{7s});
  EXPECT_THAT(addresses(known), ElementsAre(kA));
  known.forget(HostTime{7s + 1ns});
  EXPECT_THAT(addresses(known), IsEmpty());
  EXPECT_THAT(known.candidates(), ElementsAre(kA, kB));
}

// Whoever records a greeting can send it once more, from the address of who made it.
TEST(KnownPeers, ARecordedGreetingIsWorthNothingAfterTwoPeriods) {
  KnownPeers known({.key = kKey});
  known.forget(HostTime{1000s});
  Greeting greeting = from(2);
  greeting.echo = known.number_for(kA);
  const auto outcome_at = [&](Duration time) {
    known.forget(HostTime{time});
    return known.on_greeting(HostTime{time}, kA, greeting);
  };
  EXPECT_EQ(outcome_at(1001s), Outcome::kNew);
  EXPECT_EQ(outcome_at(1020s), Outcome::kNew) << "in the next period, from 1020 s on";
  EXPECT_EQ(outcome_at(1049s), Outcome::kNew) << "it was silent for more than 5 s";
  EXPECT_EQ(outcome_at(1050s), Outcome::kUnverified);
  EXPECT_EQ(echoed(known, HostTime{1050s}, kA, from(2)), Outcome::kKnown) << "it has the new number by now";
  known.forget(HostTime{1056s});
  EXPECT_EQ(outcome_at(1057s), Outcome::kUnverified) << "and once it has left, nobody brings it back";
  EXPECT_THAT(known.peers(), IsEmpty());
}

// A forged address does not receive its number, and the forger knows the numbers of other addresses only.
TEST(KnownPeers, APeerThatDoesNotEchoItsNumberIsUnverified) {
  KnownPeers known({.key = kKey});
  const std::uint64_t of_others[] = {0,
                                     99,
                                     known.instance(),
                                     known.number_for(kB),
                                     known.number_for(at("192.0.2.1", 4001)),
                                     KnownPeers({.key = {3, 4}}).number_for(kA)};
  for (const std::uint64_t echo : of_others) {
    Greeting g = from(2, {}, {kC});
    g.echo = echo;
    EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, g), Outcome::kUnverified);
  }
  EXPECT_THAT(known.peers(), IsEmpty());
  EXPECT_THAT(known.candidates(), IsEmpty());
}

TEST(KnownPeers, AnUnverifiedGoodbyeRemovesNobody) {
  KnownPeers known({.key = kKey});
  echoed(known, HostTime{1s}, kA, from(2));
  Greeting forged{.instance = 2, .leaving = true};
  for (const std::uint64_t echo : {std::uint64_t{0}, known.number_for(kB)}) {
    forged.echo = echo;
    EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, forged), Outcome::kUnverified);
    EXPECT_EQ(known.peers().size(), 1u);
  }
  EXPECT_EQ(echoed(known, HostTime{1s}, kA, forged), Outcome::kLeft);
  EXPECT_THAT(known.peers(), IsEmpty());
}

TEST(KnownPeers, NumbersFitTheGreetingAndAreNeverThatOfNone) {
  const KnownPeers known({.key = kKey});
  std::set<std::uint64_t> numbers;
  for (const char* address : {"192.0.2.1", "192.0.2.2", "2001:db8::1", "fe80::1%1", "fe80::1%2"}) {
    for (std::uint16_t port = 1; port <= 1000; ++port) numbers.insert(known.number_for(at(address, port)));
  }
  EXPECT_EQ(numbers.size(), 5000u);
  EXPECT_GT(*numbers.begin(), 0u);
  EXPECT_LT(*numbers.rbegin(), std::uint64_t{1} << kAddressNumberBits);
}

// Our own greeting to that address, as it comes back from there.
Greeting ours(const KnownPeers& known, const udp::endpoint& to) {
  return {.instance = known.instance(), .number = known.number_for(to), .reply = true};
}

TEST(KnownPeers, OurOwnAddressAmongTheSeedsIsFoundOut) {
  KnownPeers known({.key = kKey, .seeds = {kA, kB}});
  EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, ours(known, kA)), Outcome::kOwn);
  EXPECT_THAT(known.candidates(), ElementsAre(kB));
  EXPECT_THAT(known.peers(), IsEmpty());
  echoed(known, HostTime{1s}, kB, from(2, {}, {kA, kC}));
  EXPECT_THAT(known.candidates(), ElementsAre(kC)) << "nor is it greeted because another names it";
  EXPECT_EQ(known.on_greeting(HostTime{2s}, kC, ours(known, kC)), Outcome::kOwn);
  EXPECT_THAT(known.candidates(), IsEmpty());
}

// Our instance is in all our greetings, so anyone may send it from any address.
TEST(KnownPeers, NobodyElseMakesAnAddressOurs) {
  KnownPeers known({.key = kKey, .seeds = {kA}});
  for (const std::uint64_t number : {std::uint64_t{0}, known.number_for(kB)}) {
    const Greeting forged{.instance = known.instance(), .number = number, .echo = number};
    EXPECT_EQ(known.on_greeting(HostTime{1s}, kA, forged), Outcome::kOwn);
    EXPECT_THAT(known.candidates(), ElementsAre(kA));
  }
  EXPECT_EQ(known.on_greeting(HostTime{1s}, kB, ours(known, kB)), Outcome::kOwn);
  EXPECT_EQ(known.own(), 0u) << "nobody would have greeted it";
}

TEST(KnownPeers, OurOwnAddressesAreBoundedAndForgotten) {
  KnownPeers known({.key = kKey, .seeds = {kA, kB, kC}, .most = 2});
  for (const auto& seed : {kA, kB, kC}) known.on_greeting(HostTime{1s}, seed, ours(known, seed));
  EXPECT_EQ(known.own(), 2u);
  EXPECT_THAT(known.candidates(), ElementsAre(kC));
  known.forget(HostTime{61s});
  EXPECT_THAT(known.candidates(), ElementsAre(kC));
  known.forget(HostTime{61s + 1ns});
  EXPECT_EQ(known.own(), 0u);
  EXPECT_THAT(known.candidates(), ElementsAre(kA, kB, kC)) << "it may be another's by now";
}

TEST(KnownPeers, TheNamedAreGreetedForSomeRounds) {
  KnownPeers known({.key = kKey});
  echoed(known, HostTime{1s}, kA, from(2, {}, {kB, kC, at("0.0.0.0"), at("224.0.0.1"), at("192.0.2.9", 0)}));
  EXPECT_THAT(known.candidates(), ElementsAre(kB, kC));
  echoed(known, HostTime{2s}, kB, from(3));
  EXPECT_THAT(known.candidates(), ElementsAre(kC));
  known.forget(HostTime{4s + 1ns});
  EXPECT_THAT(known.candidates(), IsEmpty());
}

TEST(KnownPeers, AProcessWithTwoAddressesIsOnePeer) {
  KnownPeers known({.key = kKey});
  echoed(known, HostTime{1s}, kA, from(2));
  EXPECT_EQ(echoed(known, HostTime{1s}, kB, from(2)), Outcome::kTwice);
  EXPECT_THAT(addresses(known), ElementsAre(kA));
  EXPECT_TRUE(known.has_echoed(kA));
  EXPECT_TRUE(known.has_echoed(kB)) << "it may send from there";
  EXPECT_FALSE(known.has_echoed(kC));
  known.forget(HostTime{6s + 1ns});
  EXPECT_FALSE(known.has_echoed(kA) || known.has_echoed(kB));
}

// Both peers have two addresses, and each knows the other by an address that the other does not send from. In this
// network a datagram to an address of one subnet comes from the sender's address of that subnet.
TEST(KnownPeers, TwoThatKnowEachOtherByTheWrongPairOfAddressesFindTheRightOne) {
  const udp::endpoint a1 = at("192.0.2.1"), a2 = at("198.51.100.1"), b1 = at("192.0.2.2"), b2 = at("198.51.100.2");
  constexpr SipKey kOther{3, 4};
  for (const bool swapped : {false, true}) {  // which of the two has the lower instance
    KnownPeers a({.key = swapped ? kOther : kKey}), b({.key = swapped ? kKey : kOther});
    const auto meets = [](KnownPeers& to, const KnownPeers& sender, HostTime now, const udp::endpoint& source) {
      return echoed(to, now, source, {.instance = sender.instance(), .number = 7, .regions = {RegionId{1}}});
    };
    EXPECT_EQ(meets(a, b, HostTime{0s}, b2), Outcome::kNew);
    EXPECT_EQ(meets(b, a, HostTime{0s}, a1), Outcome::kNew);
    std::size_t matched = 0;
    for (HostTime now{1s}; now < HostTime{30s}; now += 1s) {
      a.forget(now), b.forget(now);
      ASSERT_EQ(a.peers().size(), 1u) << "b is here all the time";
      ASSERT_EQ(b.peers().size(), 1u) << "a is here all the time";
      const bool a_by_1 = a.peers()[0].at == b1, b_by_1 = b.peers()[0].at == a1;
      matched += a_by_1 == b_by_1;
      meets(b, a, now, a_by_1 ? a1 : a2);
      meets(a, b, now, b_by_1 ? b1 : b2);
    }
    EXPECT_GE(matched, 24u) << "within five seconds and for ever";
  }
}

TEST(KnownPeers, WhoSpeaksWhereItIsKnownDoesNotMove) {
  KnownPeers known({.key = kKey});
  for (HostTime now{1s}; now < HostTime{20s}; now += 1s) {
    echoed(known, now, kA, from(2));
    echoed(known, now, kB, from(2));
    EXPECT_THAT(addresses(known), ElementsAre(kA));
  }
}

TEST(KnownPeers, WhoStartsAgainAtAnAddressReplacesTheOldOne) {
  KnownPeers known({.key = kKey});
  echoed(known, HostTime{1s}, kA, from(2, {RegionId{1}}));
  EXPECT_EQ(echoed(known, HostTime{1s}, kA, from(3)), Outcome::kNew);
  ASSERT_EQ(known.peers().size(), 1u);
  EXPECT_EQ(known.peers().front().instance, 3u);
  EXPECT_FALSE(KnownPeers::wants(known.peers().front(), RegionId{1}));
}

TEST(KnownPeers, ARegionGoesToWhoWantsIt) {
  KnownPeers known({.key = kKey});
  echoed(known, HostTime{1s}, kA, from(2, {RegionId{1}, RegionId{5}}));
  Greeting all = from(3);
  all.all_regions = true;
  echoed(known, HostTime{1s}, kB, all);
  const auto& some = known.peers()[0];
  EXPECT_TRUE(KnownPeers::wants(some, RegionId{5}));
  EXPECT_FALSE(KnownPeers::wants(some, RegionId{2}));
  EXPECT_TRUE(KnownPeers::wants(known.peers()[1], RegionId{2}));
  echoed(known, HostTime{2s}, kA, from(2, {RegionId{2}}));
  EXPECT_FALSE(KnownPeers::wants(known.peers()[0], RegionId{5}));
  EXPECT_TRUE(KnownPeers::wants(known.peers()[0], RegionId{2}));
}

// A configured address whose peer answers from another one stays a candidate, so bare answers continue for ever.
TEST(KnownPeers, ABareGreetingDoesNotTakeBackWhatItsSenderWants) {
  KnownPeers known({.key = kKey});
  const Greeting bare{.instance = 2, .number = 8, .reply = true};
  EXPECT_EQ(echoed(known, HostTime{1s}, kA, bare), Outcome::kNew);
  EXPECT_FALSE(KnownPeers::wants(known.peers().front(), RegionId{1}));
  echoed(known, HostTime{1s}, kA, from(2, {RegionId{1}}));
  EXPECT_EQ(echoed(known, HostTime{2s}, kA, bare), Outcome::kKnown);
  EXPECT_TRUE(KnownPeers::wants(known.peers().front(), RegionId{1}));
  EXPECT_EQ(known.peers().front().number, 8u) << "that it does say";
  Greeting all = from(2);
  all.all_regions = true;
  echoed(known, HostTime{2s}, kA, all);
  echoed(known, HostTime{3s}, kA, bare);
  EXPECT_TRUE(KnownPeers::wants(known.peers().front(), RegionId{7}));
  known.forget(HostTime{8s});
  EXPECT_EQ(known.peers().size(), 1u) << "it is a sign of life";
  echoed(known, HostTime{8s}, kA, from(2));
  EXPECT_FALSE(KnownPeers::wants(known.peers().front(), RegionId{7})) << "a full one takes it back";
}

// Two peers have met through a third, which has left, and an outage lasts longer than the time until silence.
TEST(KnownPeers, WhoFellSilentIsGreetedForTenMinutesAndRarelyThen) {
  KnownPeers known({.key = kKey});
  echoed(known, HostTime{1s}, kC, from(3, {}, {kA}));
  echoed(known, HostTime{1s}, kA, from(2));
  echoed(known, HostTime{1s}, kC, {.instance = 3, .leaving = true});
  known.forget(HostTime{7s});
  EXPECT_THAT(known.peers(), IsEmpty());
  EXPECT_THAT(known.candidates(), ElementsAre(kA)) << "who said goodbye is not";
  echoed(known, HostTime{8s}, kC, from(4, {}, {kA}));
  known.forget(HostTime{12s});
  EXPECT_THAT(known.candidates(), ElementsAre(kA)) << "being named does not shorten it";
  echoed(known, HostTime{12s}, kC, {.instance = 4, .leaving = true});
  known.forget(HostTime{607s});
  EXPECT_THAT(known.candidates(), ElementsAre(kA));
  known.forget(HostTime{611s});
  EXPECT_THAT(known.candidates(), IsEmpty());
  for (const Duration outage : {Duration(700s), Duration(24h)}) {
    known.forget(HostTime{outage});
    EXPECT_THAT(known.candidates(), ElementsAre(kA)) << "nobody else is left who names it";
    known.forget(HostTime{outage + 4s});
    EXPECT_THAT(known.candidates(), IsEmpty()) << "for a few rounds";
  }
  echoed(known, HostTime{25h}, kA, {.instance = 2, .leaving = true});
  known.forget(HostTime{48h});
  EXPECT_THAT(known.candidates(), IsEmpty());
}

TEST(KnownPeers, WhoAnswersAgainOrSaysGoodbyeIsNoCandidateAnyMore) {
  for (const bool leaving : {false, true}) {
    KnownPeers known({.key = kKey});
    echoed(known, HostTime{1s}, kA, from(2));
    known.forget(HostTime{7s});
    EXPECT_THAT(known.candidates(), ElementsAre(kA));
    Greeting greeting = from(2);
    greeting.leaving = leaving;
    EXPECT_EQ(echoed(known, HostTime{8s}, kA, greeting), leaving ? Outcome::kLeft : Outcome::kNew);
    EXPECT_THAT(known.candidates(), IsEmpty());
    EXPECT_EQ(known.introduced(), 0u);
  }
}

TEST(KnownPeers, NoMoreOfTheSilentAreGreetedThanAreAllowed) {
  KnownPeers known({.key = kKey, .most = 2});
  for (const std::uint32_t round : {0u, 1u, 2u}) {
    const HostTime now{10s * static_cast<int>(round)};
    for (const std::uint32_t i : {0u, 1u}) {
      const std::uint32_t n = 2 * round + i;
      echoed(known, now, at("192.0.2.9", static_cast<std::uint16_t>(n + 1)), from(n + 2));
    }
    known.forget(now + 6s);
    EXPECT_EQ(known.introduced(), 2u);
  }
}

TEST(KnownPeers, NoMoreThanAreAllowed) {
  KnownPeers known({.key = kKey, .most = 3});
  std::vector<udp::endpoint> many;
  for (std::uint16_t port = 1; port <= 10; ++port) many.push_back(at("192.0.2.7", port));
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(echoed(known, HostTime{1s}, at("192.0.2.8", static_cast<std::uint16_t>(i + 1)), from(i + 2, {}, many)),
              Outcome::kNew);
  }
  EXPECT_EQ(echoed(known, HostTime{1s}, kA, from(50)), Outcome::kFull);
  EXPECT_EQ(known.peers().size(), 3u);
  EXPECT_EQ(known.candidates().size(), 3u);
}

TEST(KnownPeers, ItNamesTheOthersAndInTurnsWhereTheyAreMany) {
  KnownPeers known({.key = kKey});
  echoed(known, HostTime{1s}, kA, from(2));
  echoed(known, HostTime{1s}, kB, from(3));
  echoed(known, HostTime{1s}, at("127.0.0.1"), from(4));
  EXPECT_THAT(known.introductions(known.peers()[0], 0), ElementsAre(kB)) << "another computer's 127.0.0.1 is another";
  EXPECT_THAT(known.introductions(known.peers()[2], 0), ElementsAre(kA, kB));
  for (std::uint16_t i = 0; i < 60; ++i)
    echoed(known, HostTime{1s}, at("192.0.2.100", static_cast<std::uint16_t>(i + 1)), from(10u + i));
  std::set<udp::endpoint> named;
  for (std::size_t round = 0; round < 4; ++round) {
    const auto some = known.introductions(known.peers()[0], round);
    EXPECT_LE(some.size(), kGreetingPeersMax);
    named.insert(some.begin(), some.end());
  }
  EXPECT_EQ(named.size(), 61u) << "all but itself and the loopback address";
}

}  // namespace peerd::net::known_peers_test
