#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/replication/peer/lan.hpp"

// Joining, leaving, clocks: several peers on one network.
namespace peerd::replication::peer_session_test {

using namespace test;
using testing::IsEmpty;

std::string three_boxes() {
  return box("A", "1 1 1", "0 0 0", "velocityVector 1 0 0") + box("B", "1 1 1", "0 5 0", "velocityVector 0 0 2") +
         box("C", "1 1 1", "0 9 0");
}

// The largest difference of two peers' session times.
Duration spread(const Lan& lan) {
  SimTime low = SimTime::max(), high = SimTime::min();
  for (std::size_t i = 0; i < lan.size(); ++i) {
    low = std::min(low, lan.session_now(i));
    high = std::max(high, lan.session_now(i));
  }
  return high - low;
}

struct Case {
  const char* name;
  Link link;
  Duration ahead;  // of each next peer's clock
};
class Session : public testing::TestWithParam<Case> {};

TEST_P(Session, ThreePeersMeetAndAgreeOnTheTime) {
  const World world(three_boxes());
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Lan lan(world, GetParam().link, seed);
    lan.add(config(1, {{world["A"], false}}));
    lan.add(config(2, {{world["B"], false}}), GetParam().ahead);
    lan.add(config(3, {{world["C"], false}}), -GetParam().ahead);
    lan.run_until(5s);
    ASSERT_TRUE(lan.all_in_session());
    lan.run_until(30s);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(lan.peer(i).members().all().size(), 2u);
      EXPECT_EQ(lan.peer(i).owners().size(), 3u);
      EXPECT_THAT(lan.seen<ClockStepped>(i), IsEmpty());
      EXPECT_EQ(lan.seen<Synchronised>(i).size(), 1u);
      const Duration off = lan.session_now(i) - lan.session_now(0);
      EXPECT_LE(std::chrono::abs(off), *lan.peer(i).clock().error_bound(lan.host_now(i))) << i;
      EXPECT_LE(*lan.peer(i).clock().error_bound(lan.host_now(i)),
                GetParam().link.latency + GetParam().link.jitter + 5ms);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Table, Session,
                         testing::Values(Case{"OneHost", {5ms, 0ms, 0, 0}, 0s},
                                         Case{"ClocksApart", {5ms, 0ms, 0, 0}, 3s},
                                         Case{"FarApart", {200ms, 0ms, 0, 0}, 3s},
                                         Case{"Jitter", {20ms, 80ms, 0, 0}, 3s}, Case{"Loss", {20ms, 20ms, 0.2, 0}, 3s},
                                         Case{"Duplicates", {20ms, 80ms, 0.05, 0.3}, 3s}),
                         [](const auto& c) { return std::string(c.param.name); });

// After each peer has sent, all peers know of every object that moves, although a fifth of all datagrams is lost.
TEST(PeerSession, LossHealsWithinTheTimeThreshold) {
  const World world(three_boxes());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Lan lan(world, {20ms, 20ms, 0.2, 0}, seed);
    lan.add(config(1, {{world["A"], false}}));
    lan.add(config(2, {{world["B"], false}}));
    lan.add(config(3, {{world["C"], false}}));
    lan.run_until(40s);
    for (const char* name : {"A", "B", "C"}) {
      const SimTime t = lan.session_now(0);
      for (std::size_t i = 1; i < 3; ++i) {
        EXPECT_LT((lan.peer(i).ghost(world[name], t).position - lan.peer(0).ghost(world[name], t).position).norm(),
                  0.5);
      }
    }
  }
}

// What the file gives to the founder, at peers that know nothing of each other's settings.
PeerConfig may_found(const World& world, std::uint32_t id, std::vector<OwnedObject> owned = {}) {
  PeerConfig c = config(id, std::move(owned));
  if (c.owned.empty()) c.owned_by_founder = {{world["A"]}};
  return c;
}
void expect_owner(const Lan& lan, ObjectId object, PeerId owner) {
  for (std::size_t i = 0; i < lan.size(); ++i) {
    EXPECT_EQ(lan.peer(i).owner(object), owner) << "at peer " << lan.peer(i).id().value;
  }
}

TEST(Founder, IsTheLowestIdOfThoseThatStartTogether) {
  const World world(three_boxes());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Lan lan(world, {20ms, 20ms, 0.2, 0}, seed);
    for (const std::uint32_t id : {3, 1, 2}) lan.add(may_found(world, id));
    for (; lan.now() < 20s; lan.run_until(lan.now() + 10ms)) {
      int owners = 0;
      for (std::size_t i = 0; i < 3; ++i) owners += lan.peer(i).owns_any();
      ASSERT_LE(owners, 1);
    }
    expect_owner(lan, world["A"], PeerId{1});
    const SimTime t = lan.session_now(1);
    EXPECT_GT(lan.peer(1).truth(world["A"], t).position.x(), 1.0) << "its velocityVector launches it";
    EXPECT_NEAR(lan.peer(0).ghost(world["A"], t).position.x(), lan.peer(1).truth(world["A"], t).position.x(), 0.5);
  }
}

// A peer that joins takes nothing from a founder, however low its id, and nothing that a founder has left behind.
TEST(Founder, KeepsItsObjectsFromALateJoinerAndLeavesThemBehind) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(may_found(world, 5));
  lan.run_until(3s);
  expect_owner(lan, world["A"], PeerId{5});
  lan.add(may_found(world, 1));
  for (; lan.now() < 8s; lan.run_until(lan.now() + 10ms)) ASSERT_FALSE(lan.peer(1).owns_any());
  expect_owner(lan, world["A"], PeerId{5});
  EXPECT_EQ(lan.peer(0).follows(), PeerId{1}) << "the lower id leads session time all the same";
  lan.leave(0);
  lan.run_until(12s);
  EXPECT_EQ(lan.peer(1).owner(world["A"]), kNobody);
  const Vec3 left = lan.peer(1).ghost(world["A"], lan.session_now(1)).position;
  lan.run_until(14s);
  EXPECT_EQ(lan.peer(1).ghost(world["A"], lan.session_now(1)).position, left) << "an orphan stands";
}

TEST(Founder, GivesWayToAPeerWhoseSettingsOwnTheObject) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(may_found(world, 1));
  lan.add(may_found(world, 2));
  lan.run_until(3s);
  expect_owner(lan, world["A"], PeerId{1});
  lan.add(may_found(world, 7, {{world["A"]}}));
  lan.run_until(6s);
  expect_owner(lan, world["A"], PeerId{7});
  lan.run_until(12s);
  expect_owner(lan, world["A"], PeerId{7});
  for (const std::size_t i : {0, 1}) {
    ASSERT_EQ(lan.seen<FounderGaveWay>(i).size(), 1u) << "and it stays so";
    EXPECT_EQ(lan.seen<FounderGaveWay>(i)[0].founder, PeerId{1});
    EXPECT_EQ(lan.seen<FounderGaveWay>(i)[0].owner, PeerId{7});
    EXPECT_THAT(lan.seen<OwnershipConflict>(i), IsEmpty()) << "nobody has made a mistake";
  }
}

// Two founders meet, as two owners by their settings do.
TEST(Founder, OfTwoSessionsTheLowerIdKeepsTheObject) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(may_found(world, 2));
  lan.add(may_found(world, 1), 3s);
  lan.part({1});
  lan.run_until(4s);
  EXPECT_TRUE(lan.peer(0).owns_any() && lan.peer(1).owns_any());
  lan.part({});
  lan.run_until(8s);
  expect_owner(lan, world["A"], PeerId{1});
}

TEST(PeerSession, ALonePeerListensFirstThenFounds) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(3));
  lan.run_until(999ms);
  EXPECT_FALSE(lan.peer(0).clock().synchronised());
  lan.run_until(1200ms);
  EXPECT_TRUE(lan.peer(0).clock().synchronised());
  const auto seen = lan.seen<Synchronised>(0);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].follows, PeerId{3});
  ASSERT_FALSE(lan.node(0).outputs.empty());
  EXPECT_TRUE(std::holds_alternative<Join>(lan.node(0).outputs[0].second)) << "the group is joined before all else";
}

// An object under way must look right to a newcomer at once, not after the next update that is due anyhow.
TEST(PeerSession, ALateJoinerGetsTheStates) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(1, {{world["A"], false}}));
  lan.run_until(4s);
  lan.add(config(2, {}), 3s);
  lan.run_until(6s);
  ASSERT_TRUE(lan.all_in_session());
  const SimTime t = lan.session_now(0);
  EXPECT_GT(lan.peer(0).truth(world["A"], t).position.x(), 4.0);
  EXPECT_LT((lan.peer(1).ghost(world["A"], t).position - lan.peer(0).truth(world["A"], t).position).norm(), 1e-6);
  bool joiner = false;
  for (const Published& p : lan.seen<Published>(0)) joiner = joiner || p.reason == PublishReason::kJoiner;
  EXPECT_TRUE(joiner);
}

TEST(PeerSession, TheOthersSeeWhatALateJoinerRuns) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(1, {{world["A"], false}}));
  lan.run_until(4s);
  lan.add(config(2, {{world["B"], false}}), 3s);
  lan.run_until(6500ms);
  ASSERT_TRUE(lan.all_in_session());
  const SimTime t = lan.session_now(1);
  EXPECT_GT(lan.peer(1).truth(world["B"], t).position.z(), 1.0);
  EXPECT_LT((lan.peer(0).ghost(world["B"], t).position - lan.peer(1).truth(world["B"], t).position).norm(), 0.5);
}

TEST(PeerSession, AGoodbyeFreezesAtOnce) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(1, {{world["A"], false}}));
  lan.add(config(2, {{world["B"], false}}));
  lan.run_until(5s);
  lan.leave(1);
  lan.run_until(5s + 20ms);
  const auto lost = lan.seen<PeerLost>(0);
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_TRUE(lost[0].left_gracefully);
  EXPECT_EQ(lost[0].name, "peer2");
  ASSERT_EQ(lan.seen<ObjectOrphaned>(0).size(), 1u);
  EXPECT_EQ(lan.seen<ObjectOrphaned>(0)[0].object, world["B"]);
  EXPECT_EQ(lan.peer(0).owner(world["B"]), PeerId{0});
  const KinematicState then = lan.peer(0).ghost(world["B"], lan.session_now(0));
  lan.run_until(8s);
  EXPECT_TRUE(same_bits(lan.peer(0).ghost(world["B"], lan.session_now(0)), at_rest(then.pose())));
}

TEST(PeerSession, SilenceFreezesWithinTwoSeconds) {
  const World world(three_boxes());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Lan lan(world, {50ms, 20ms, 0.2, 0}, seed);
    lan.add(config(1, {{world["A"], false}}));
    lan.add(config(2, {{world["B"], false}}));
    lan.run_until(8s);
    ASSERT_TRUE(lan.seen<PeerLost>(0).empty());
    lan.kill(1);
    lan.run_until(10s);
    ASSERT_EQ(lan.seen<PeerLost>(0).size(), 1u);
    EXPECT_FALSE(lan.seen<PeerLost>(0)[0].left_gracefully);
    ASSERT_EQ(lan.seen<ObjectOrphaned>(0).size(), 1u);
    EXPECT_TRUE(lan.peer(0).ghost(world["B"], lan.session_now(0)).velocity.isZero(0.0));
  }
}

TEST(PeerSession, ARestartedPeerIsReadmitted) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(1, {{world["A"], false}}));
  lan.add(config(2, {{world["B"], false}}));
  lan.run_until(5s);
  PeerConfig again = config(2, {{world["B"], false}});
  again.incarnation = 101;
  lan.restart(1, again);  // before anybody noticed
  lan.run_until(12s);
  const auto joined = lan.seen<PeerJoined>(0);
  ASSERT_EQ(joined.size(), 2u);
  EXPECT_TRUE(joined[1].restarted);
  EXPECT_EQ(joined[1].name, "peer2");
  const SimTime t = lan.session_now(1);
  EXPECT_LT((lan.peer(0).ghost(world["B"], t).position - lan.peer(1).truth(world["B"], t).position).norm(), 1e-6);
  EXPECT_THAT(lan.seen<IdInUse>(1), IsEmpty()) << "what it said itself in its last life is no other's";
}

// Acknowledgements of the last incarnation's datagrams, which were many more than this one has sent, do not count for
// this one.
TEST(PeerSession, AcknowledgementsOfTheLastIncarnationDoNotCount) {
  const World world(three_boxes());
  for (Duration when{0}; when < 8s; when += 500ms) {  // the other introduces itself in one of eight hellos
    SCOPED_TRACE(when.count());
    Lan lan(world, {400ms, 0ms, 0, 0});
    lan.add(config(1, {{world["A"], false}}));
    lan.add(config(2, {{world["B"], false}}));
    lan.run_until(40s + when);
    PeerConfig again = config(2, {{world["B"], false}});
    again.incarnation = 101;
    lan.restart(1, again);
    lan.run_until(45s + when);
    const auto& members = lan.peer(1).members().all();
    ASSERT_TRUE(members.contains(PeerId{1}));
    const auto& acknowledgement = members.at(PeerId{1}).echo.acknowledgement;
    ASSERT_TRUE(acknowledgement);
    EXPECT_LE(acknowledgement->received.highest, lan.peer(1).counters().datagrams_out);
  }
}

// The next incarnation runs fewer objects: those of the last one that it leaves out have no owner. Updates of a
// successor that arrive before its predecessor is lost do not count, neither as its own nor as received.
TEST(PeerSession, ASuccessorIsAcceptedAsSoonAsItsPredecessorIsLost) {
  const World world(box("A", "1 1 1", "0 0 0"));
  const auto at = [](double y) { return [y](SimTime) { return moving({0, y, 0}); }; };
  Lan lan(world);
  lan.add(config(2));
  const std::size_t watcher = lan.add(config(3));
  const std::size_t first = lan.add(config(5, {{world["A"], true}}), 0s, {{world["A"], at(5.0)}});
  lan.run_until(20s);
  lan.kill(first);
  lan.run_until(20100ms);
  lan.add(config(7, {{world["A"], true}}), 0s, {{world["A"], at(9.0)}});
  lan.run_until(28s);
  EXPECT_GT(lan.drops(watcher, "not_owner"), 0u);
  EXPECT_NEAR(lan.peer(watcher).ghost(world["A"], lan.session_now(watcher)).position.y(), 9.0, 1e-2);
}

// The peer's computer blocks all incoming datagrams: the peer founds a session of its own, and keeps announcing it.
TEST(PeerSession, APeerThatReceivesNothingBlocksNobody) {
  const World world(three_boxes());
  Lan lan(world);
  for (std::uint32_t id = 1; id <= 4; ++id) lan.add(config(id));
  lan.filter = [](std::size_t from, std::size_t to, const Message&) { return to != 0 || from == 0; };
  lan.run_until(8s);
  EXPECT_TRUE(lan.all_in_session());
  for (const std::size_t i : {1u, 2u, 3u}) EXPECT_EQ(lan.peer(i).follows(), PeerId{2});
}

// The others do not send it everything three times, nor an introduction with every hello.
TEST(PeerSession, APeerThatReceivesNothingCostsNothingAfterAWhile) {
  const World world(three_boxes());
  std::array<std::uint64_t, 2> bytes{};
  for (const bool unreachable : {false, true}) {
    Lan lan(world);
    const auto weaves = [](SimTime t) {
      std::mt19937_64 random(static_cast<std::uint64_t>(t.time_since_epoch().count()));
      return moving({static_cast<double>(random() % 3), 0, 0});
    };
    lan.add(config(1, {{world["A"], true}}), 0s, {{world["A"], weaves}});
    lan.add(config(2));
    lan.add(config(9));
    lan.filter = [=](std::size_t from, std::size_t to, const Message&) { return !unreachable || to != 2 || from == 2; };
    lan.run_until(40s);
    const std::uint64_t before = lan.peer(0).counters().bytes_out;
    lan.run_until(60s);
    bytes[unreachable ? 1 : 0] = lan.peer(0).counters().bytes_out - before;
  }
  EXPECT_LT(static_cast<double>(bytes[1]), 1.1 * static_cast<double>(bytes[0]));
}

// A hello names 15 of 100 others, but every other entry is a peer that waits for it.
TEST(PeerSession, ANewcomerAmongManyIsInSessionSoon) {
  constexpr std::uint32_t kOthers = 100;
  const World world(three_boxes());
  Lan lan(world, {5ms});
  lan.add(config(1));
  lan.run_until(2s);
  std::uint32_t number = 0;
  const auto run_until = [&](Duration until) {  // the others say a hello a second each, and have heard peer 1
    while (lan.now() < until) {
      ++number;
      for (std::uint32_t k = 0; k < kOthers; ++k) {
        Message m = hello_of(100 + k, lan.host_now(0));
        m.number = number;
        m.hello->sessions = 1;
        m.hello->session_tx = lan.session_now(0);
        m.hello->clock_error = 5ms;
        m.hello->echoes = {{PeerId{1}, 1, 0s, {1, 1, ~std::uint64_t{0}}, 0.0}};
        lan.inject(0, encode(m));
      }
      lan.run_until(lan.now() + 1s);
    }
  };
  run_until(12s);
  ASSERT_EQ(lan.peer(0).members().all().size(), kOthers);
  const std::size_t newcomer = lan.add(config(2));
  run_until(17s);
  EXPECT_TRUE(lan.peer(newcomer).clock().synchronised());
}

TEST(PeerSession, ALatePacketDoesNotReadmitAPeerThatLeft) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(1));
  const std::size_t leaves = lan.add(config(2, {{world["B"], false}}));
  std::vector<Bytes> said;
  lan.on_send = [&](std::size_t from, RegionId, const Message& m) {
    if (from == leaves && m.introduction() != nullptr) said.push_back(encode(m));
  };
  lan.run_until(5s);
  lan.leave(leaves);
  lan.run_until(6s);
  for (const Bytes& again : {said.front(), said.back()}) {
    EXPECT_EQ(lan.inject(0, again).error(), Drop::kStaleIncarnation);
  }
  EXPECT_TRUE(lan.peer(0).members().all().empty());
  PeerConfig anew = config(2);
  ++anew.incarnation;
  lan.restart(leaves, std::move(anew));
  lan.run_until(9s);
  EXPECT_EQ(lan.peer(0).members().all().size(), 1u);
}

TEST(PeerSession, ARestartReleasesObjectsNoLongerOwned) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(1, {{world["A"], false}}));
  lan.add(config(2, {{world["B"], false}}));
  lan.run_until(5s);
  PeerConfig again = config(2);
  again.incarnation = 101;
  lan.restart(1, again);
  lan.run_until(10s);
  EXPECT_EQ(lan.peer(0).owner(world["B"]), PeerId{0});
  EXPECT_TRUE(lan.peer(0).ghost(world["B"], lan.session_now(0)).velocity.isZero(0.0));
}

TEST(PeerSession, AMemberThatComesBackWithAnotherWorldIsLost) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(1));
  lan.add(config(2, {{world["B"], false}}));
  lan.run_until(5s);
  PeerConfig again = config(2, {{world["B"], false}});
  again.incarnation = 101;
  again.world_hash = 1;
  lan.restart(1, again);
  lan.run_until(10s);
  EXPECT_EQ(lan.seen<OtherWorld>(0).size(), 1u);
  EXPECT_EQ(lan.peer(0).owner(world["B"]), PeerId{0});
  EXPECT_EQ(lan.seen<ObjectOrphaned>(0).size(), 1u);
}

// An object has no owner once its owner has left, even if that was before this peer had a session.
TEST(PeerSession, APeerLostBeforeTheSessionOwnsNothing) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(5));
  lan.run_until(100ms);
  lan.inject(0, encode(hello_of(7, lan.host_now(0), {world["B"]})));
  EXPECT_EQ(lan.peer(0).owner(world["B"]), PeerId{7});
  lan.run_until(4s);  // never heard again
  EXPECT_EQ(lan.seen<PeerLost>(0).size(), 1u);
  EXPECT_EQ(lan.peer(0).owner(world["B"]), PeerId{0});
}

TEST(PeerSession, TheSessionSurvivesItsFounder) {
  const World world(three_boxes());
  Lan lan(world, {20ms, 10ms, 0, 0});
  lan.add(config(1, {{world["A"], false}}));
  lan.add(config(2, {{world["B"], false}}), 3s);
  lan.add(config(3, {{world["C"], false}}), -3s);
  lan.run_until(6s);
  const Duration before = lan.session_now(1) - sim(lan.now());
  lan.kill(0);
  lan.run_until(20s);
  EXPECT_LE(std::chrono::abs(lan.session_now(1) - lan.session_now(2)), 30ms);
  EXPECT_LE(std::chrono::abs((lan.session_now(1) - sim(lan.now())) - before), 30ms);
  EXPECT_THAT(lan.seen<ClockStepped>(1), IsEmpty());
}

TEST(PeerSession, ALowerIdThatJoinsLaterTakesTheTimeAsItIs) {
  const World world(three_boxes());
  Lan lan(world, {20ms, 10ms, 0, 0});
  lan.add(config(2, {{world["B"], false}}));
  lan.run_until(5s);
  const Duration before = lan.session_now(0) - sim(lan.now());
  lan.add(config(1, {{world["A"], false}}), 3s);
  lan.run_until(20s);
  EXPECT_LE(spread(lan), 30ms);
  EXPECT_LE(std::chrono::abs((lan.session_now(0) - sim(lan.now())) - before), 30ms);
  EXPECT_THAT(lan.seen<ClockStepped>(0), IsEmpty());
}

// Ghosts and ticks run on session time: it never goes back, whatever the network does.
TEST(PeerSession, SessionTimeNeverRunsBackwards) {
  const World world(three_boxes());
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Lan lan(world, {5ms, 150ms, 0.2, 0.2}, seed);
    for (std::uint32_t i = 0; i < 3; ++i) lan.add(config(i + 1), i * 3s);
    lan.run_until(6s);
    std::vector<SimTime> last(3, SimTime::min());
    for (Duration t = 6s; t < 30s; t += 7ms) {
      lan.run_until(t);
      for (std::size_t i = 0; i < 3; ++i) {
        ASSERT_GE(lan.session_now(i), last[i]);
        last[i] = lan.session_now(i);
      }
    }
  }
}

TEST(PeerSession, TheErrorBoundIsNeverZeroForAFollower) {
  const World world(three_boxes());
  Lan lan(world, {20ms, 10ms, 0, 0});
  for (std::uint32_t i = 0; i < 3; ++i) lan.add(config(i + 1), i * 3s);
  lan.run_until(5s);
  lan.kill(0);  // peer 3 follows peer 2 from now on
  for (Duration t = 5s; t < 10s; t += 5ms) {
    lan.run_until(t);
    ASSERT_GE(lan.peer(2).clock().error_bound(lan.host_now(2)), 20ms) << to_seconds(t);
  }
}

// Two sessions that were founded apart become one, and all peers continue to tick.
TEST(PeerSession, TwoSessionsThatMeetBecomeOne) {
  for (const Duration ahead : {-30s, 30s}) {
    SCOPED_TRACE(to_seconds(ahead));
    const World world(three_boxes());
    Lan lan(world, {20ms, 0ms, 0, 0});
    lan.add(config(1, {{world["A"], false}}));
    lan.add(config(2, {{world["B"], false}}), ahead);
    lan.part({1});
    lan.run_until(5s);
    EXPECT_GE(spread(lan), 29s);
    lan.part({});
    lan.run_until(8s);
    EXPECT_LE(spread(lan), 21ms);
    EXPECT_EQ(lan.seen<ClockStepped>(ahead > 0s ? 0 : 1).size(), 1u) << "forwards, whoever that is";
    EXPECT_EQ(lan.seen<ClockStepped>(ahead > 0s ? 1 : 0).size(), 0u);
    const std::uint64_t ticks = lan.peer(1).counters().ticks;
    lan.run_until(10s);
    EXPECT_GT(lan.peer(1).counters().ticks, ticks + 100);
    const SimTime t = lan.session_now(0);
    EXPECT_LT((lan.peer(1).ghost(world["A"], t).position - lan.peer(0).truth(world["A"], t).position).norm(), 0.5);
    EXPECT_LT((lan.peer(0).ghost(world["B"], t).position - lan.peer(1).truth(world["B"], t).position).norm(), 0.5);
  }
}

// The stamps come from a broken or hostile clock: their differences must not overflow, and time must continue.
TEST(PeerSession, StampsFromTheEndsOfTimeDoNoHarm) {
  constexpr Duration far{std::int64_t{1} << 62};
  const World world(three_boxes());
  for (int signs = 0; signs < 16; ++signs) {
    SCOPED_TRACE(signs);
    Lan lan(world);
    lan.add(config(5, {{world["A"], false}}));
    std::uint32_t last_hello = 0;
    lan.filter = [&](std::size_t, std::size_t, const Message& m) {
      if (m.hello) last_hello = m.number;
      return true;
    };
    lan.run_until(2s);
    for (int i = 0; i < 8; ++i) {
      Message m = hello_of(1, HostTime{signs & 1 ? far : -far});
      const std::uint32_t echoed = signs & 2 ? last_hello : last_hello / 2;
      m.hello->echoes = {
          {PeerId{5}, echoed, signs & 4 ? 10s : 0s, {signs & 8 ? 0xFFFF'FFFF : echoed, 1, ~std::uint64_t{2}}, 0.0}};
      lan.inject(0, encode(m));
      lan.run_until(lan.now() + 50ms);
    }
    const std::uint64_t ticks = lan.peer(0).counters().ticks;
    lan.run_until(lan.now() + 3s);
    EXPECT_GT(lan.peer(0).counters().ticks, ticks + 100);
  }
}

// A peer that was suspended says so, and does not take its own silence for the others'.
TEST(PeerSession, AStoppedPeerBlamesNobody) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(1, {{world["A"], false}}));
  lan.add(config(2, {{world["B"], false}}));
  lan.run_until(4s);
  const double b_before_m = lan.peer(1).truth(world["B"], lan.session_now(1)).position.z();
  lan.kill(1);
  lan.run_until(11s);
  EXPECT_EQ(lan.seen<PeerLost>(0).size(), 1u);
  lan.node(1).running = true;
  lan.run_until(13s);
  ASSERT_EQ(lan.seen<HostSuspended>(1).size(), 1u);
  EXPECT_NEAR(to_seconds(lan.seen<HostSuspended>(1)[0].gap), 7.0, 0.1);
  EXPECT_THAT(lan.seen<PeerLost>(1), IsEmpty());
  // B continues from where it was, and the other peer accepts its owner again.
  const SimTime t = lan.session_now(1);
  EXPECT_NEAR(lan.peer(1).truth(world["B"], t).position.z(), b_before_m + 2.0 * 2.0, 0.1);
  EXPECT_EQ(lan.peer(0).owner(world["B"]), PeerId{2});
  EXPECT_LT((lan.peer(0).ghost(world["B"], t).position - lan.peer(1).truth(world["B"], t).position).norm(), 0.1);
}

// Motions that the world makes by itself may wait until all peers have joined.
TEST(PeerSession, MotionsBeginAtTheAnnouncedStart) {
  const World world(three_boxes());
  Lan lan(world);
  PeerConfig c = config(1, {{world["A"], false}});
  c.wait_for_start = true;
  lan.add(c);
  lan.add(config(2));
  lan.run_until(3s);
  EXPECT_EQ(lan.peer(0).truth(world["A"], lan.session_now(0)).position, Vec3::Zero());
  lan.peer(0).start_motions(lan.host_now(0), lan.session_now(0) + 1s);
  lan.run_until(3900ms);
  EXPECT_EQ(lan.peer(0).truth(world["A"], lan.session_now(0)).position, Vec3::Zero());
  lan.run_until(6s);
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_NEAR(lan.peer(i).ghost(world["A"], lan.session_now(i)).position.x(), 2.0, 1e-6) << i;
  }
}

// A computer that slept wakes up with hours to catch up on: it must do so in bounded work and be in step soon after.
TEST(PeerSession, LongSuspensionsAreSurvived) {
  const World world(corridor("velocityVector 2 0 0 collisionResponse CollisionResponse { }"));
  Lan lan(world);
  lan.add(config(1, {{world["BALL"], false}}));
  lan.add(config(2), 3s);
  lan.run_until(5s);
  for (const Duration sleep : {Duration(1min), Duration(10min), Duration(24h * 3)}) {
    lan.skip(sleep);
    lan.run_until(lan.now() + 5s);
    EXPECT_LE(spread(lan), 11ms);
    EXPECT_EQ(lan.peer(1).owner(world["BALL"]), PeerId{1});
    const SimTime t = lan.session_now(0);
    EXPECT_LT((lan.peer(1).ghost(world["BALL"], t).position - lan.peer(0).truth(world["BALL"], t).position).norm(),
              0.5);
  }
  EXPECT_GT(lan.peer(0).counters().ticks_missed, 60u * 60u);
}

}  // namespace peerd::replication::peer_session_test
