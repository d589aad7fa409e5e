#include "replication/peer/peer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/messages.hpp"

// These tests check what a peer does with datagrams, and how its objects look to others. Sessions and collisions have
// files of their own.
namespace peerd::replication::peer_test {

using namespace test;
using testing::IsEmpty;

// ---- hostile and mistaken datagrams ----

class InSession : public testing::Test {
 protected:
  InSession() {
    self = lan.add(config(5, {{world["O0"], true}}));
    lan.run_until(2s);
    lan.inject(self, encode(hello_of(7, lan.host_now(self), {world["O1"], world["O2"]})));
  }
  Message update(std::uint32_t sequence, Duration ago, double x, const char* object = "O1") {
    Message m = message_of(7);
    m.updates = {{world[object], sequence, lan.session_now(self) - ago, moving({x, 0, 0}), {}}};
    return m;
  }
  std::expected<void, Drop> receive(const Message& m) { return lan.inject(self, encode(m)); }
  double ghost_x(const char* object = "O1") {
    return lan.peer(self).ghost(world[object], lan.session_now(self)).position.x();
  }

  World world{field(4)};
  Lan lan{world};
  std::size_t self = 0;
};

TEST_F(InSession, AnUpdateMovesTheGhost) {
  EXPECT_EQ(ghost_x(), 3.0);
  EXPECT_TRUE(receive(update(1, 10ms, 8.0)).has_value());
  EXPECT_EQ(ghost_x(), 8.0);
  EXPECT_EQ(lan.peer(self).counters().updates_in, 1u);
}

TEST_F(InSession, SequenceCountsNotArrival) {
  receive(update(3, 10ms, 8.0));
  receive(update(2, 5ms, 9.0));  // overtaken on the way, though it says a later time
  receive(update(3, 1ms, 10.0));
  EXPECT_EQ(ghost_x(), 8.0);
  EXPECT_EQ(lan.drops(self, "old_sequence"), 1u);
  EXPECT_EQ(lan.peer(self).counters().updates_duplicate, 1u);
  receive(update(4, 20ms, 11.0));
  EXPECT_EQ(ghost_x(), 11.0);
}

TEST_F(InSession, EachObjectHasItsOwnSequence) {
  receive(update(9, 10ms, 8.0));
  receive(update(1, 10ms, 9.0, "O2"));
  EXPECT_EQ(ghost_x("O2"), 9.0);
}

TEST_F(InSession, TheLastSequenceIsTheEnd) {
  receive(update(0xFFFF'FFFF, 10ms, 8.0));
  EXPECT_EQ(ghost_x(), 8.0);
  receive(update(1, 5ms, 9.0));
  EXPECT_EQ(ghost_x(), 8.0);
}

TEST_F(InSession, TimesFromAnotherAgeAreDropped) {
  for (const Duration ago : {4100ms, 3'600'000ms, -1100ms, -3'600'000ms}) receive(update(1, ago, 8.0));
  EXPECT_EQ(ghost_x(), 3.0);
  EXPECT_EQ(lan.drops(self, "update_time"), 4u);
  Message m = update(1, 0s, 8.0);
  for (const SimTime t : {SimTime{Duration{std::int64_t{1} << 62}}, SimTime{Duration{-(std::int64_t{1} << 62)}}}) {
    m.updates[0].at = t;
    receive(m);
  }
  EXPECT_EQ(lan.drops(self, "update_time"), 6u);
  receive(update(1, 3900ms, 8.0));
  EXPECT_EQ(ghost_x(), 8.0);
}

TEST_F(InSession, OnlyTheOwnerMovesAnObject) {
  receive(update(1, 0s, 8.0, "O0"));  // ours
  EXPECT_EQ(ghost_x("O0"), 0.0);
  EXPECT_EQ(lan.drops(self, "not_owner"), 1u);
}

TEST_F(InSession, TheTruthOfARemoteObjectIsItsOwnersUpdate) {
  receive(update(1, 10ms, 8.0));
  EXPECT_EQ(lan.peer(self).truth(world["O1"], lan.session_now(self)).position.x(), 8.0);
  EXPECT_EQ(lan.peer(self).truth(world["O3"], lan.session_now(self)).position.x(), 9.0) << "where the file has it";
}

// The hello that introduces the object's owner may have been lost.
TEST_F(InSession, AnUpdateOfAnUnownedObjectClaimsIt) {
  receive(update(1, 0s, 8.0, "O3"));
  EXPECT_EQ(lan.peer(self).owner(world["O3"]), PeerId{7});
  EXPECT_EQ(ghost_x("O3"), 8.0);
}

TEST_F(InSession, ClaimsOfObjectsThatAreNotThereAreDropped) {
  receive(hello_of(8, lan.host_now(self), {ObjectId{1'000'000}, ObjectId{0xFFFF'FFFF}}));
  EXPECT_EQ(lan.drops(self, "object"), 2u);
  EXPECT_EQ(lan.peer(self).owners().size(), 3u);
}

TEST_F(InSession, DatagramsOfAnEarlierIncarnationAreDropped) {
  Message old = update(5, 0s, 8.0);
  old.incarnation = 99;
  EXPECT_EQ(receive(old).error(), Drop::kStaleIncarnation);
  EXPECT_EQ(receive(hello_of(7, lan.host_now(self), {world["O3"]}, 99)).error(), Drop::kStaleIncarnation);
  EXPECT_EQ(ghost_x(), 3.0);
  EXPECT_EQ(lan.peer(self).owner(world["O3"]), PeerId{0});
}

TEST_F(InSession, ALaterIncarnationRestartsItsSequences) {
  receive(update(50, 10ms, 8.0));
  EXPECT_TRUE(receive(hello_of(7, lan.host_now(self), {world["O1"]}, 101)).has_value());
  const auto joined = lan.seen<PeerJoined>(self);
  ASSERT_EQ(joined.size(), 2u);
  EXPECT_FALSE(joined[0].restarted);
  EXPECT_TRUE(joined[1].restarted);
  Message m = update(1, 5ms, 9.0);
  m.incarnation = 101;
  receive(m);
  EXPECT_EQ(ghost_x(), 9.0);
}

TEST_F(InSession, OwnDatagramsAreIgnored) {
  Message m = hello_of(5, lan.host_now(self), {world["O3"]});
  EXPECT_EQ(receive(m).error(), Drop::kOwn);
  EXPECT_EQ(lan.peer(self).owner(world["O3"]), PeerId{0});
  EXPECT_TRUE(lan.seen<IdInUse>(self).empty());
}

TEST_F(InSession, ItsOwnIdFromAnotherIncarnationIsReported) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(receive(hello_of(5, lan.host_now(self), {world["O3"]}, 101)).error(), Drop::kIdInUse);
    lan.run_until(lan.now() + 60ms);
  }
  ASSERT_EQ(lan.seen<IdInUse>(self).size(), 1u);
  EXPECT_TRUE(lan.seen<IdInUse>(self)[0].ours_is_replaced);
  EXPECT_EQ(lan.peer(self).owner(world["O3"]), PeerId{0});
}

TEST_F(InSession, TwoPeersOfOneNameAreNamed) {
  Message m = hello_of(8, lan.host_now(self), {});
  m.hello->introduction->name = "twin";
  EXPECT_TRUE(receive(m));
  EXPECT_TRUE(lan.seen<NameInUse>(self).empty());
  m = hello_of(9, lan.host_now(self), {});
  m.hello->introduction->name = "twin";
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(receive(m));
  const auto named = lan.seen<NameInUse>(self);
  ASSERT_EQ(named.size(), 1u) << "once";
  EXPECT_EQ(named[0].peer, PeerId{9});
  EXPECT_EQ(named[0].other, PeerId{8});
}

TEST_F(InSession, AnotherWorldIsNamedOnceAndIgnored) {
  for (int i = 0; i < 3; ++i) {
    Message m = hello_of(8, lan.host_now(self), {world["O3"]});
    m.hello->introduction->world_hash = 1;
    EXPECT_EQ(receive(m).error(), Drop::kOtherWorld);
  }
  ASSERT_EQ(lan.seen<OtherWorld>(self).size(), 1u);
  EXPECT_EQ(lan.seen<OtherWorld>(self)[0].peer, PeerId{8});
  EXPECT_EQ(lan.peer(self).owner(world["O3"]), PeerId{0});
  EXPECT_EQ(lan.peer(self).members().all().size(), 1u);
}

// Ids count within a world: the same id in another world harms nobody.
TEST_F(InSession, ItsOwnIdInAnotherWorldIsNamedAsThat) {
  Message m = hello_of(5, lan.host_now(self), {}, 101);
  m.hello->introduction->world_hash = 1;
  EXPECT_EQ(receive(m).error(), Drop::kOtherWorld);
  m.hello->introduction.reset();
  EXPECT_EQ(receive(m).error(), Drop::kIdInUse);
  EXPECT_TRUE(lan.seen<IdInUse>(self).empty());
  EXPECT_EQ(lan.seen<OtherWorld>(self).size(), 1u);
}

TEST_F(InSession, AnotherVersionIsNamedOnce) {
  Bytes other = encode(hello_of(8, lan.host_now(self)));
  ASSERT_EQ(other[1], std::byte{kProtocolVersion});
  for (const std::uint32_t version : {kProtocolVersion + 1, kProtocolVersion + 1, kProtocolVersion + 2, 0u}) {
    other[1] = static_cast<std::byte>(version);
    EXPECT_EQ(lan.inject(self, other).error(), Drop::kUndecodable);
  }
  const auto reported = lan.seen<OtherVersion>(self);
  ASSERT_EQ(reported.size(), 2u);
  EXPECT_EQ(reported[0].peer, PeerId{8});
  EXPECT_EQ(reported[0].version, kProtocolVersion + 1);
}

TEST_F(InSession, AnUnknownPeerMustIntroduceItselfFirst) {
  Message m = update(1, 0s, 8.0);
  m.sender = PeerId{8};
  EXPECT_EQ(receive(m).error(), Drop::kUnintroduced);
  EXPECT_EQ(lan.peer(self).members().all().size(), 1u);
  m.sender = PeerId{9};
  m.leaving = true;
  EXPECT_EQ(receive(m).error(), Drop::kUnintroduced);
  EXPECT_TRUE(lan.seen<PeerLost>(self).empty());
}

TEST_F(InSession, GarbageChangesNothing) {
  receive(update(1, 10ms, 8.0));
  const std::string before = fingerprint(lan, self);
  std::mt19937_64 rng(1);
  MessageMaker make(1);
  std::uint64_t refused = 0;
  for (int i = 0; i < 3000; ++i) {
    Bytes bytes = encode(make.message(1, i % 2, i % 3 == 0));
    switch (i % 3) {
      case 0:
        bytes.assign(rng() % 200, std::byte{0});
        break;
      case 1:
        bytes.resize(rng() % bytes.size());
        break;
      case 2:
        bytes.insert(bytes.begin() + static_cast<long>(rng() % 4), static_cast<std::byte>(rng()));
        break;
    }
    if (decode(bytes, lan.session_now(self)).has_value()) continue;
    ++refused;
    EXPECT_EQ(lan.inject(self, bytes).error(), Drop::kUndecodable);
  }
  EXPECT_GT(refused, 2000u);
  EXPECT_EQ(lan.drops(self, "undecodable"), refused);
  EXPECT_GT(lan.drops(self, "undecodable_not_a_datagram"), 0u);
  EXPECT_EQ(fingerprint(lan, self), before);
}

// Sound messages of unknown peers, whatever they say, move no object that a known peer runs.
TEST_F(InSession, ValidDatagramsOfUnknownPeersChangeNothing) {
  receive(update(1, 10ms, 8.0));
  MessageMaker make(2);
  for (int i = 0; i < 2000; ++i) {
    Message m = make.message(2, 1, i % 2 == 0);
    if (m.sender == PeerId{7} || m.sender == PeerId{5}) continue;
    receive(m);
  }
  EXPECT_EQ(ghost_x(), 8.0);
  EXPECT_EQ(lan.peer(self).owners().size(), 3u);
  lan.run_until(lan.now() + 1s);
  EXPECT_EQ(ghost_x(), 8.0);
}

TEST_F(InSession, TheLowerIdKeepsAnObjectThatTwoClaim) {
  receive(hello_of(9, lan.host_now(self), {world["O1"]}));
  EXPECT_EQ(lan.peer(self).owner(world["O1"]), PeerId{7});
  receive(hello_of(6, lan.host_now(self), {world["O1"]}));
  EXPECT_EQ(lan.peer(self).owner(world["O1"]), PeerId{6});
  receive(hello_of(7, lan.host_now(self), {world["O1"]}));
  EXPECT_EQ(lan.peer(self).owner(world["O1"]), PeerId{6});
  const auto conflicts = lan.seen<OwnershipConflict>(self);
  ASSERT_EQ(conflicts.size(), 1u);
  EXPECT_EQ(conflicts[0].owner, PeerId{6});
}

TEST_F(InSession, AnObjectLostToALowerIdIsNotPublishedAnyMore) {
  receive(hello_of(6, lan.host_now(self), {world["O0"]}));
  EXPECT_TRUE(lan.seen<OwnershipConflict>(self).empty());
  receive(hello_of(4, lan.host_now(self), {world["O0"]}));
  EXPECT_EQ(lan.seen<OwnershipConflict>(self).size(), 1u);
  lan.node(self).outputs.clear();
  lan.run_until(lan.now() + 1s);
  EXPECT_THAT(lan.seen<Published>(self), IsEmpty());
}

// A message for the whole scene is not accepted from one region, because the numbers there count by themselves.
TEST_F(InSession, HellosAreForTheWholeScene) {
  Message m = hello_of(7, lan.host_now(self));
  m.number = 1'000'000;
  EXPECT_EQ(lan.peer(self).on_packet(lan.host_now(self), RegionId{1}, encode(m)).error(), Drop::kRegion);
  m.hello.reset();
  m.leaving = true;
  EXPECT_EQ(lan.peer(self).on_packet(lan.host_now(self), RegionId{1}, encode(m)).error(), Drop::kRegion);
  lan.run_until(lan.now() + 1s);  // its hellos go on
  EXPECT_EQ(lan.peer(self).members().all().size(), 1u);
}

TEST_F(InSession, AModelUnknownToThisBuildIsCountedAndTheRestOfItsDatagramCounts) {
  EXPECT_TRUE(lan.inject(self, with_records(update(1, 10ms, 8, "O2"), {0x08, 3, 1, 2, 3}, {})));
  EXPECT_EQ(lan.drops(self, "unknown_model"), 1u);
  EXPECT_EQ(ghost_x("O2"), 8);
}

TEST(Peer, UpdatesBeforeThereIsASessionAreDropped) {
  const World world(field(2));
  Lan lan(world);
  lan.add(config(5));
  lan.run_until(100ms);
  lan.inject(0, encode(hello_of(7, lan.host_now(0), {world["O1"]})));
  Message m = message_of(7);
  m.updates = {{world["O1"], 1, sim(kEpoch), moving({8, 0, 0}), {}}};
  EXPECT_EQ(lan.inject(0, encode(m)).error(), Drop::kNotYetInSession);
}

TEST(DropName, IsDistinctForEach) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(Drop::kNotYetInSession); ++i) names.insert(to_string(static_cast<Drop>(i)));
  EXPECT_EQ(names.size(), 8u);
  EXPECT_FALSE(names.contains("?"));
}

// ---- dead reckoning ----

struct Network {
  const char* name;
  Link link;
  ModelOrder order;
};
class DeadReckoning : public testing::TestWithParam<Network> {};

// However badly datagrams travel, once all have arrived all peers predict the same, bit for bit. That includes the
// sender's own copy, and holds for any tick rates.
TEST_P(DeadReckoning, AllHoldTheSameGhost) {
  const World world(field(1));
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    Lan lan(world, GetParam().link, seed);
    const std::uint32_t hz[] = {60, 144, 30};
    for (std::uint32_t i = 0; i < 3; ++i) {
      PeerConfig c = config(i + 1, i == 0 ? std::vector<OwnedObject>{{world["O0"], true}} : std::vector<OwnedObject>{});
      c.tick_hz = hz[i];
      c.policy.order = GetParam().order;
      lan.add(c, i * 3s,
              i == 0 ? std::map<ObjectId, Lan::Motion>{{world["O0"], on_a_circle}} : std::map<ObjectId, Lan::Motion>{});
    }
    lan.run_until(10s);
    ASSERT_TRUE(lan.all_in_session());
    // The last update has reached all peers by the end of each quiet spell.
    int compared = 0;
    for (Duration t = 10s; t < 20s; t += 5ms) {
      lan.run_until(t);
      const auto& published = lan.seen<Published>(0);
      ASSERT_FALSE(published.empty());
      const Duration quiet = lan.session_now(0) - published.back().at;
      if (quiet < GetParam().link.latency + GetParam().link.jitter + 40ms) continue;
      const SimTime at = lan.session_now(0);
      for (std::size_t i = 1; i < 3; ++i) {
        ASSERT_TRUE(same_bits(lan.peer(i).ghost(world["O0"], at), lan.peer(0).ghost(world["O0"], at))) << i;
      }
      ++compared;
    }
    EXPECT_GT(compared, 20);
  }
}
INSTANTIATE_TEST_SUITE_P(Table, DeadReckoning,
                         testing::Values(Network{"FirstOrder", {5ms, 0ms, 0, 0}, ModelOrder::kFirst},
                                         Network{"Near", {5ms, 0ms, 0, 0}, ModelOrder::kSecond},
                                         Network{"Far", {200ms, 0ms, 0, 0}, ModelOrder::kSecond},
                                         Network{"Reordered", {20ms, 150ms, 0, 0}, ModelOrder::kSecond},
                                         Network{"Duplicated", {5ms, 50ms, 0, 0.5}, ModelOrder::kSecond}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST(Peer, TheOwnersGhostStaysWithinTheThreshold) {
  const World world(field(1));
  for (const double threshold : {0.05, 0.5}) {
    for (const ModelOrder order : {ModelOrder::kFirst, ModelOrder::kSecond}) {
      Lan lan(world);
      PeerConfig c = config(1, {{world["O0"], true}});
      c.policy.error_threshold_m = threshold;
      c.policy.order = order;
      lan.add(c, 0s, {{world["O0"], on_a_circle}});
      lan.run_until(3s);
      for (Duration t = 3s; t < 10s; t += Duration(1s) / 60) {
        lan.run_until(t);
        const SimTime at = lan.session_now(0);
        // A tick of motion may pass before the next check.
        ASSERT_LE((lan.peer(0).ghost(world["O0"], at).position - on_a_circle(at).position).norm(),
                  threshold + 5.0 / 60);
      }
      for (const Published& p : lan.seen<Published>(0)) EXPECT_EQ(p.threshold_m, threshold);
      EXPECT_GT(lan.peer(0).counters().updates_out, 5u);
      EXPECT_LT(lan.peer(0).counters().updates_out, 200u);
    }
  }
}

TEST(Peer, AStandingObjectCostsAnUpdateEachTimeThreshold) {
  const World world(field(1));
  Lan lan(world);
  PeerConfig c = config(1, {{world["O0"], false}});
  c.policy.time_threshold = 2s;
  c.policy.resting_time_threshold = 0s;
  lan.add(c);
  lan.run_until(12s);
  const auto published = lan.seen<Published>(0);
  ASSERT_EQ(published.size(), 6u);
  EXPECT_EQ(published[0].reason, PublishReason::kFirst);
  for (std::size_t i = 1; i < published.size(); ++i) {
    EXPECT_EQ(published[i].reason, PublishReason::kTime);
    EXPECT_NEAR(to_seconds(published[i].at - published[i - 1].at), 2.0, 1.1 / 60);
  }
}

TEST(Peer, EachObjectsOwnThresholdCountsUnlessThePolicySaysOtherwise) {
  const World world(box("O0", "1 1 1", "0 0 0", "distanceThreshold 0.125"));
  Lan lan(world);
  lan.add(config(1, {{world["O0"], true}}), 0s, {{world["O0"], on_a_circle}});
  lan.run_until(3s);
  for (const Published& p : lan.seen<Published>(0)) EXPECT_EQ(p.threshold_m, 0.125);
}

TEST(Peer, TicksLieOnTheSessionsGrid) {
  const World world(field(1));
  for (const std::uint32_t hz : {30u, 60u, 144u}) {
    Lan lan(world);
    PeerConfig c = config(1, {{world["O0"], true}});
    c.tick_hz = hz;
    lan.add(c, 1234567ns, {{world["O0"], on_a_circle}});
    lan.run_until(5s);
    const auto& counters = lan.peer(0).counters();
    EXPECT_NEAR(static_cast<double>(counters.ticks), 4.0 * hz, 2.0);
    EXPECT_EQ(counters.ticks_missed, 0u);
    EXPECT_LE(lan.node(0).ticks, 4 * hz + 60) << "a driver must not be called more often than there is something to do";
    for (const Published& p : lan.seen<Published>(0)) {
      const double number = to_seconds(p.at.time_since_epoch() % 1s) * hz;
      EXPECT_NEAR(number, std::round(number), 1e-6);
    }
  }
}

TEST(Peer, CallingEarlyIsHarmless) {
  const World world(field(1));
  std::string expected;
  for (const bool often : {false, true}) {
    Lan lan(world);
    lan.add(config(1, {{world["O0"], true}}), 0s, {{world["O0"], on_a_circle}});
    for (Duration t = 0s; t < 4s; t += 1ms) {
      lan.run_until(t);
      if (often) lan.tick(0);
    }
    if (!often) expected = fingerprint(lan, 0);
    EXPECT_EQ(fingerprint(lan, 0), expected);
    EXPECT_NEAR(static_cast<double>(lan.peer(0).counters().ticks), 180, 2);
  }
}

// ---- driving ----

TEST(Driving, BeginsWhereTheObjectIsNowAndNotWhereItWasAtTheLastTick) {
  const World world(box("O0", "1 1 1", "0 0 0", "velocityVector 3 0 0") + box("O1", "1 1 1", "0 9 0"));
  Lan lan(world);
  lan.add(config(1, {{world["O0"], false}}));
  lan.run_until(3s);
  for (const Duration later : {1ms, 3ms, 7ms}) {
    lan.skip(later);
    Peer& peer = lan.peer(0);
    const SimTime now = lan.session_now(0);
    const Vec3 here = peer.truth(world["O0"], now).position;
    ASSERT_GT(here.x(), 1.0);
    ASSERT_TRUE(peer.begin_driving(lan.host_now(0), world["O0"]));
    EXPECT_EQ(peer.truth(world["O0"], now).velocity, Vec3(0, 0, 0));
    EXPECT_LT((peer.truth(world["O0"], now).position - here).norm(), 1e-9) << later.count();
    peer.end_driving(lan.host_now(0), world["O0"], moving(here, {3, 0, 0}));
    lan.run_until(4s + 100 * later);
  }
}

}  // namespace peerd::replication::peer_test
