#include "replication/peer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "tests/replication/lan.hpp"
#include "tests/replication/messages.hpp"

// What a peer does with datagrams, and how its objects look elsewhere. Sessions and collisions have files of their own.
namespace peerd::replication {
namespace {

using namespace test;
using testing::IsEmpty;

std::string field(int objects) {
  std::string text;
  for (int i = 0; i < objects; ++i) text += box("O" + std::to_string(i), "1 1 1", std::to_string(3 * i) + " 0 0");
  return text;
}

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

// The hello that says who runs it may have been lost.
TEST_F(InSession, AnUpdateOfWhatNobodyRunsClaimsIt) {
  receive(update(1, 0s, 8.0, "O3"));
  EXPECT_EQ(lan.peer(self).owner(world["O3"]), PeerId{7});
  EXPECT_EQ(ghost_x("O3"), 8.0);
}

TEST_F(InSession, ClaimsOfObjectsThatAreNotThereAreDropped) {
  receive(hello_of(8, lan.host_now(self), {ObjectId{1'000'000}, ObjectId{0xFFFF'FFFF}}));
  EXPECT_EQ(lan.drops(self, "object"), 2u);
  EXPECT_EQ(lan.peer(self).owners().size(), 3u);
}

TEST_F(InSession, AnEarlierLifeIsDropped) {
  Message old = update(5, 0s, 8.0);
  old.boot = 99;
  EXPECT_EQ(receive(old).error(), Drop::kStaleBoot);
  EXPECT_EQ(receive(hello_of(7, lan.host_now(self), {world["O3"]}, 99)).error(), Drop::kStaleBoot);
  EXPECT_EQ(ghost_x(), 3.0);
  EXPECT_EQ(lan.peer(self).owner(world["O3"]), PeerId{0});
}

TEST_F(InSession, ALaterLifeBeginsItsSequencesAnew) {
  receive(update(50, 10ms, 8.0));
  EXPECT_TRUE(receive(hello_of(7, lan.host_now(self), {world["O1"]}, 101)).has_value());
  const auto joined = lan.seen<PeerJoined>(self);
  ASSERT_EQ(joined.size(), 2u);
  EXPECT_FALSE(joined[0].restarted);
  EXPECT_TRUE(joined[1].restarted);
  Message m = update(1, 5ms, 9.0);
  m.boot = 101;
  receive(m);
  EXPECT_EQ(ghost_x(), 9.0);
}

TEST_F(InSession, ItsOwnDatagramsAreNoNews) {
  Message m = hello_of(5, lan.host_now(self), {world["O3"]});
  EXPECT_EQ(receive(m).error(), Drop::kOwn);
  EXPECT_EQ(lan.peer(self).owner(world["O3"]), PeerId{0});
  EXPECT_TRUE(lan.seen<IdInUse>(self).empty());
}

TEST_F(InSession, ItsOwnIdFromAnotherLifeIsReported) {
  EXPECT_EQ(receive(hello_of(5, lan.host_now(self), {world["O3"]}, 101)).error(), Drop::kIdInUse);
  ASSERT_EQ(lan.seen<IdInUse>(self).size(), 1u);
  EXPECT_EQ(lan.peer(self).owner(world["O3"]), PeerId{0});
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

TEST_F(InSession, AStrangerMustSayHelloFirst) {
  Message m = update(1, 0s, 8.0);
  m.sender = PeerId{8};
  EXPECT_EQ(receive(m).error(), Drop::kStranger);
  EXPECT_EQ(lan.peer(self).members().all().size(), 1u);
  m.sender = PeerId{9};
  m.leaving = true;
  EXPECT_EQ(receive(m).error(), Drop::kStranger);
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

// Sound messages of peers that nobody knows, whatever they say, move nothing that somebody runs.
TEST_F(InSession, SoundNoiseOfStrangersMovesNothing) {
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

// A smooth curve of session time.
KinematicState on_a_circle(SimTime t) {
  const double phase = to_seconds(t.time_since_epoch() - kEpoch);
  const double s = std::sin(phase), c = std::cos(phase);
  return moving({5 * c, 5 * s, 0}, {-5 * s, 5 * c, 0}, {-5 * c, -5 * s, 0});
}

struct Network {
  const char* name;
  Link link;
  ModelOrder order;
};
class DeadReckoning : public testing::TestWithParam<Network> {};

// However badly datagrams travel, once all have arrived everybody believes the same, bit for bit: the sender's own copy
// included, and whatever their tick rates.
TEST_P(DeadReckoning, AllHoldTheSameGhost) {
  const World world(field(1));
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    Lan lan(world, GetParam().link, seed);
    const std::uint32_t hz[] = {60, 144, 30};
    for (std::uint32_t i = 0; i < 3; ++i) {
      PeerConfig c = config(i + 1, i == 0 ? std::vector<Enslaved>{{world["O0"], true}} : std::vector<Enslaved>{});
      c.tick_hz = hz[i];
      c.policy.order = GetParam().order;
      lan.add(c, i * 3s,
              i == 0 ? std::map<ObjectId, Lan::Motion>{{world["O0"], on_a_circle}} : std::map<ObjectId, Lan::Motion>{});
    }
    lan.run_until(10s);
    ASSERT_TRUE(lan.all_in_session());
    // From the end of each quiet spell the last update has reached everybody.
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

// ---- sizes ----

TEST(Peer, TheLargestDatagramsFitAndEverythingGetsItsTurn) {
  const World world(field(260));
  Lan lan(world);
  PeerConfig c = config(0xFFFF'FFFE, {});
  c.name.assign(kNameMax_bytes, 'n');
  c.boot = ~std::uint64_t{0};
  c.world_hash = 0xC0FFEE;
  KinematicState full = moving({1.1, 2.2, 3.3}, {4.4, 5.5, 6.6}, {7.7, 8.8, 9.9});
  full.orientation = Quat(0.1, 0.2, 0.3, 0.4).normalized();
  full.angular_velocity_body = {1.1, 2.2, 3.3};
  std::map<ObjectId, Lan::Motion> motions;
  for (int i = 0; i < 260; ++i) {
    const ObjectId id = world[("O" + std::to_string(i)).c_str()];
    c.enslaved.push_back({id, true});
    motions[id] = [=](SimTime) { return full; };
  }
  lan.add(c, 0s, motions);
  lan.run_until(2s);
  lan.peer(0).announce_start(lan.session_now(0));
  std::set<std::uint32_t> echoed;
  std::set<ObjectId> claimed;
  std::size_t largest = 0;
  lan.filter = [&](std::size_t, std::size_t, const Message& m) {  // Lan checks each one's size and that it decodes
    if (m.hello) {
      for (const Echo& e : m.hello->echoes) echoed.insert(e.peer.value);
    }
    if (const Introduction* i = m.introduction()) claimed.insert(i->enslaved.begin(), i->enslaved.end());
    largest = std::max(largest, encode(m).size());
    return true;
  };
  for (int round = 0; round < 12; ++round) {
    for (std::uint32_t id = 0; id < 40; ++id) lan.inject(0, encode(hello_of(0xFFFF'FF00 + id, lan.host_now(0))));
    lan.run_until(lan.now() + 250ms);
  }
  EXPECT_EQ(echoed.size(), 40u);
  EXPECT_EQ(claimed.size(), 260u);
  EXPECT_GT(largest, 1000u);
  EXPECT_LE(largest, kDatagramMax_bytes);
}

TEST(Peer, ManyUpdatesShareFewDatagrams) {
  const World world(field(50));
  Lan lan(world);
  PeerConfig c = config(1);
  for (int i = 0; i < 50; ++i) c.enslaved.push_back({world[("O" + std::to_string(i)).c_str()], false});
  lan.add(c);
  std::size_t datagrams = 0, updates = 0;
  lan.filter = [&](std::size_t, std::size_t, const Message& m) {
    datagrams += !m.updates.empty();
    updates += m.updates.size();
    return true;
  };
  lan.run_until(3500ms);
  EXPECT_EQ(updates, 50u);  // nobody is here who could have missed one
  EXPECT_LE(datagrams, 6u);
}

// Of an update that everybody has nothing is said again until the time threshold; of one that somebody may lack it is.
TEST(Peer, WhatHasArrivedIsNotRepeated) {
  for (const bool lose : {false, true}) {
    const World world(box("O0", "1 1 1", "0 0 0"));
    Lan lan(world, {20ms, 0ms, 0, 0});
    lan.add(config(1, {{world["O0"], false}}));
    lan.add(config(2));
    lan.add(config(3));
    lan.run_until(20s);  // long enough for all to know that nothing gets lost
    const std::uint64_t before = lan.peer(0).counters().updates_repeated;
    int updates = 0;
    lan.filter = [&](std::size_t from, std::size_t to, const Message& m) {
      return from != 0 || m.updates.empty() || to != 2 || !lose || ++updates > 1;
    };
    ASSERT_TRUE(lan.peer(0).change_velocity(lan.host_now(0), world["O0"], Vec3(1, 0, 0), true));
    lan.run_until(23s);
    EXPECT_EQ(lan.peer(0).counters().updates_repeated - before, lose ? 1u : 0u);
    const SimTime t = lan.session_now(0);
    EXPECT_EQ(lan.peer(2).ghost(world["O0"], t).velocity.x(), 1.0);
  }
}

// A link that is dead one way for longer than a peer is waited for: who was forgotten says where everything is.
TEST(Peer, WhoWasForgottenTellsItsStatesAnew) {
  const World world(box("O0", "1 1 1", "0 0 0", "velocityVector 4 0 0"));
  for (const Duration dead : {1800ms, 1900ms, 2000ms, 2100ms, 2200ms, 2300ms}) {
    SCOPED_TRACE(dead.count());
    Lan lan(world, {20ms, 0ms, 0, 0});
    PeerConfig c = config(1, {{world["O0"], false}});
    c.policy.time_threshold = 60s;
    lan.add(c);
    lan.add(config(2));
    lan.run_until(6s);
    lan.filter = [&](std::size_t from, std::size_t to, const Message&) { return from != 0 || to != 1; };
    lan.run_until(6s + dead);
    lan.filter = nullptr;
    lan.run_until(9500ms);
    const SimTime t = lan.session_now(1);
    EXPECT_LT((lan.peer(1).ghost(world["O0"], t).position - lan.peer(0).truth(world["O0"], t).position).norm(), 1e-6);
  }
}

// What concerns everybody is not taken from one region: numbers there count by themselves.
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

// Once all know each other, a hello goes out each second, and who they are with one in eight; a newcomer hears it with
// the next, which does not wait.
TEST(Peer, IntroducesItselfToWhoDoesNotKnowIt) {
  const World world(box("O0", "1 1 1", "0 0 0"));
  Lan lan(world, {20ms, 0ms, 0, 0});
  lan.add(config(1, {{world["O0"], false}}));
  lan.add(config(2));
  lan.run_until(20s);
  int hellos = 0, introductions = 0, empty = 0;
  lan.filter = [&](std::size_t from, std::size_t to, const Message& m) {
    hellos += from == 0 && to == 1 && m.hello;
    introductions += from == 0 && to == 1 && m.introduction() != nullptr;
    empty += from == 0 && to == 1 && !m.hello && m.updates.empty();
    return true;
  };
  lan.run_until(36s);
  EXPECT_NEAR(hellos, 16, 1);
  EXPECT_EQ(introductions, 2);
  EXPECT_NEAR(empty, 3 * hellos, 3);
  const Duration came = lan.now();
  const std::size_t third = lan.add(config(3));
  while (lan.now() < came + 1s && lan.peer(third).members().all().size() < 2) lan.run_until(lan.now() + 10ms);
  EXPECT_LE(lan.now() - came, 250ms + 2 * 20ms + 20ms);
}

// O0 runs ahead of its ghost twice as fast as O1 does: when it is told, O1 is half as wrong as it may be.
TEST(Peer, WhatIsHalfWrongGoesAlongWithWhatIsWrong) {
  const World world(field(2));
  for (const double along_at : {1.0, 0.4}) {
    Lan lan(world);
    PeerConfig c = config(1, {{world["O0"], true}, {world["O1"], true}});
    c.policy.order = ModelOrder::kFirst;
    c.policy.error_threshold_m = 0.5;
    c.policy.along_at = along_at;
    const auto speeding = [](double a) {
      return [a](SimTime t) {
        const double s = to_seconds(t.time_since_epoch() - kEpoch);
        return moving({0.5 * a * s * s, 0, 0}, {a * s, 0, 0}, {a, 0, 0});
      };
    };
    lan.add(c, 0s, {{world["O0"], speeding(2.0)}, {world["O1"], speeding(1.0)}});
    lan.add(config(2));
    lan.run_until(5s);
    std::size_t alone = 0, together = 0;
    lan.filter = [&](std::size_t, std::size_t, const Message& m) {
      alone += m.updates.size() == 1;
      together += m.updates.size() == 2;
      return true;
    };
    lan.run_until(15s);
    EXPECT_EQ(along_at < 1.0, alone < together / 4) << alone << " alone, " << together << " together";
    EXPECT_GT(alone + together, 5u);
  }
}

// What stands, and all are known to have heard where, needs no heartbeat, whether datagrams get lost or not; what
// somebody has never heard of has one.
TEST(Peer, WhatIsKnownToRestIsSeldomToldAgain) {
  const World world(box("O0", "1 1 1", "0 0 0"));
  for (const bool heard : {true, false}) {
    for (const double loss : {0.0, 0.2}) {
      Lan lan(world, {20ms, 0ms, loss, 0});
      lan.add(config(1, {{world["O0"], false}}));
      lan.add(config(2));
      lan.filter = [&](std::size_t, std::size_t to, const Message& m) { return heard || to != 1 || m.updates.empty(); };
      lan.run_until(10s);
      const std::uint64_t told = lan.peer(0).counters().updates_out;
      lan.run_until(50s);
      EXPECT_EQ(lan.peer(0).counters().updates_out == told, heard) << loss;
      EXPECT_EQ(lan.peer(1).owner(world["O0"]), PeerId{1});
    }
  }
}

// The first words on a motion are lost, three times: it goes on being told, and not first by the heartbeat.
TEST(Peer, WhatSomebodyMayLackIsToldUntilItIsHeard) {
  const World world(box("O0", "1 1 1", "0 0 0"));
  for (const Duration latency : {20ms, 500ms}) {
    for (const double loss : {0.0, 0.2}) {
      SCOPED_TRACE(testing::Message() << latency.count() << " ns, loss " << loss);
      Lan lan(world, {latency, 0ms, loss, 0});
      PeerConfig c = config(1, {{world["O0"], false}});
      c.policy.time_threshold = 60s;
      lan.add(c);
      lan.add(config(2));
      lan.add(config(3));
      lan.run_until(20s);
      const int lost = loss > 0.0 ? 3 : 1;  // on a good link that is enough for a second one
      int words = 0;
      lan.filter = [&](std::size_t from, std::size_t to, const Message& m) {
        return from != 0 || to != 1 || m.updates.empty() || ++words > lost;
      };
      ASSERT_TRUE(lan.peer(0).change_velocity(lan.host_now(0), world["O0"], Vec3(1, 0, 0), true));
      lan.run_until(32s);
      const SimTime t = lan.session_now(0) - 1s;
      EXPECT_GT(words, lost);
      for (const std::size_t i : {1u, 2u}) {
        const Vec3 error = lan.peer(i).ghost(world["O0"], t).position - lan.peer(0).truth(world["O0"], t).position;
        EXPECT_LT(error.norm(), 1e-6) << i;
      }
      const std::uint64_t repeated = lan.peer(0).counters().updates_repeated;
      lan.run_until(45s);
      EXPECT_EQ(lan.peer(0).counters().updates_repeated, repeated) << "all have it";
    }
  }
}

TEST(Peer, ALostUpdateComesAgainWithTheNextHello) {
  const World world(box("O0", "1 1 1", "0 0 0", "velocityVector 3 0 0"));
  Lan lan(world, {20ms, 0ms, 0, 0});
  lan.add(config(1, {{world["O0"], false}}));
  lan.add(config(2));
  int lost = 0;
  lan.filter = [&](std::size_t, std::size_t to, const Message& m) {
    return to != 1 || m.updates.empty() || ++lost > 1;
  };
  lan.run_until(3s);
  const SimTime t = lan.session_now(1);
  EXPECT_GT(lost, 1);
  EXPECT_LT((lan.peer(1).ghost(world["O0"], t).position - lan.peer(0).truth(world["O0"], t).position).norm(), 1e-6);
}

// ---- models ----

PeerConfig choosing(std::uint32_t id, std::vector<Enslaved> enslaved = {}) {
  PeerConfig c = config(id, std::move(enslaved));
  c.policy.models.emplace();
  c.policy.wanted_error_m = 0.005;
  return c;
}

// Chosen models, too, are one belief on all peers, whatever their tick rates and however the network behaves.
TEST(Models, AreObeyedAlikeByAll) {
  const World world(field(1));
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Lan lan(world, {20ms, 100ms, 0, 0.3}, seed);
    const auto weaves = [](SimTime t) {
      const double s = to_seconds(t.time_since_epoch() - kEpoch);
      return moving({4 * std::sin(1.1 * s), s, 3 * std::sin(0.7 * s)},
                    {4.4 * std::cos(1.1 * s), 1, 2.1 * std::cos(0.7 * s)},
                    {-4.84 * std::sin(1.1 * s), 0, -1.47 * std::sin(0.7 * s)});
    };
    lan.add(choosing(1, {{world["O0"], true}}), 0s, {{world["O0"], weaves}});
    PeerConfig slow = choosing(2);
    slow.tick_hz = 30;
    lan.add(slow, 3s);
    lan.run_until(10s);
    const SimTime t = lan.session_now(0);
    EXPECT_TRUE(same_bits(lan.peer(1).ghost(world["O0"], t), lan.peer(0).ghost(world["O0"], t))) << seed;
    EXPECT_LT((lan.peer(1).ghost(world["O0"], t).position - weaves(t).position).norm(), 1e-3) << seed;
    EXPECT_LT(lan.peer(0).counters().updates_out, 12u) << "exact after few";
  }
}

// What physics moves travels to the bit; what is driven in steps as fine as the tightest threshold asks: a 16th of it.
TEST(Rounding, IsOfWhatIsDrivenAlone) {
  const World world(field(2));
  for (const auto& [threshold_m, step_log2] : {std::pair{0.5, -9}, {0.02, -10}, {0.002, -13}}) {
    Lan lan(world);
    PeerConfig c = config(1, {{world["O0"], true}, {world["O1"], false}});
    c.policy.error_threshold_m = threshold_m;
    lan.add(c, 0s, {{world["O0"], on_a_circle}});
    lan.add(config(2));
    std::set<std::optional<int>> driven, physics;
    lan.filter = [&](std::size_t, std::size_t, const Message& m) {
      for (const UpdateRecord& u : m.updates) {
        (u.object == world["O0"] ? driven : physics).insert(u.position_step_log2);
      }
      return true;
    };
    lan.run_until(3s);
    EXPECT_THAT(driven, testing::ElementsAre(std::optional(step_log2)));
    EXPECT_THAT(physics, testing::ElementsAre(std::optional<int>()));
    const Peer::Counters& counters = lan.peer(0).counters();
    EXPECT_EQ(std::reduce(counters.update_sizes_out.begin(), counters.update_sizes_out.end()), counters.updates_out);
    EXPECT_GT(counters.update_bytes_out, 10 * counters.updates_out);
  }
}

// What falls and what spins needs one update, for as long as it goes on: what that rounds is small even after 17 s.
TEST(Models, OfFallingAndSpinningNeedOneUpdate) {
  const World world(field(1));
  Lan lan(world);
  const auto falls = [](SimTime t) {
    KinematicState s = moving({0, 5'000, 0}, {3, 0, 0}, {0, -9.81, 0});
    s.angular_velocity_body = {0, 30, 0};
    return advance(s, to_seconds(t.time_since_epoch() - kEpoch));
  };
  PeerConfig c = choosing(1, {{world["O0"], true}});
  c.policy.time_threshold = 1000s;
  lan.add(c, 0s, {{world["O0"], falls}});
  lan.add(choosing(2));
  lan.run_until(3s);
  const std::uint64_t then = lan.peer(0).counters().updates_out;
  lan.run_until(20s);
  EXPECT_EQ(lan.peer(0).counters().updates_out, then);
  const SimTime t = lan.session_now(1);
  EXPECT_LT((lan.peer(1).ghost(world["O0"], t).position - falls(t).position).norm(), 1e-3);
  EXPECT_LT(angle_between(lan.peer(1).ghost(world["O0"], t).orientation, falls(t).orientation), 1e-3);
}

// A source without derivatives is believed as well as one with them, but for the first samples.
TEST(Models, AreFoundWithoutDerivativesToo) {
  const World world(field(1));
  PeerConfig c = choosing(1, {{world["O0"], true}});
  Peer peer(c, *world.model);
  const auto drain = [&] {
    while (peer.poll_output()) {
    }
  };
  for (int i = 0; i < 400; ++i) {
    const HostTime now = host(kEpoch + i * 16ms);
    std::vector<OwnSample> samples;
    if (const auto due = peer.due_tick(now)) {
      samples.push_back({world["O0"], at_rest(on_a_circle(*due).pose()), false});
    }
    peer.on_tick(now, samples);
    drain();
  }
  const SimTime t = peer.clock().to_session(host(kEpoch + 399 * 16ms));
  EXPECT_LT((peer.ghost(world["O0"], t).position - on_a_circle(t).position).norm(), 0.05);
  EXPECT_LT((peer.truth(world["O0"], t).velocity - on_a_circle(t).velocity).norm(), 0.3);
  EXPECT_LT(peer.counters().updates_out, 30u);
}

TEST_F(InSession, AModelUnknownToThisBuildIsCountedAndTheRestOfItsDatagramCounts) {
  EXPECT_TRUE(lan.inject(self, with_records(update(1, 10ms, 8, "O2"), {0x08, 3, 1, 2, 3}, {})));
  EXPECT_EQ(lan.drops(self, "unknown_model"), 1u);
  EXPECT_EQ(ghost_x("O2"), 8);
}

TEST(Models, AreChosenForTheLatencyThatHellosMeasure) {
  const World world(field(1));
  for (const Duration latency : {5ms, 80ms, 300ms}) {
    Lan lan(world, {latency, 0ms, 0, 0});
    lan.add(choosing(1, {{world["O0"], true}}), 0s, {{world["O0"], on_a_circle}});
    lan.add(choosing(2), 7s);  // its clock is another
    lan.run_until(6s);
    const Member& other = lan.peer(0).members().all().at(PeerId{2});
    ASSERT_TRUE(other.mean_delay());
    EXPECT_NEAR(to_seconds(*other.mean_delay()), to_seconds(latency), 1e-3);
  }
}

// A healed partition puts one of them into another time: what it chose by is void, what it believes goes on.
TEST(Models, SurviveAChangeOfSession) {
  const World world(field(1));
  Lan lan(world);
  lan.add(choosing(1));
  lan.add(choosing(2, {{world["O0"], true}}), -30s, {{world["O0"], on_a_circle}});
  lan.part({0});
  lan.run_until(5s);
  lan.part({});
  lan.run_until(12s);
  ASSERT_FALSE(lan.seen<ClockStepped>(1).empty());
  EXPECT_TRUE(lan.seen<ClockStepped>(0).empty());
  const SimTime t = lan.session_now(0);
  EXPECT_LT((lan.peer(0).ghost(world["O0"], t).position - on_a_circle(t).position).norm(), 0.01);
  EXPECT_TRUE(same_bits(lan.peer(0).ghost(world["O0"], t), lan.peer(1).ghost(world["O0"], t)));
}

TEST(Peer, CopiesOfAnUpdateSurviveTheLossOfTheFirst) {
  const World world(box("O0", "1 1 1", "0 0 0", "velocityVector 3 0 0"));
  Lan lan(world, {20ms, 0ms, 0, 0});
  PeerConfig c = config(1, {{world["O0"], false}});
  c.policy.copies = 4;
  lan.add(c);
  lan.add(config(2));
  std::vector<Duration> sent;
  int hellos = 0;
  lan.filter = [&](std::size_t, std::size_t to, const Message& m) {
    if (to != 1) return true;
    if (m.updates.empty()) return ++hellos % 3 != 0;  // the receiver notices, and says so
    sent.push_back(lan.now());
    return sent.size() > 3;
  };
  lan.run_until(3s);
  ASSERT_GE(sent.size(), 4u);
  EXPECT_EQ(sent[1], sent[0]) << "one at once";
  EXPECT_LE(sent[3] - sent[0], 40ms) << "the others with the next ticks";
  EXPECT_GE(lan.peer(0).counters().updates_repeated, 3u);
  EXPECT_EQ(lan.peer(1).counters().updates_in, 1u);
}

// What drives an object, or how the world launches it, may be farther and faster than anybody would take.
TEST(Peer, StatesOutOfRangeAreToldAsStanding) {
  const World world(box("O0", "1 1 1", "0 0 0", "velocityVector 1e13 0 0") + box("O1", "1 1 1", "0 0 0"));
  Lan lan(world, {20ms, 0ms, 0, 0});
  const auto far = [](SimTime t) {
    return t < sim(2s) ? moving({1, 0, 0}) : moving({1e13, 0, 0}, {std::numeric_limits<double>::infinity(), 0, 0});
  };
  PeerConfig c = config(1, {{world["O0"], false}, {world["O1"], true}});
  c.policy.models = ModelPolicy{};
  lan.add(c, 0s, {{world["O1"], far}});
  lan.add(config(2));
  lan.run_until(4s);
  EXPECT_GT(lan.peer(0).counters().states_out_of_range, 1u);
  for (const auto& [reason, count] : lan.peer(1).counters().drops) EXPECT_EQ(reason, "not_yet_in_session");
  EXPECT_TRUE(lan.peer(1).ghost(world["O1"], sim(4s)).velocity.isZero(0.0));
  EXPECT_LE(lan.peer(1).ghost(world["O0"], sim(4s)).position.norm(), 1e12);
}

TEST(Peer, NoCopiesWhereNothingGetsLost) {
  const World world(box("O0", "1 1 1", "0 0 0", "velocityVector 3 0 0"));
  Lan lan(world, {20ms, 0ms, 0, 0});
  PeerConfig c = config(1, {{world["O0"], false}});
  c.policy.copies = 4;
  c.policy.time_threshold = 200ms;
  lan.add(c);
  lan.add(config(2));
  lan.run_until(30s);
  const auto repeated = lan.peer(0).counters().updates_repeated;
  EXPECT_GT(repeated, 0u) << "at first it might be lossy";
  lan.run_until(60s);
  EXPECT_EQ(lan.peer(0).counters().updates_repeated, repeated);
}

}  // namespace
}  // namespace peerd::replication
