#include <gtest/gtest.h>

#include <random>

#include "replication/peer/peer.hpp"
#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/messages.hpp"

// These tests check what a peer sends, how often, and which models it chooses.
namespace peerd::replication::peer_output_test {

using namespace test;

// ---- sizes ----

TEST(Peer, TheLargestDatagramsFitAndEverythingGetsItsTurn) {
  const World world(field(260));
  Lan lan(world);
  PeerConfig c = config(0xFFFF'FFFE, {});
  c.name.assign(kNameMax_bytes, 'n');
  c.incarnation = ~std::uint64_t{0};
  c.world_hash = 0xC0FFEE;
  KinematicState full = moving({1.1, 2.2, 3.3}, {4.4, 5.5, 6.6}, {7.7, 8.8, 9.9});
  full.orientation = Quat(0.1, 0.2, 0.3, 0.4).normalized();
  full.angular_velocity_body = {1.1, 2.2, 3.3};
  std::map<ObjectId, Lan::Motion> motions;
  for (int i = 0; i < 260; ++i) {
    const ObjectId id = world["O" + std::to_string(i)];
    c.owned.push_back({id, true});
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
    if (const Introduction* i = m.introduction()) claimed.insert(i->owned.begin(), i->owned.end());
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

// A link is dead in one direction for longer than the time after which a peer is lost. The peer that was lost publishes
// all its states again. The loss is noticed although a hello names only some of the members: of 30 others, peer 17 is
// between the last one of a list and the first one of the next.
TEST(Peer, APeerThatWasLostRepublishesItsStates) {
  const World world(box("O0", "1 1 1", "0 0 0", "velocityVector 4 0 0"));
  for (const auto& [peers, forgotten, dead] : {std::tuple(2u, 2u, 1800ms),
                                               {2, 2, 1900ms},
                                               {2, 2, 2000ms},
                                               {2, 2, 2100ms},
                                               {2, 2, 2200ms},
                                               {2, 2, 2300ms},
                                               {32, 17, 1800ms},
                                               {32, 17, 2000ms}}) {
    SCOPED_TRACE(testing::Message() << dead.count() << " ms, of " << peers);
    Lan lan(world, {20ms, 0ms, 0, 0});
    for (std::uint32_t id = 1; id <= peers; ++id) {
      PeerConfig c = config(id);
      if (id == forgotten) c.owned = {{world["O0"], false}};
      c.policy.time_threshold = 60s;
      lan.add(c);
    }
    lan.run_until(6s);
    lan.filter = [&, silent = forgotten - 1](std::size_t from, std::size_t to, const Message&) {
      return from != silent || to != 0;
    };
    lan.run_until(6s + dead);
    lan.filter = nullptr;
    lan.run_until(peers == 2 ? 9500ms : 10000ms);
    const SimTime t = lan.session_now(0);
    const Vec3 truth = lan.peer(forgotten - 1).truth(world["O0"], t).position;
    EXPECT_LT((lan.peer(0).ghost(world["O0"], t).position - truth).norm(), 1e-6);
  }
}

// Nobody acknowledges what a relay forwards: the state of an object that rests behind it is published at each time
// threshold.
TEST(Peer, UpdatesLostByARelayAreRepublished) {
  const World world(box("O0", "1 1 1", "0 0 0", "velocityVector 1 0 0"));
  Lan lan(world, {20ms, 0ms, 0, 0});
  for (std::uint32_t id = 1; id <= 3; ++id) {
    PeerConfig c = config(id, id == 1 ? std::vector<OwnedObject>{{world["O0"], false}} : std::vector<OwnedObject>{});
    c.relay.through = PeerId{2};
    lan.add(c);
  }
  lan.run_until(20s);
  int lost = 0;
  lan.filter = [&](std::size_t from, std::size_t to, const Message& m) {
    const bool carries = from == 1 && to == 2 && !m.updates.empty() && lost == 0;
    lost += carries;
    return !carries;
  };
  ASSERT_TRUE(lan.peer(0).change_velocity(lan.host_now(0), world["O0"], Vec3(0, 0, 0), true));
  lan.run_until(26s);
  EXPECT_EQ(lost, 1);
  const SimTime t = lan.session_now(0);
  EXPECT_LT((lan.peer(2).ghost(world["O0"], t).position - lan.peer(0).truth(world["O0"], t).position).norm(), 1e-6);
}

// A hello names 15 of 29 others. The loss of the one that named this peer does not mean that the sender has lost it.
TEST(Peer, AHelloLostOnceDoesNotLoseAPeer) {
  constexpr int kPeers = 30;
  const World world(field(kPeers));
  Lan lan(world, {5ms, 0ms, 0.02, 0});
  for (int i = 0; i < kPeers; ++i)
    lan.add(config(static_cast<std::uint32_t>(i + 1), {{world["O" + std::to_string(i)], false}}));
  lan.run_until(10s);
  const auto resent = [&](std::size_t i) {
    return std::ranges::count(lan.seen<Published>(i), PublishReason::kJoiner, &Published::reason);
  };
  std::ptrdiff_t resent_before = 0, resent_after = 0;
  for (std::size_t i = 0; i < kPeers; ++i) resent_before += resent(i);
  lan.run_until(40s);
  for (std::size_t i = 0; i < kPeers; ++i) {
    EXPECT_EQ(lan.peer(i).members().all().size(), kPeers - 1u);
    resent_after += resent(i);
  }
  EXPECT_EQ(resent_after, resent_before);
}

// Forty objects shake so that no model predicts them, those with higher numbers more. The budget suffices for a quarter
// of the updates that they need.
class ShortOfBytes : public testing::Test {
 protected:
  static constexpr int kObjects = 40;
  static constexpr double kBytes_per_s = 1000.0;
  ObjectId object(int i) { return world["O" + std::to_string(i)]; }
  std::map<ObjectId, Lan::Motion> shaking() {
    std::map<ObjectId, Lan::Motion> motions;
    for (int i = 0; i < kObjects; ++i) {
      const Vec3 at(3.0 * i, 0, 0);
      motions[object(i)] = [=](SimTime t) {
        std::mt19937_64 random(static_cast<std::uint64_t>(t.time_since_epoch().count() / 100'000'000 * 64 + i));
        return moving(at + Vec3(0, (1.0 + i) * (static_cast<double>(random() % 1000) - 500.0) / 500.0, 0));
      };
    }
    return motions;
  }
  // Counts what the first peer sends from 5 s on.
  void run(PeerConfig watcher, std::optional<double> bytes_per_s, Duration until) {
    std::vector<OwnedObject> all;
    for (int i = 0; i < kObjects; ++i) all.push_back({object(i), true});
    PeerConfig c = config(1, all);
    c.policy.error_threshold_m = 0.5;
    c.policy.bytes_per_s = bytes_per_s;
    lan.add(c, 0s, shaking());
    lan.add(std::move(watcher));
    lan.run_until(5s);
    lan.on_send = [&](std::size_t from, RegionId, const Message& m) {
      if (from != 0) return;
      bytes += encode(m).size();
      for (const UpdateRecord& u : m.updates) sent[u.object].push_back(lan.now());
    };
    lan.run_until(until);
  }
  std::size_t updates_of(int i) { return sent[object(i)].size(); }

  World world{field(kObjects)};
  Lan lan{world};
  std::size_t bytes = 0;
  std::map<ObjectId, std::vector<Duration>> sent;
};

TEST_F(ShortOfBytes, ABudgetIsKeptAndTheMostWrongIsPublishedMostAndNothingStarves) {
  run(config(2), kBytes_per_s, 65s);
  EXPECT_LE(static_cast<double>(bytes), kBytes_per_s * 60.0 + 1200.0);
  EXPECT_GE(static_cast<double>(bytes), 0.97 * kBytes_per_s * 60.0);
  EXPECT_GT(lan.peer(0).counters().updates_withheld, 1000u);
  EXPECT_GT(2 * updates_of(19), 3 * updates_of(4)) << "20 m, or 5 m";
  EXPECT_GT(updates_of(39), updates_of(19));
  for (int i = 0; i < kObjects; ++i) EXPECT_GE(updates_of(i), 4u) << i;
}

TEST_F(ShortOfBytes, NothingIsWithheldWithoutOne) {
  run(config(2), std::nullopt, 35s);
  EXPECT_GT(static_cast<double>(bytes), 2.5 * kBytes_per_s * 30.0);
  EXPECT_EQ(lan.peer(0).counters().updates_withheld, 0u);
}

// The first states of all objects take a second's bytes.
TEST_F(ShortOfBytes, FirstStatesComeFirstHoweverSmallTheirError) {
  run(config(2), kBytes_per_s, 20s);
  const std::size_t newcomer = lan.add(config(3));
  while (!lan.peer(newcomer).clock().synchronised() && lan.now() < 25s) lan.run_until(lan.now() + 10ms);
  const Duration came = lan.now();
  lan.run_until(came + 1s);
  for (int i = 0; i < kObjects; ++i) {
    EXPECT_TRUE(std::ranges::any_of(sent[object(i)], [&](Duration at) { return at >= came; })) << i;
  }
}

// An object that is four times as wrong but four times as far away is no more urgent.
TEST_F(ShortOfBytes, ObjectsFarFromViewersArePublishedLess) {
  PeerConfig watcher = config(2);
  watcher.decisions.viewpoint = Viewpoint{std::nullopt, {Vec3(0, 0, 5), Quat::Identity()}};
  run(watcher, kBytes_per_s, 65s);
  EXPECT_LT(2 * updates_of(39), 3 * updates_of(9)) << "117 m away and 40 m wrong, or 27 m and 10 m";
}

TEST(Peer, AllHearWhereAPeerLooksFromNow) {
  const World world(field(1));
  Lan lan(world);
  lan.add(config(1));
  lan.add(config(2));
  lan.run_until(3s);
  const auto known = [&] { return lan.peer(1).members().all().at(PeerId{1}).viewpoint; };
  EXPECT_FALSE(known());
  lan.peer(0).look_from(Viewpoint{world["O0"], {Vec3(0, 0, 5), Quat::Identity()}});
  lan.run_until(5s);
  ASSERT_TRUE(known());
  EXPECT_EQ(known()->object, world["O0"]);
  EXPECT_EQ(known()->pose.position, Vec3(0, 0, 5));
  lan.peer(0).look_from(std::nullopt);
  lan.run_until(7s);
  EXPECT_FALSE(known());
}

// O0 runs ahead of its ghost twice as fast as O1 does: when O0 is published, O1 has half of the error that it may have.
TEST(Peer, HalfWrongObjectsPiggybackOnDueUpdates) {
  const World world(field(2));
  for (const double piggyback_fraction : {1.0, 0.4}) {
    Lan lan(world);
    PeerConfig c = config(1, {{world["O0"], true}, {world["O1"], true}});
    c.policy.order = ModelOrder::kFirst;
    c.policy.error_threshold_m = 0.5;
    c.policy.piggyback_fraction = piggyback_fraction;
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
    EXPECT_EQ(piggyback_fraction < 1.0, alone < together / 4) << alone << " alone, " << together << " together";
    EXPECT_GT(alone + together, 5u);
  }
}

// An object that stands, and whose place all receivers are known to have, needs no heartbeat, whether datagrams get
// lost or not. An object that a receiver has never heard of has one.
TEST(Peer, AcknowledgedRestingObjectsAreSeldomRepublished) {
  const World world(box("O0", "1 1 1", "0 0 0"));
  for (const bool heard : {true, false}) {
    for (const Link link :
         {Link{20ms, 0ms, 0.0}, Link{20ms, 0ms, 0.2}, Link{20ms, 300ms, 0.0}, Link{20ms, 300ms, 0.2}}) {
      SCOPED_TRACE(testing::Message() << "jitter " << link.jitter.count() << " ns, loss " << link.loss);
      Lan lan(world, link);
      lan.add(config(1, {{world["O0"], false}}));
      lan.add(config(2));
      lan.filter = [&](std::size_t, std::size_t to, const Message& m) { return heard || to != 1 || m.updates.empty(); };
      lan.run_until(10s);
      const std::uint64_t updates = lan.peer(0).counters().updates_out;
      lan.run_until(50s);
      EXPECT_EQ(lan.peer(0).counters().updates_out == updates, heard);
      EXPECT_EQ(lan.peer(1).owner(world["O0"]), PeerId{1});
    }
  }
}

// The first three updates of a motion are lost. The owner repeats the update, and does not leave it to the heartbeat.
TEST(Peer, UnacknowledgedUpdatesAreRepeatedUntilAcknowledged) {
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

// ---- models ----

PeerConfig choosing(std::uint32_t id, std::vector<OwnedObject> owned = {}) {
  PeerConfig c = config(id, std::move(owned));
  c.policy.models.emplace();
  c.policy.wanted_error_m = 0.005;
  return c;
}

// Chosen models, too, give one prediction on all peers, whatever their tick rates and however the network behaves.
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

TEST(Models, AreChosenForTheLatencyThatHellosMeasure) {
  const World world(field(1));
  for (const Duration latency : {5ms, 80ms, 300ms}) {
    Lan lan(world, {latency, 0ms, 0, 0});
    lan.add(choosing(1, {{world["O0"], true}}), 0s, {{world["O0"], on_a_circle}});
    lan.add(choosing(2), 7s);  // its clock is another
    lan.run_until(6s);
    const Member& other = lan.peer(0).members().all().at(PeerId{2});
    ASSERT_TRUE(other.delays.mean());
    EXPECT_NEAR(to_seconds(*other.delays.mean()), to_seconds(latency), 1e-3);
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

}  // namespace peerd::replication::peer_output_test
