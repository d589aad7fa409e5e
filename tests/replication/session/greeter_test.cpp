#include "replication/session/greeter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "replication/wire/hello_lists.hpp"
#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::greeter_test {

using namespace test;

class Greeting : public testing::Test {
 protected:
  // A member whose hello number 5 came at `at`, and that echoes this peer.
  Member& heard(std::uint32_t id, HostTime at) {
    Member& m = add_member(members, id, at);
    m.hello = 5;
    m.hello_rx = at;
    m.received[kWholeScene].on_datagram(5);
    echo_us(m, 0.001);
    return m;
  }
  std::vector<PeerId> echoed(HostTime now) {
    Hello hello;
    greeter.fill_echoes(hello, now, false);
    std::vector<PeerId> peers;
    for (const Echo& echo : hello.echoes) peers.push_back(echo.peer);
    greeter.on_hello_sent(now, kWholeScene, ++number);
    return peers;
  }

  PeerConfig own = config(1);
  Membership members{own.lost_after};
  Greeter greeter{own, members};
  std::uint32_t number = 0;
};

// ---- when ----

TEST_F(Greeting, IsDueAtOnceAtTheStart) {
  EXPECT_EQ(greeter.next_deadline(), HostTime::min());
  greeter.start(host(5s));
  EXPECT_FALSE(greeter.is_due(host(5s) - 1ns));
  EXPECT_TRUE(greeter.is_due(host(5s)));
}

TEST_F(Greeting, GoesFasterBeforeItHasASession) {
  for (const auto& [synchronised, period] : {std::pair(false, Duration{100ms}), {true, own.settled_hello_period}}) {
    greeter.schedule_next(host(5s), synchronised);
    EXPECT_FALSE(greeter.is_due(host(5s) + period - 1ns));
    EXPECT_TRUE(greeter.is_due(host(5s) + period));
  }
}

TEST_F(Greeting, HurriesToTheUsualPeriodAndNeverDelays) {
  greeter.schedule_next(host(5s), true);
  greeter.hurry();
  EXPECT_FALSE(greeter.is_due(host(5s) + own.hello_period - 1ns));
  EXPECT_TRUE(greeter.is_due(host(5s) + own.hello_period));
  greeter.schedule_next(host(5s), false);
  greeter.hurry();
  EXPECT_TRUE(greeter.is_due(host(5100ms)));
}

TEST_F(Greeting, GreetsAnewAtOnceAndSettlesForFourSeconds) {
  greeter.schedule_next(host(5s), true);
  EXPECT_FALSE(greeter.is_settling(host(5s)));
  greeter.greet_anew(host(5100ms));
  EXPECT_TRUE(greeter.is_due(host(5100ms)));
  EXPECT_TRUE(greeter.is_settling(host(9100ms) - 1ns));
  EXPECT_FALSE(greeter.is_settling(host(9100ms)));
  greeter.settle_from(host(9s));
  EXPECT_TRUE(greeter.is_settling(host(13s) - 1ns));
}

TEST_F(Greeting, KeepsAliveWhereNothingElseWasSentForAPeriod) {
  greeter.start(host(5s));
  greeter.note_sent(host(5s), 1);
  greeter.schedule_next(host(5s), true);
  EXPECT_EQ(greeter.next_deadline(), host(5s) + own.hello_period);
  EXPECT_FALSE(greeter.needs_keepalive(host(5s) + own.hello_period - 1ns, 1));
  EXPECT_TRUE(greeter.needs_keepalive(host(5s) + own.hello_period, 1));
  EXPECT_FALSE(greeter.needs_keepalive(host(5s) + own.hello_period, 2)) << "something goes out just now";
  greeter.note_sent(host(5200ms), 1);  // nothing has been sent
  EXPECT_EQ(greeter.next_deadline(), host(5s) + own.hello_period);
  greeter.note_sent(host(5200ms), 2);
  EXPECT_EQ(greeter.next_deadline(), host(5200ms) + own.hello_period);
  greeter.note_sent(host(5900ms), 3);
  EXPECT_EQ(greeter.next_deadline(), host(6s)) << "the hello comes first";
}

// ---- introductions ----

TEST_F(Greeting, OneHelloInEightIntroduces) {
  for (std::uint32_t i = 0; i < 24; ++i) {
    EXPECT_EQ(greeter.introduces(true), i % 8 == 0) << i;
    greeter.on_hello_sent(host(5s), kWholeScene, i + 1);
  }
}

TEST_F(Greeting, IntroducesItselfToWhomItMayConcern) {
  EXPECT_TRUE(greeter.must_introduce(false)) << "without a session";
  EXPECT_FALSE(greeter.must_introduce(true));
  Member& two = add_member(members, 2);
  EXPECT_TRUE(greeter.must_introduce(true)) << "it does not echo this peer";
  two.echo.unreachable = true;
  EXPECT_FALSE(greeter.must_introduce(true));
  echo_us(two, 0.001);
  EXPECT_FALSE(greeter.must_introduce(true));
  greeter.introduce_once();
  greeter.introduce_once();
  EXPECT_TRUE(greeter.must_introduce(true));
  (void)greeter.introduction({}, {}, {});
  EXPECT_FALSE(greeter.must_introduce(true)) << "one is enough";
}

struct NewsCase {
  const char* name;
  std::size_t own_objects;
  double loss;
  int introductions;
};
class News : public Greeting, public testing::WithParamInterface<NewsCase> {};
TEST_P(News, AreIntroducedAsOftenAsLossAndLengthAskFor) {
  echo_us(add_member(members, 2), GetParam().loss);
  greeter.reintroduce(GetParam().own_objects);
  int introductions = 0;
  for (; greeter.must_introduce(true) && introductions < 100; ++introductions) {
    (void)greeter.introduction({}, {}, {});
  }
  EXPECT_EQ(introductions, GetParam().introductions);
}
INSTANTIATE_TEST_SUITE_P(Table, News,
                         testing::Values(NewsCase{"GoodLink", 0, 0.001, 3}, NewsCase{"FullList", 49, 0.001, 3},
                                         NewsCase{"TwoLists", 50, 0.001, 6}, NewsCase{"ThreeLists", 120, 0.001, 9},
                                         NewsCase{"BadLink", 0, 0.2, 5}, NewsCase{"WorstLink", 0, 0.9, 6}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST_F(Greeting, EnteringASessionIsNews) {
  greeter.on_session_entered(0);
  greeter.on_session_entered(0);
  EXPECT_EQ(greeter.sessions(), 2u);
  EXPECT_TRUE(greeter.must_introduce(true));
}

TEST_F(Greeting, AnIntroductionSaysWhoThisPeerIs) {
  own.decisions.viewpoint.emplace().pose.position = {1, 2, 3};
  const std::vector<ObjectId> objects{ObjectId{4}, ObjectId{7}};
  const Introduction i = greeter.introduction(objects, sim(3s), sim(4s));
  EXPECT_EQ(i.name, own.name);
  EXPECT_EQ(i.world_hash, own.world_hash);
  EXPECT_EQ(i.owned, objects);
  EXPECT_EQ(i.start, sim(3s));
  EXPECT_EQ(i.world_zero, sim(4s));
  ASSERT_TRUE(i.viewpoint);
  EXPECT_EQ(i.viewpoint->pose.position, Vec3(1, 2, 3));
}

TEST_F(Greeting, ManyOwnObjectsTakeTurns) {
  std::vector<ObjectId> all;
  for (std::uint32_t i = 0; i < 120; ++i) all.push_back(ObjectId{2 * i});
  std::set<ObjectId> named;
  for (int i = 0; i < 3; ++i) {
    const Introduction some = greeter.introduction(all, {}, {});
    EXPECT_EQ(some.owned.size(), 50u);
    EXPECT_TRUE(std::ranges::is_sorted(some.owned));
    named.insert(some.owned.begin(), some.owned.end());
  }
  EXPECT_EQ(named.size(), 120u);
}

// ---- echoes ----

TEST_F(Greeting, EchoesWhomItHasHeard) {
  heard(2, host(9s));
  heard(3, host(9s)).hello = 0;          // it has not said hello
  heard(4, host(10s) - kHeldMax - 1ns);  // too long ago
  heard(5, host(9s)).received.clear();   // to regions alone
  heard(6, host(10s) - kHeldMax);
  Hello hello;
  greeter.fill_echoes(hello, host(10s), false);
  ASSERT_EQ(hello.echoes.size(), 2u);
  EXPECT_EQ(hello.echoes[0].peer, PeerId{2});
  EXPECT_EQ(hello.echoes[0].hello, 5u);
  EXPECT_EQ(hello.echoes[0].hold_time, 1s);
  EXPECT_EQ(hello.echoes[0].received, members.find(PeerId{2})->received[kWholeScene].received());
  EXPECT_EQ(hello.echoes[0].loss, members.find(PeerId{2})->received[kWholeScene].loss());
  EXPECT_EQ(hello.echoes[1].peer, PeerId{6});
}

TEST_F(Greeting, AllAreNamedInAsManyHellosAsItTakes) {
  for (std::uint32_t id = 2; id < 52; ++id) heard(id, host(9s));
  std::set<PeerId> named;
  std::vector<PeerId> last;
  for (std::size_t i = 0; i < hellos_to_name(50); ++i) {
    const std::vector<PeerId> peers = echoed(host(10s));
    EXPECT_EQ(peers.size(), kEchoesMax);
    if (!last.empty()) {
      EXPECT_EQ(peers.front(), last.back()) << "two hellos that follow each other leave nobody out between them";
    }
    named.insert(peers.begin(), peers.end());
    last = peers;
  }
  EXPECT_EQ(named.size(), 50u);
}

TEST_F(Greeting, EveryOtherHelloBeginsWithANewcomer) {
  for (std::uint32_t id = 2; id < 52; ++id) heard(id, host(9s));
  for (const std::uint32_t id : {40u, 45u}) members.find(PeerId{id})->synchronised = false;
  std::map<PeerId, int> first;
  for (int i = 0; i < 8; ++i) ++first[echoed(host(10s)).front()];
  EXPECT_EQ(first[PeerId{40}], 2);
  EXPECT_EQ(first[PeerId{45}], 2);
}

TEST_F(Greeting, ALostPeerIsLeftOutUntilAllOthersHaveBeenNamed) {
  for (std::uint32_t id = 2; id < 18; ++id) heard(id, host(9s));  // two hellos a turn
  greeter.on_peer_lost(PeerId{3});                                // and is here again
  int hellos = 0;
  for (; hellos < 10; ++hellos) {
    if (std::ranges::count(echoed(host(10s)), PeerId{3}) > 0) break;
  }
  EXPECT_EQ(hellos, 2);
}

// All peers together say hello to all as often, however many there are: each the more seldom.
TEST_F(Greeting, FarHellosOfAllTogetherStayAsMany) {
  for (const std::uint32_t peers : {100u, 400u}) {
    PeerConfig conf = config(1);
    conf.large = {.above = 48, .hellos_per_s = 10.0};
    Membership many{conf.lost_after, conf.large};
    for (std::uint32_t p = 2; p <= peers; ++p) (void)many.note_far(host(0s), PeerId{p}, 1);
    (void)many.follow_size(true);
    Greeter one{conf, many};
    one.on_size_changed(host(0s), 0);
    const HostTime end = host(4000s);
    std::size_t sent = 0;
    Duration longest_promise{0};
    for (HostTime t = host(0s); t < end; t += 100ms) {
      if (!one.is_far_due(t, false)) continue;
      longest_promise = std::max(longest_promise, one.schedule_next_far(t, false));
      ++sent;
    }
    const double all_per_s = static_cast<double>(peers) * static_cast<double>(sent) / 4000.0;
    EXPECT_NEAR(all_per_s, 10.0, 1.5) << peers;
    EXPECT_EQ(longest_promise, from_seconds(2.0 * peers / 10.0))
        << "the longest interval is one and a half times the mean";
  }
}

// Many may have come while this peer waited: its next hello is put off (RFC 3550, 6.3.3).
TEST_F(Greeting, AFarHelloIsPutOffWherePeersHaveCome) {
  PeerConfig conf = config(1);
  conf.large = {.above = 4, .hellos_per_s = 1.0};
  Membership many{conf.lost_after, conf.large};
  for (std::uint32_t p = 2; p <= 10; ++p) (void)many.note_far(host(0s), PeerId{p}, 1);
  (void)many.follow_size(true);
  Greeter one{conf, many};
  one.on_size_changed(host(0s), 0);
  HostTime t = host(0s);
  for (int i = 0; i < 3; ++i, t += 250ms) {
    ASSERT_TRUE(one.is_far_due(t, false)) << "three go at once";
    (void)one.schedule_next_far(t, false);
  }
  for (std::uint32_t p = 11; p <= 100; ++p) (void)many.note_far(host(0s), PeerId{p}, 1);
  EXPECT_FALSE(one.is_far_due(t + 16s, false)) << "longer than any interval of ten";
  EXPECT_TRUE(one.is_far_due(t + 151s, false));
  EXPECT_TRUE(one.is_far_due(t + 1s, true)) << "the leader says hello all the time";
}

TEST_F(Greeting, WhoLeadsEchoesEachFarHelloOnceAndJoiningPeersFirst) {
  Membership many{1750ms, LargeSession{.above = 4, .hellos_per_s = 10.0}};
  for (std::uint32_t p = 2; p <= 20; ++p) {
    FarPeer& far = *many.note_far(host(0s), PeerId{p}, 1).first;
    far.synchronised = p != 20;
    far.far_hello.receive(p, host(1s) + std::chrono::milliseconds(p));
  }
  std::set<PeerId> echoed;
  Hello first, second, third;
  Greeter::fill_far_echoes(first, host(2s), many);
  Greeter::fill_far_echoes(second, host(2s), many);
  Greeter::fill_far_echoes(third, host(2s), many);
  ASSERT_EQ(first.echoes.size(), kEchoesMax);
  EXPECT_EQ(first.echoes[0].peer, PeerId{20}) << "it waits for session time";
  EXPECT_EQ(first.echoes[0].hello, 20u);
  EXPECT_EQ(first.echoes[0].hold_time, 980ms);
  std::vector<Echo> taken;
  ASSERT_TRUE(take_echoes(packed(first.echoes), taken)) << "also of a peer's first few datagrams";
  ASSERT_EQ(taken.size(), kEchoesMax);
  EXPECT_EQ(taken[0].hello, 20u);
  for (const Hello* hello : {&first, &second}) {
    for (const Echo& echo : hello->echoes) EXPECT_TRUE(echoed.insert(echo.peer).second);
  }
  EXPECT_EQ(echoed.size(), 19u);
  EXPECT_TRUE(third.echoes.empty());
}

// Joining peers say hello ten times a second: those whose last echo is longest ago have the next ones.
TEST_F(Greeting, JoiningPeersTakeTurns) {
  Membership many{1750ms, LargeSession{.above = 4, .hellos_per_s = 10.0}};
  for (std::uint32_t p = 2; p <= 40; ++p) (void)many.note_far(host(0s), PeerId{p}, 1);
  std::map<PeerId, int> echoes;
  for (int i = 1; i <= 9; ++i) {
    const HostTime now = host(1s) + i * 100ms;
    for (std::uint32_t p = 2; p <= 40; ++p) many.find_far(PeerId{p})->far_hello.receive(100 * p + i, now);
    Hello hello;
    Greeter::fill_far_echoes(hello, now, many);
    for (const Echo& echo : hello.echoes) ++echoes[echo.peer];
  }
  EXPECT_EQ(echoes.size(), 39u);
  for (const auto& [peer, times] : echoes) EXPECT_EQ(times, 3) << peer.value;
}

TEST_F(Greeting, WhoLeadsSaysHelloMoreOftenWhileAPeerJoins) {
  PeerConfig conf = config(1);
  conf.large = {.above = 4, .hellos_per_s = 1.0};
  Membership many{conf.lost_after, conf.large};
  for (std::uint32_t p = 2; p <= 10; ++p) many.note_far(host(0s), PeerId{p}, 1).first->synchronised = true;
  (void)many.follow_size(true);
  Greeter one{conf, many};
  one.on_size_changed(host(0s), 0);
  HostTime t = host(0s);
  for (int i = 0; i < 3; ++i, t += 250ms) (void)one.schedule_next_far(t, true);
  EXPECT_FALSE(one.is_far_due(t, true));
  EXPECT_TRUE(one.is_far_due(t + 250ms, true));
  many.find_far(PeerId{10})->synchronised = false;
  many.find_far(PeerId{10})->far_hello.receive(1, t);
  EXPECT_FALSE(one.is_far_due(t - 151ms, true));
  EXPECT_TRUE(one.is_far_due(t - 150ms, true));
  EXPECT_FALSE(many.has_joining(t + 2s)) << "it has gone";
}

TEST_F(Greeting, RemembersWhenItsHellosWent) {
  greeter.on_hello_sent(host(1s), kWholeScene, 3);
  greeter.on_hello_sent(host(2s), kWholeScene, 7);
  EXPECT_EQ(greeter.sent_at(kWholeScene, 3), host(1s));
  EXPECT_EQ(greeter.sent_at(kWholeScene, 7), host(2s));
  EXPECT_EQ(greeter.sent_at(kWholeScene, 5), std::nullopt);
  greeter.on_hello_sent(host(1s) + kHeldMax, kWholeScene, 8);
  EXPECT_EQ(greeter.sent_at(kWholeScene, 3), host(1s));
  greeter.on_hello_sent(host(1s) + kHeldMax + 1ns, kWholeScene, 9);
  EXPECT_EQ(greeter.sent_at(kWholeScene, 3), std::nullopt);
  EXPECT_EQ(greeter.sent_at(kWholeScene, 7), host(2s));
}

}  // namespace peerd::replication::greeter_test
