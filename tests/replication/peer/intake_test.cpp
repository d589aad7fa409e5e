#include "replication/peer/intake.hpp"

#include <gtest/gtest.h>

#include <array>

#include "replication/wire/wire_limits.hpp"
#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::intake_test {

using namespace test;

// A peer, as far as it takes datagrams.
struct Receiver {
  Receiver(const PeerConfig& config, const World& world) : p(config, *world.model) {}
  Receiver(const World& world) : Receiver(config(5), world) {}

  // Founds a session at 1 s.
  void maintain_until(Duration end) {
    for (Duration t = 0s; t <= end; t += 100ms) (void)keeper.maintain(host(t));
  }
  std::expected<void, Drop> take(const Message& m, HostTime now, RegionId region = kWholeScene) {
    return intake.on_packet(now, region, encode(m));
  }
  // Takes a datagram in which `sender` publishes updates, or a decision.
  bool take(std::uint32_t sender, const std::vector<UpdateRecord>& updates, HostTime now) {
    Message m = message_of(sender);
    m.updates = updates;
    return take(m, now).has_value();
  }
  bool take(std::uint32_t sender, const DecisionRecord& decision, HostTime now) {
    Message m = message_of(sender);
    m.decisions = {decision};
    return take(m, now).has_value();
  }

  PeerParts p;
  SceneKeeper scene{p};
  SessionKeeper keeper{p, scene};
  OperationKeeper operations{p, keeper};
  Intake intake{p, keeper, scene, operations};
};

// Peer 5 founded a session at 1 s and owns O0; peer 7 introduced itself at 2 s and owns O1.
class Arriving : public testing::Test {
 protected:
  Arriving() {
    peer.maintain_until(2s);
    p.ticks.set_last(p.ticks.number_at(sim(2s)));  // no tick is due
    EXPECT_TRUE(take(hello_of(7, host(2s), {o1})).has_value());
  }
  std::expected<void, Drop> take(const Message& m, RegionId region = kWholeScene, HostTime now = host(2s)) {
    return peer.take(m, now, region);
  }
  Message update(std::uint32_t sequence, double x, SimTime at = sim(2s), std::uint32_t sender = 7) {
    Message m = message_of(sender);
    m.updates.push_back({o1, sequence, at, moving({x, 0, 0})});
    return m;
  }
  double x() const { return p.replica.ghost(o1, sim(2s)).position.x(); }

  World world{field(3)};
  ObjectId o0 = world["O0"], o1 = world["O1"], o2 = world["O2"];
  Receiver peer{config(5, {{o0}}), world};
  PeerParts& p = peer.p;
};

TEST_F(Arriving, AnIntroductionMakesAMemberWithItsObjects) {
  const Member* seven = p.members.find(PeerId{7});
  ASSERT_NE(seven, nullptr);
  EXPECT_EQ(seven->name, "forged7");
  EXPECT_EQ(seven->hello, 1u);
  EXPECT_EQ(seven->hello_rx, host(2s));
  EXPECT_TRUE(seven->synchronised);
  EXPECT_EQ(p.owners.of(o1), PeerId{7});
  const auto joined = drain<PeerJoined>(p.outbox);
  ASSERT_EQ(joined.size(), 1u);
  EXPECT_FALSE(joined[0].restarted);
}

TEST_F(Arriving, CountsWhatItUsesInAllByRegionAndByMember) {
  const auto before = p.counters;
  const Bytes datagram = encode(update(1, 3.5));
  ASSERT_TRUE(peer.intake.on_packet(host(2s), RegionId{4}, datagram));
  EXPECT_EQ(p.counters.datagrams_in, before.datagrams_in + 1);
  EXPECT_EQ(p.counters.bytes_in, before.bytes_in + datagram.size());
  EXPECT_EQ(p.counters.regions[RegionId{4}].bytes_in, datagram.size());
  EXPECT_EQ(p.members.find(PeerId{7})->datagrams_in, 2u);
}

TEST_F(Arriving, WhatIsNoDatagramIsDropped) {
  const Bytes garbage(40, std::byte{0xFF});
  EXPECT_EQ(peer.intake.on_packet(host(2s), kWholeScene, garbage), std::unexpected(Drop::kUndecodable));
  EXPECT_EQ(p.counters.drops["undecodable"], 1u);
  EXPECT_EQ(p.counters.regions[kWholeScene].drops["undecodable"], 1u);
  Bytes of_another_version = encode(hello_of(8, host(2s)));
  ASSERT_EQ(of_another_version[1], std::byte{kProtocolVersion});
  of_another_version[1] = std::byte{kProtocolVersion + 1};
  EXPECT_EQ(peer.intake.on_packet(host(2s), kWholeScene, of_another_version), std::unexpected(Drop::kUndecodable));
  EXPECT_EQ(drain<OtherVersion>(p.outbox).at(0).version, kProtocolVersion + 1);
}

TEST_F(Arriving, WhatConcernsEverybodyIsNotSaidInARegion) {
  Message far_ahead = hello_of(7, host(2s));
  far_ahead.number = 1'000'000;
  EXPECT_EQ(take(far_ahead, RegionId{4}), std::unexpected(Drop::kRegion));
  EXPECT_EQ(p.members.find(PeerId{7})->received[kWholeScene].received().highest, 1u)
      << "numbers of a region are its own";
  Message goodbye = message_of(7);
  goodbye.leaving = true;
  EXPECT_EQ(take(goodbye, RegionId{4}), std::unexpected(Drop::kRegion));
  EXPECT_TRUE(p.members.contains(PeerId{7}));
}

TEST_F(Arriving, AnUpdateMovesTheGhostInItsSequence) {
  ASSERT_TRUE(take(update(2, 4.0)));
  EXPECT_EQ(x(), 4.0);
  EXPECT_EQ(p.counters.updates_in, 1u);
  EXPECT_EQ(p.replica.last_update_of(o1)->sequence, 2u);
  ASSERT_TRUE(take(update(2, 5.0)));
  EXPECT_EQ(p.counters.updates_duplicate, 1u);
  ASSERT_TRUE(take(update(1, 5.0)));
  EXPECT_EQ(p.counters.drops["old_sequence"], 1u);
  EXPECT_EQ(x(), 4.0);
  ASSERT_TRUE(take(update(3, 6.0)));
  EXPECT_EQ(x(), 6.0);
  ASSERT_TRUE(take(hello_of(8, host(2s), {o2})));
  Message another = update(1, 9.0, sim(2s), 8);
  another.updates[0].object = o2;
  ASSERT_TRUE(take(another));
  EXPECT_EQ(p.counters.updates_in, 3u) << "each object has its own sequence";
  ASSERT_TRUE(take(update(0xFFFF'FFFF, 7.0)));
  ASSERT_TRUE(take(update(1, 8.0)));
  EXPECT_EQ(x(), 7.0) << "the last number is the end";
}

// An update names a frame that its sender knows of, and this peer does not, or the other way round.
TEST(ArrivingInAFrame, IsWhereItsSenderSees) {
  const World w(car_and_wheel() + box("BIRD", "1 1 1", "0 9 0"));
  const ObjectId car = w["CAR"], wheel = w["WHEEL"];
  Receiver peer(w);
  PeerParts& p = peer.p;
  peer.maintain_until(1s);
  ASSERT_TRUE(peer.take(hello_of(7, host(1s)), host(1s)));
  const auto take = [&](ObjectId object, std::uint32_t sequence, std::optional<ObjectId> carrier, const Vec3& at) {
    UpdateRecord u{object, sequence, sim(1s), moving(at)};
    u.carrier = carrier;
    return peer.take(7, {u}, host(1s));
  };
  const auto at = [&](ObjectId object) { return p.replica.ghost(object, sim(1s)).position; };
  ASSERT_TRUE(take(wheel, 1, car, {1, -1, 3}));
  EXPECT_EQ(at(wheel), Vec3(1, 1, 3)) << "the car stands";
  EXPECT_EQ(p.counters.models_changed, 1u);
  EXPECT_TRUE(p.model->is_carrier(car));
  ASSERT_TRUE(take(car, 1, std::nullopt, {0, 2, 10}));
  EXPECT_EQ(at(wheel), Vec3(1, 1, 13));
  ASSERT_TRUE(take(wheel, 2, std::nullopt, {5, 5, 5})) << "of a sender that does not know that the car moves";
  EXPECT_LT((at(wheel) - Vec3(5, 5, 5)).norm(), 1e-12);
  EXPECT_EQ(p.counters.models_changed, 1u);
  for (const ObjectId wrong : {wheel, w["BIRD"], w["CAR/0"], ObjectId{999}})
    EXPECT_TRUE(take(wheel, 3, wrong, {0, 0, 0}));
  EXPECT_EQ(p.counters.drops["carrier"], 4u);
  EXPECT_LT((at(wheel) - Vec3(5, 5, 5)).norm(), 1e-12);
}

// What a decision has interrupted goes on by the owner's update, wherever that was in.
TEST(ArrivingInAFrame, GoesOnThereAfterADecision) {
  const World w(car_and_wheel() + box("BALL", "1 1 1", "0 9 0") + interest("WHEEL", "\"BALL\""));
  const ObjectId car = w["CAR"], wheel = w["WHEEL"], ball = w["BALL"];
  Receiver peer(w);
  PeerParts& p = peer.p;
  peer.maintain_until(1s);
  ASSERT_TRUE(peer.take(hello_of(3, host(1s), {car, wheel}), host(1s)));
  ASSERT_TRUE(peer.take(hello_of(7, host(1s), {ball}), host(1s)));
  p.ticks.set_last(p.ticks.number_at(sim(1s)));
  const UpdateRecord moved{car, 1, sim(900ms), moving({0, 2, 10})}, u{wheel, 1, sim(1s), moving({5, 5, 5}), sim(950ms)};
  ASSERT_TRUE(peer.take(3, {moved, u}, host(1s)));
  ASSERT_TRUE(peer.take(3, decision_on(wheel, ball, sim(950ms), moving({1, 1, 13}), moving({0, 9, 0})), host(1s)));
  EXPECT_EQ(p.decisions.log().entries().size(), 1u);
  EXPECT_LT((p.replica.ghost(wheel, sim(1s)).position - Vec3(5, 5, 5)).norm(), 1e-12) << "the update was in the world";
}

// With a bounded latency an update of before a decision that its sender doesn't know is still shown until there. One
// that an earlier decision makes void is of a way that nobody has seen.
TEST(ArrivingAfterDecisions, IsShownUntilTheFirstOneThatItDoesNotKnow) {
  const World w(box("A", "1 1 1", "0 0 0", kBounces) + box("B", "1 1 1", "-50 0 0") + interest("A", "\"B\""));
  const ObjectId a = w["A"], b = w["B"];
  PeerConfig conf = config(5);
  conf.bounded_latency.least = 1s;
  Receiver peer(conf, w);
  PeerParts& p = peer.p;
  peer.maintain_until(2s);
  ASSERT_TRUE(peer.take(hello_of(3, host(2s), {a}), host(2s)));
  ASSERT_TRUE(peer.take(hello_of(7, host(2s), {b}), host(2s)));
  p.ticks.set_last(p.ticks.number_at(sim(2s)));
  const auto decide = [&](SimTime at, double x) {
    DecisionRecord d = decision_on(a, b, at, moving({0, 0, 0}), moving({-50, 0, 0}));
    d.collider_after = moving({x, 0, 0});
    ASSERT_TRUE(peer.take(3, d, host(2s)));
  };
  const auto say = [&](std::uint32_t sequence, SimTime at, double x, SimTime decision) {
    const std::vector<UpdateRecord> updates(1, UpdateRecord{a, sequence, at, moving({x, 0, 0}), decision});
    ASSERT_TRUE(peer.take(3, updates, host(2s)));
  };
  const auto x = [&](Duration t) {
    p.replica.advance_ghosts(sim(2s));
    return p.replica.ghost(a, sim(t)).position.x();
  };
  decide(sim(1500ms), 15.0);
  decide(sim(1800ms), 18.0);
  ASSERT_EQ(p.decisions.log().entries().size(), 2u);
  say(1, sim(1400ms), 14.0, {});
  EXPECT_EQ(x(1450ms), 14.0);
  EXPECT_EQ(x(1600ms), 15.0) << "from the decision on it goes as it did";
  EXPECT_EQ(x(1900ms), 18.0);
  EXPECT_EQ(p.replica.truth(a, sim(1450ms)).position.x(), 0.0) << "in which the contact has been found";
  say(2, sim(1600ms), 16.0, {});
  EXPECT_EQ(x(1700ms), 15.0) << "it knows nothing of the decision of 1.5 s";
  say(3, sim(1700ms), 17.0, sim(1500ms));
  EXPECT_EQ(x(1450ms), 14.0);
  EXPECT_EQ(x(1650ms), 15.0);
  EXPECT_EQ(x(1750ms), 17.0);
  EXPECT_EQ(x(1900ms), 18.0);
  EXPECT_EQ(p.counters.drops["before_decision"], 3u) << "none of them is in force now";
  say(4, sim(1900ms), 19.0, sim(1800ms));
  EXPECT_EQ(x(1950ms), 19.0);
  EXPECT_EQ(p.counters.drops["before_decision"], 3u);
}

// Nothing rigid moves what a driven scale distorts: that it is named as a carrier makes no model anew, again and again.
TEST(ArrivingInAFrame, WhatCanBeNoCarrierIsTriedOnce) {
  const World w("DEF GROWS Transform { children " + box("INSIDE", "1 1 1", "1 0 0") + " }" + R"(
DEF CLOCK TimeSensor { loop TRUE }
DEF PATH PositionInterpolator { key [ 0 1 ] keyValue [ 1 1 1, 2 2 2 ] }
ROUTE CLOCK.fraction_changed TO PATH.set_fraction
ROUTE PATH.value_changed TO GROWS.scale
)" + box("WALL", "1 1 1", "9 0 0") +
                interest("WALL", "\"INSIDE\""));
  Receiver peer(w);
  PeerParts& p = peer.p;
  peer.maintain_until(1s);
  ASSERT_TRUE(peer.take(hello_of(7, host(1s), {w["INSIDE"]}), host(1s)));
  const auto changed = [&] { return p.counters.models_changed; };
  UpdateRecord u{w["INSIDE"], 1, sim(1s), moving({1, 0, 0})};
  u.carrier = w["GROWS"];
  ASSERT_TRUE(peer.take(7, {u}, host(1s)));
  const auto once = changed();
  EXPECT_FALSE(p.model->is_carrier(w["GROWS"]));
  for (u.sequence = 2; u.sequence < 5; ++u.sequence) ASSERT_TRUE(peer.take(7, {u}, host(1s)));
  EXPECT_EQ(p.counters.updates_in, 4u);
  EXPECT_EQ(changed(), once);
}

TEST_F(Arriving, UpdatesCountWithinTheirTimesLimits) {
  for (const Duration at :
       std::array<Duration, 4>{2s - kUpdateAgeMax - 1ns, 2s + kUpdateAheadMax + 1ns, 2s - 1h, 2s + 1h}) {
    ASSERT_TRUE(take(update(9, 4.0, sim(at))));
  }
  EXPECT_EQ(p.counters.drops["update_time"], 4u);
  EXPECT_EQ(p.members.find(PeerId{7})->drops["update_time"], 4u);
  EXPECT_EQ(p.counters.updates_in, 0u);
  ASSERT_TRUE(take(update(1, 4.0, sim(2s + kUpdateAheadMax))));
  EXPECT_EQ(p.counters.updates_in, 0u) << "it waits for its instant";
  EXPECT_EQ(p.counters.records_early, 1u);
  peer.intake.take_early(host(2s), sim(2s + kUpdateAheadMax - 1ns));
  EXPECT_EQ(p.counters.updates_in, 0u);
  peer.intake.take_early(host(2s), sim(2s + kUpdateAheadMax));
  EXPECT_EQ(p.counters.updates_in, 1u);
}

// Records that come between two ticks advance the worlds to their instants, a number of times. The others wait, and are
// taken once a tick has.
TEST_F(Arriving, RecordsAdvanceTheWorldsOnlySoOften) {
  constexpr std::uint32_t kMany = 100;
  const auto at = [](std::uint32_t k) { return 2s + std::chrono::microseconds(k); };
  for (std::uint32_t k = 1; k <= kMany; ++k)
    ASSERT_TRUE(take(update(k, 4.0 + k, sim(at(k))), kWholeScene, host(at(k))));
  EXPECT_EQ(p.counters.updates_in, 64u);
  EXPECT_EQ(p.counters.records_early, kMany - 64u);
  EXPECT_EQ(p.replica.truth().advanced(), sim(at(64)));
  p.advance_worlds(sim(at(kMany)));
  peer.intake.take_early(host(at(kMany)), sim(at(kMany)));
  EXPECT_EQ(p.counters.updates_in, kMany);
}

TEST_F(Arriving, OnlyItsOwnerMovesAnObject) {
  ASSERT_TRUE(take(hello_of(8, host(2s))));
  ASSERT_TRUE(take(update(1, 4.0, sim(2s), 8)));
  EXPECT_EQ(p.counters.drops["not_owner"], 1u);
  EXPECT_EQ(x(), 3.0);
  Message of_ours = update(1, 4.0);
  of_ours.updates[0].object = o0;
  ASSERT_TRUE(take(of_ours));
  EXPECT_EQ(p.counters.drops["not_owner"], 2u);
  EXPECT_EQ(p.replica.ghost(o0, sim(2s)).position.x(), 0.0);
  Message unowned = update(1, 9.0, sim(2s), 8);
  unowned.updates[0].object = o2;
  ASSERT_TRUE(take(unowned));
  EXPECT_EQ(p.owners.of(o2), PeerId{8}) << "its hello may have been lost";
  EXPECT_EQ(p.replica.ghost(o2, sim(2s)).position.x(), 9.0);
}

TEST_F(Arriving, AGoodbyeEndsMembershipAtOnce) {
  Message goodbye = message_of(7);
  goodbye.leaving = true;
  ASSERT_TRUE(take(goodbye));
  EXPECT_FALSE(p.members.contains(PeerId{7}));
  EXPECT_EQ(p.owners.of(o1), kNobody);
  EXPECT_TRUE(drain<PeerLost>(p.outbox).at(0).left_gracefully);
}

TEST_F(Arriving, ARestartedPeersObjectsAreItsNoLongerUntilItSaysSo) {
  ASSERT_TRUE(take(update(9, 4.0)));
  ASSERT_TRUE(take(hello_of(7, host(2s), {}, 101)));
  EXPECT_EQ(p.owners.of(o1), kNobody);
  const auto joined = drain<PeerJoined>(p.outbox);
  ASSERT_EQ(joined.size(), 2u);
  EXPECT_TRUE(joined[1].restarted);
}

// This peer has sent five datagrams, of which the fourth carried its object's update; peer 7 has had the second.
class Echoed : public Arriving {
 protected:
  Echoed() {
    for (int i = 0; i < 5; ++i) {
      Message m = p.outbox.blank();
      p.outbox.send(m);
    }
    echo(2, {2, 1, ~std::uint64_t{0b10}});
    own.delivery.sent_in = {4};
    own.delivery.unacknowledged_by.insert(PeerId{7});
  }
  void echo(std::uint32_t number, const Received& received) {
    Message hello = hello_of(7, host(2s), {o1});
    hello.number = number;
    hello.hello->echoes.push_back({PeerId{5}, 1, 0s, received, 0.001});
    EXPECT_TRUE(take(hello).has_value());
  }
  OwnObject& own = p.own.at(o0);
};

TEST_F(Echoed, WhatHasArrivedIsAcknowledged) {
  echo(3, {5, 1, ~std::uint64_t{0b10}});
  EXPECT_FALSE(own.delivery.acknowledged_by.contains(PeerId{7})) << "number 4 is missing";
  echo(4, {5, 5, ~std::uint64_t{0}});
  EXPECT_TRUE(own.delivery.acknowledged_by.contains(PeerId{7}));
  EXPECT_FALSE(own.delivery.unacknowledged_by.contains(PeerId{7}));
}

TEST_F(Echoed, AnEchoOfMoreThanThisPeerHasSentIsOfItsLastIncarnation) {
  echo(3, {9, 9, ~std::uint64_t{0}});
  EXPECT_FALSE(own.delivery.acknowledged_by.contains(PeerId{7}));
}

TEST_F(Arriving, APeerInANewSessionIsSentEverythingAnew) {
  p.own.at(o0).resend = false;
  Message hello = hello_of(7, host(2s), {o1});
  hello.number = 2;
  ASSERT_TRUE(take(hello));
  EXPECT_FALSE(p.own.at(o0).resend);
  hello.number = 3;
  hello.hello->sessions = 1;
  ASSERT_TRUE(take(hello));
  EXPECT_TRUE(p.own.at(o0).resend);
}

class Unsettled : public testing::Test {
 protected:
  World world{field(2)};
  Receiver peer{world};
};

TEST_F(Unsettled, RecordsBeforeTheSessionAreNotUsed) {
  peer.maintain_until(0s);
  ASSERT_TRUE(peer.take(hello_of(7, host(0s)), host(0s)));
  Message m = message_of(7);
  EXPECT_TRUE(peer.take(m, host(0s))) << "a keepalive";
  m.updates.push_back({world["O1"], 1, {}, {}});
  EXPECT_EQ(peer.take(m, host(0s)), std::unexpected(Drop::kNotYetInSession));
}

// A peer without a session knows no time of it.
TEST_F(Unsettled, AWorldsZeroCountsOnlyWithASession) {
  Message hello = hello_of(7, host(0s));
  hello.hello->introduction->world_zero = sim(3s);
  hello.hello->session_tx.reset();
  ASSERT_TRUE(peer.take(hello, host(0s)));
  EXPECT_EQ(peer.p.world_time.zero(), std::nullopt);
  hello.number = 2;
  hello.hello->session_tx = sim(0s);
  ASSERT_TRUE(peer.take(hello, host(0s)));
  EXPECT_EQ(peer.p.world_time.zero(), sim(3s));
}

TEST_F(Unsettled, AnUnintroducedPeerIsAskedForItsIntroduction) {
  peer.maintain_until(1s);
  Greeter& greeter = peer.p.greeter;
  while (greeter.must_introduce(true)) (void)greeter.introduction({}, {}, {});
  EXPECT_EQ(peer.take(message_of(7), host(9s)), std::unexpected(Drop::kUnintroduced));
  EXPECT_TRUE(greeter.must_introduce(true));
  EXPECT_TRUE(greeter.is_settling(host(9s)));
}

}  // namespace peerd::replication::intake_test
