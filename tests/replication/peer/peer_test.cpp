#include "replication/peer/peer.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/messages.hpp"

// These tests check what a peer does with datagrams, and how its objects look to others. Sessions and collisions have
// files of their own.
namespace peerd::replication::peer_test {

using namespace test;

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

TEST_F(InSession, AModelUnknownToThisBuildIsCountedAndTheRestOfItsDatagramCounts) {
  EXPECT_TRUE(lan.inject(self, with_records(update(1, 10ms, 8, "O2"), {0x08, 3, 1, 2, 3}, {})));
  EXPECT_EQ(lan.drops(self, "unknown_model"), 1u);
  EXPECT_EQ(ghost_x("O2"), 8);
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
