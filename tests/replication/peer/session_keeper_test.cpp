#include "replication/peer/session_keeper.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::session_keeper_test {

using namespace test;

// Peer 5 owns O0, which stands until it is launched, and O1, which a driver moves.
class Keeping : public testing::Test {
 protected:
  static PeerConfig make(const World& world) {
    PeerConfig c = config(5, {{world["O0"]}, {world["O1"], true}});
    c.owned[0].launch = {2s, Vec3(1, 0, 0)};
    return c;
  }
  // Runs until the session begins, at 1 s.
  void found() {
    for (Duration t = 0s; t <= 1s; t += 100ms) (void)keeper.maintain(host(t));
    ASSERT_TRUE(p.replica.begun());
  }
  void member_owns(std::uint32_t id, std::vector<ObjectId> objects, HostTime now = host(1s)) {
    add_member(p.members, id, now);
    keeper.claim(PeerId{id}, objects);
  }

  World world{field(4)};
  ObjectId o0 = world["O0"], o1 = world["O1"], o2 = world["O2"], o3 = world["O3"];
  PeerParts p{make(world), *world.model};
  SceneKeeper scene{p};
  SessionKeeper keeper{p, scene};
};

TEST_F(Keeping, EntersItsOwnSessionAfterListening) {
  EXPECT_TRUE(keeper.maintain(host(0s)));
  EXPECT_EQ(p.time.started(), host(0s));
  EXPECT_TRUE(p.greeter.is_due(host(0s)));
  for (Duration t = 100ms; t < 1s; t += 100ms) EXPECT_TRUE(keeper.maintain(host(t)));
  EXPECT_FALSE(p.replica.begun());
  EXPECT_TRUE(keeper.maintain(host(1s)));
  EXPECT_TRUE(p.replica.begun());
  EXPECT_EQ(p.greeter.sessions(), 1u);
  EXPECT_EQ(p.ticks.last(), p.ticks.number_at(p.to_session(host(1s))));
  EXPECT_EQ(p.replica.truth(o0, sim(1s)).position, Vec3(0, 0, 0));
  p.extend_motions(sim(3s) - 1ns);
  EXPECT_TRUE(p.launches.unpublished().empty());
  p.extend_motions(sim(3s));
  EXPECT_EQ(p.launches.unpublished().at(o0), sim(3s)) << "2 s after the session's begin";
}

TEST_F(Keeping, OfTwoThatClaimAnObjectTheLowerIdHasIt) {
  found();
  member_owns(7, {o2});
  EXPECT_EQ(p.owners.of(o2), PeerId{7});
  member_owns(8, {o2, o3});
  EXPECT_EQ(p.owners.of(o2), PeerId{7});
  EXPECT_EQ(p.owners.of(o3), PeerId{8});
  EXPECT_TRUE(drain<OwnershipConflict>(p.outbox).empty());
  member_owns(6, {o2});
  EXPECT_EQ(p.owners.of(o2), PeerId{6});
  const auto conflicts = drain<OwnershipConflict>(p.outbox);
  ASSERT_EQ(conflicts.size(), 1u);
  EXPECT_EQ(conflicts[0].object, o2);
  EXPECT_EQ(conflicts[0].owner, PeerId{6});
}

TEST_F(Keeping, AnOwnObjectIsLostToALowerIdAlone) {
  found();
  member_owns(7, {o0});
  EXPECT_TRUE(p.own.contains(o0));
  member_owns(3, {o0});
  EXPECT_FALSE(p.own.contains(o0));
  EXPECT_EQ(p.owners.of(o0), PeerId{3});
  p.extend_motions(sim(9s));
  EXPECT_TRUE(p.launches.unpublished().empty()) << "its owner launches it";
}

// Bit k of a claim: the k-th object is claimed as the founder of a session.
constexpr std::uint64_t kFirstAsFounder = 1, kSecondAsFounder = 2;

TEST_F(Keeping, WhoHasAnObjectAsFounderGivesWayToWhoOwnsItAnyway) {
  found();
  add_member(p.members, 3, host(1s));
  add_member(p.members, 7, host(1s));
  add_member(p.members, 8, host(1s));
  keeper.claim(PeerId{3}, std::array{o3, o2}, kSecondAsFounder);
  EXPECT_TRUE(p.owners.as_founder(o2));
  EXPECT_FALSE(p.owners.as_founder(o3));
  keeper.claim(PeerId{8}, std::array{o2, o3}, kFirstAsFounder);
  EXPECT_EQ(p.owners.of(o2), PeerId{3}) << "of two founders the lower id";
  keeper.claim(PeerId{8}, std::array{o2, o3});
  EXPECT_EQ(p.owners.of(o2), PeerId{8});
  const auto gave_way = drain<FounderGaveWay>(p.outbox);
  ASSERT_EQ(gave_way.size(), 1u);
  EXPECT_EQ(gave_way[0].founder, PeerId{3});
  EXPECT_EQ(gave_way[0].owner, PeerId{8});
  EXPECT_FALSE(p.owners.as_founder(o2));
  EXPECT_EQ(p.owners.of(o3), PeerId{3});
  keeper.claim(PeerId{3}, std::array{o2}, kFirstAsFounder);
  EXPECT_EQ(p.owners.of(o2), PeerId{8}) << "a founder takes nothing, however low its id";
  keeper.claim(PeerId{7}, std::array{o2});
  EXPECT_EQ(p.owners.of(o2), PeerId{7});
}

// An update may come before the introduction that says why.
TEST_F(Keeping, AClaimMayTurnOutToBeAFounders) {
  found();
  member_owns(3, {o2});
  EXPECT_FALSE(p.owners.as_founder(o2));
  keeper.claim(PeerId{3}, std::array{o2}, kFirstAsFounder);
  EXPECT_TRUE(p.owners.as_founder(o2));
  EXPECT_TRUE(drain<OwnershipConflict>(p.outbox).empty());
  member_owns(7, {o2});
  EXPECT_EQ(p.owners.of(o2), PeerId{7});
}

class Founding : public testing::Test {
 protected:
  static PeerConfig make(const World& world) {
    PeerConfig c = config(5, {{world["O0"]}});
    c.owned_by_founder = {{world["O1"]}, {world["O2"], true}};
    return c;
  }
  World world{field(4)};
  ObjectId o0 = world["O0"], o1 = world["O1"], o2 = world["O2"];
  PeerParts p{make(world), *world.model};
  SceneKeeper scene{p};
  SessionKeeper keeper{p, scene};
};

TEST_F(Founding, ThePeerThatFoundsOwnsWhatTheFileGivesToTheFounder) {
  for (Duration t = 0s; t < 1s; t += 100ms) (void)keeper.maintain(host(t));
  EXPECT_EQ(p.owners.of(o1), kNobody) << "nobody has founded a session yet";
  (void)keeper.maintain(host(1s));
  ASSERT_TRUE(p.replica.begun());
  EXPECT_EQ(p.owners.of(o1), PeerId{5});
  EXPECT_TRUE(p.owners.as_founder(o1));
  EXPECT_FALSE(p.owners.as_founder(o0));
  EXPECT_TRUE(p.own.at(o2).driven);
  EXPECT_FALSE(p.own.at(o1).driven);
  add_member(p.members, 9, host(1s));
  keeper.claim(PeerId{9}, std::array{o0, o1});
  EXPECT_EQ(p.owners.of(o0), PeerId{5});
  EXPECT_EQ(p.owners.of(o1), PeerId{9});
  EXPECT_FALSE(p.own.contains(o1));
  EXPECT_TRUE(p.own.contains(o2));
}

TEST_F(Keeping, ClaimsOfWhatIsNotThereAreCounted) {
  found();
  member_owns(7, {ObjectId{9999}, o2});
  EXPECT_EQ(p.counters.drops["object"], 1u);
  EXPECT_EQ(p.members.find(PeerId{7})->drops["object"], 1u);
  EXPECT_EQ(p.owners.of(o2), PeerId{7});
}

TEST_F(Keeping, WhatALostPeerOwnedStandsStillAndIsNobodys) {
  found();
  member_owns(7, {o2});
  p.replica.set_ghost(o2, sim(1s), moving({6, 0, 0}, {1, 0, 0}), false);
  p.own.at(o1).delivery.acknowledged_by.insert(PeerId{7});
  Member member = *p.members.remove(PeerId{7});
  member.name = "seven";
  keeper.lose(PeerId{7}, member, host(3s), true);
  EXPECT_EQ(p.owners.of(o2), kNobody);
  EXPECT_EQ(p.replica.ghost(o2, sim(9s)).position, Vec3(8, 0, 0));
  EXPECT_FALSE(p.own.at(o1).delivery.acknowledged_by.contains(PeerId{7}));
  std::vector<ObjectOrphaned> orphaned;
  std::vector<PeerLost> lost;
  while (const auto out = p.outbox.poll()) {
    if (const auto* o = std::get_if<ObjectOrphaned>(&*out)) orphaned.push_back(*o);
    if (const auto* l = std::get_if<PeerLost>(&*out)) lost.push_back(*l);
  }
  ASSERT_EQ(orphaned.size(), 1u);
  EXPECT_EQ(orphaned[0].object, o2);
  EXPECT_EQ(orphaned[0].owner, PeerId{7});
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].name, "seven");
  EXPECT_TRUE(lost[0].left_gracefully);
}

TEST_F(Keeping, ASilentPeerIsLost) {
  found();
  member_owns(7, {o2}, host(1s));
  const HostTime expiry = host(1s) + p.config.lost_after;
  EXPECT_TRUE(keeper.maintain(expiry - 1ns));
  EXPECT_TRUE(p.members.contains(PeerId{7}));
  EXPECT_TRUE(keeper.maintain(expiry));
  EXPECT_FALSE(p.members.contains(PeerId{7}));
  const auto lost = drain<PeerLost>(p.outbox);
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_FALSE(lost[0].left_gracefully);
}

TEST_F(Keeping, AloneItGoesOnFromWhereItWasAfterASuspension) {
  found();
  p.own.at(o1).last_sent = sim(1s);
  p.replica.truth().set_base(o1, sim(1s), moving({3, 0, 0}, {0, 1, 0}));
  EXPECT_FALSE(keeper.maintain(host(11s)));
  const auto suspended = drain<HostSuspended>(p.outbox);
  ASSERT_EQ(suspended.size(), 1u);
  EXPECT_EQ(suspended[0].gap, 10s);
  EXPECT_EQ(p.counters.ticks_missed, 600u);
  EXPECT_EQ(p.replica.truth(o1, sim(11s)).position, Vec3(3, 0, 0)) << "it stood still for everybody else";
  EXPECT_EQ(p.ticks.last_time(), sim(11s));
  EXPECT_FALSE(p.own.at(o1).last_sent) << "it is published anew";
  p.extend_motions(sim(13s) - 1ns);
  EXPECT_TRUE(p.launches.unpublished().empty()) << "the launch waits for as long";
  p.extend_motions(sim(13s));
  EXPECT_EQ(p.launches.unpublished().at(o0), sim(13s));
}

// The truth alone knows where an object is that has been launched and not published yet.
TEST(KeepingALaunch, ASuspensionBeforeTheFirstTickDoesNotLoseIt) {
  const World world(box("BALL", "1 1 1", "0 0 0") + box("WALL", "1 1 1", "90 0 0") + interest("BALL", "\"WALL\""));
  PeerConfig c = config(5, {{world["BALL"]}});
  c.owned[0].launch.velocity = Vec3(1, 0, 0);
  PeerParts p(c, *world.model);
  SceneKeeper scene(p);
  SessionKeeper keeper(p, scene);
  for (Duration t = 0s; t <= 1s; t += 100ms) (void)keeper.maintain(host(t));
  ASSERT_TRUE(p.replica.begun());
  EXPECT_EQ(p.replica.truth().at(world["BALL"], sim(1s)).velocity, Vec3(1, 0, 0));
  EXPECT_FALSE(keeper.maintain(host(11s)));
  ASSERT_EQ(drain<HostSuspended>(p.outbox).size(), 1u);
  EXPECT_EQ(p.replica.truth().at(world["BALL"], sim(11s)).velocity, Vec3(1, 0, 0));
}

TEST_F(Keeping, AmongOthersASuspensionIsReportedAndTheyAreNotBlamed) {
  found();
  member_owns(7, {o2}, host(1s));
  EXPECT_FALSE(keeper.check_suspension(host(1s) + SessionTime::kSuspendedAfter));
  p.members.find(PeerId{7})->last_received = host(5s);
  EXPECT_TRUE(keeper.check_suspension(host(15s)));
  EXPECT_TRUE(p.members.contains(PeerId{7}));
  EXPECT_EQ(drain<HostSuspended>(p.outbox).at(0).gap, 10s);
  EXPECT_EQ(p.counters.ticks_missed, 600u);
  EXPECT_TRUE(p.greeter.is_due(host(15s)));
}

// The kernel keeps the first datagrams of a long stop. They are read first, and session time goes on by them; ticks do
// not.
TEST_F(Keeping, AStopIsOneWhateverTheKernelHasKeptOfIt) {
  found();
  member_owns(7, {o2}, host(1s));
  const SimTime ticked = p.ticks.last_time();
  for (Duration t = 4s; t <= 13s; t += 3s) {
    EXPECT_FALSE(keeper.check_suspension(host(t)));
    p.members.find(PeerId{7})->last_received = host(t);
  }
  EXPECT_TRUE(keeper.check_suspension(host(601s)));
  (void)keeper.maintain(host(601s));
  (void)keeper.maintain(host(601s));
  const auto suspended = drain<HostSuspended>(p.outbox);
  ASSERT_EQ(suspended.size(), 1u);
  EXPECT_EQ(suspended[0].gap, sim(601s) - ticked);
}

}  // namespace peerd::replication::session_keeper_test
