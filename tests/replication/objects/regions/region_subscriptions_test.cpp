#include "replication/objects/regions/region_subscriptions.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "replication/peer/peer_parts.hpp"
#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::region_subscriptions_test {

using namespace test;

// Cells of 100 m along x: region 1 is [0, 100), 2 is [100, 200), .. 8 is [-100, 0).
RegionSettings cut() {
  RegionSettings r;
  r.cell_m = 100.0;
  r.regions = {8, 1, 1};
  r.hysteresis = {0.5, 500ms};
  r.fastest_m_s = 5.0;
  r.lookahead = 1s;
  return r;
}

PeerConfig cutting(PeerConfig c) {
  c.regions = cut();
  return c;
}

// Cubes of 1 m: MINE is this peer's and may meet FAST; FAST and FAR are peer 2's.
struct Subscribing {
  explicit Subscribing(const RegionSettings& settings = cut()) {
    conf.regions = settings;
    conf.interest_radius_m = 0.0;
    conf.policy.close_proximity_s = 0.5;
    owners.set(mine, PeerId{1});
    for (const ObjectId object : {fast, far}) owners.set(object, PeerId{2});
    add_member(members, 2);
    replica.begin(sim(0s));
    replica.truth().declare(mine, Role::kDriven);
    for (const ObjectId object : {fast, far}) replica.declare_remote(object, Role::kPredicted);
    tick_to(0s);
  }
  // One tick in 100 ms.
  void tick_to(Duration t) { ticks.set_last(ticks.number_at(sim(t))); }
  void place(double x, double v = 0.0) { replica.truth().set_base(mine, sim(0s), moving({x, 0, 0}, {0, 0, v})); }
  RegionSubscriptions& part() {
    if (!regions) {
      regions.emplace(conf, *world.in_force, members, owners, own, replica, ticks, outbox, counters,
                      [this](ObjectId object, bool received) { changes.emplace_back(object, received); });
    }
    return *regions;
  }
  std::set<RegionId> joined() {
    std::set<RegionId> all;
    for (const auto& [region, since] : part().interest().regions()) all.insert(region);
    return all;
  }
  bool accept(ObjectId object, double x, SimTime at = sim(0s)) {
    return part().accept({object, 0, at, moving({x, 0, 0})}, at);
  }
  // This peer publishes MINE at x.
  void publish(double x, SimTime at, bool receiver_may_hold_nothing = false) {
    OwnObject& object = own.at(mine);
    object.last_sent = at;
    part().on_published(object, {mine, ++object.sequence, at, moving({x, 0, 0})}, receiver_may_hold_nothing);
  }

  World world{box("MINE", "1 1 1", "50 0 0") + box("FAST", "1 1 1", "150 0 0") + box("FAR", "1 1 1", "350 0 0") +
              interest("MINE", "\"FAST\"")};
  ObjectId mine = world["MINE"], fast = world["FAST"], far = world["FAR"];
  PeerConfig conf = config(1, {{mine, true}});
  PeerCounters counters;
  Membership members{conf.lost_after};
  Owners owners;
  OwnObjects own{*world.in_force, conf.owned, false};
  Replica replica{*world.in_force};
  TickGrid ticks{10};
  Outbox outbox{conf.id, conf.incarnation, counters};
  std::vector<std::pair<ObjectId, bool>> changes;
  std::optional<RegionSubscriptions> regions;
};

// ---- the regions that this peer listens to ----

struct ContactRangeCase {
  const char* name;
  bool track_proximity;
  double own_m_s, fastest_m_s;
  double ahead_s;  // in which both come towards each other
};
class ContactRange : public testing::TestWithParam<ContactRangeCase> {};
// The peer joins a region when an object that comes out of it could touch the own object, or come into its close
// proximity where that is tracked, before the states from there have come.
TEST_P(ContactRange, IsAsFarAsBothComeInTimeAndASubscriptionTakes) {
  const ContactRangeCase& c = GetParam();
  const double touch_m = 2.0 * std::sqrt(0.75), margin_m = 0.5;
  const double range_m = touch_m + (c.own_m_s + c.fastest_m_s) * c.ahead_s + margin_m;
  for (const bool beyond : {true, false}) {
    RegionSettings settings = cut();
    settings.fastest_m_s = c.fastest_m_s;
    Subscribing s(settings);
    s.conf.policy.track_proximity = c.track_proximity;
    s.place(100.0 - range_m + (beyond ? -1e-6 : 1e-6), c.own_m_s);
    s.part().measure_contact_ranges(PairNumbers(std::vector{0u}), true);
    s.part().follow_interest(sim(0s), sim(0s));
    EXPECT_EQ(s.joined().contains(RegionId{2}), !beyond);
    EXPECT_TRUE(s.joined().contains(RegionId{1}));
  }
}
INSTANTIATE_TEST_SUITE_P(Table, ContactRange,
                         testing::Values(ContactRangeCase{"TrackedBothMove", true, 3.0, 5.0, 1.5},
                                         ContactRangeCase{"UntrackedBothMove", false, 3.0, 5.0, 1.0},
                                         ContactRangeCase{"TrackedOwnStands", true, 0.0, 5.0, 1.5},
                                         ContactRangeCase{"UntrackedOwnStands", false, 0.0, 5.0, 1.0},
                                         ContactRangeCase{"TrackedFasterRemote", true, 0.0, 20.0, 1.5},
                                         ContactRangeCase{"UntrackedFasterRemote", false, 0.0, 20.0, 1.0}),
                         [](const auto& c) { return std::string(c.param.name); });

// The way of the question and of the answer, and three ticks.
TEST(RegionSubscriptions, WithoutALookaheadAPeerLooksAsFarAheadAsAnAnswerTakes) {
  for (const bool beyond : {true, false}) {
    RegionSettings settings = cut();
    settings.lookahead.reset();
    Subscribing s(settings);
    s.conf.tick_hz = 10;
    s.conf.policy.track_proximity = false;
    const double ahead_s = 2.0 * to_seconds(s.members.longest_latency()) + 0.3;
    const double range_m = 2.0 * std::sqrt(0.75) + (3.0 + 5.0) * ahead_s + 0.5;
    s.place(100.0 - range_m + (beyond ? -1e-6 : 1e-6), 3.0);
    s.part().measure_contact_ranges(PairNumbers(std::vector{0u}), true);
    s.part().follow_interest(sim(0s), sim(0s));
    EXPECT_EQ(s.joined().contains(RegionId{2}), !beyond);
  }
}

TEST(RegionSubscriptions, OnlyPairsOfTwoOwnersAskForReach) {
  Subscribing s;
  s.part().measure_contact_ranges(PairNumbers(std::vector{0u}), true);
  ASSERT_EQ(s.part().contact_areas(sim(0s), 0.0).size(), 1u);
  EXPECT_NEAR(s.part().contact_areas(sim(0s), 0.0).front().radius_m, 2.0 * std::sqrt(0.75), 1e-12);
  s.owners.set(s.fast, kNobody);
  s.part().measure_contact_ranges(PairNumbers(std::vector{0u}), false);
  EXPECT_FALSE(s.part().contact_areas(sim(0s), 0.0).empty()) << "the others' still count";
  s.part().measure_contact_ranges(PairNumbers(std::vector{0u}), true);
  EXPECT_TRUE(s.part().contact_areas(sim(0s), 0.0).empty());
}

// ARM is this peer's, OTHER peer 2's.
struct Reaching {
  Reaching(const std::string& text, int type, const std::vector<const char*>& owned)
      : world(text + interest("ARM", "\"OTHER\"", type), owned) {
    p.owners.set(world["OTHER"], PeerId{2});
    p.replica.begin(sim(0s));
    p.replica.set_world_zero(sim(0s), sim(0s));
    p.regions.measure_contact_ranges(PairNumbers(std::vector{0u}), true);
  }
  [[nodiscard]] std::vector<Area> areas(double ahead_s = 0.0) const {
    return p.regions.contact_areas(sim(0s), ahead_s);
  }

  World world;
  PeerParts p{cutting(config(1, {{world["ARM"], true}})), *world.model};
};
const double kCube_m = std::sqrt(0.75);

TEST(ContactRangeOfParts, IsAroundTheOwnPart) {
  const Reaching r(arm() + box("OTHER", "1 1 1", "0 0 0"), 1, {"ARM", "ARM/HAND", "OTHER"});
  const auto areas = r.areas();
  ASSERT_EQ(areas.size(), 1u);
  EXPECT_EQ(areas[0].center, Vec3(20, 0, 0));
  EXPECT_NEAR(areas[0].radius_m, 2 * kCube_m, 1e-9);
}

// Remote objects are published where their origins are.
TEST(ContactRangeOfParts, IsAsFarAsTheOtherPartIsFromItsObject) {
  Reaching r(box("ARM", "1 1 1", "0 0 0") + arm("OTHER", "TIP"), 1, {"ARM", "OTHER", "OTHER/TIP"});
  ASSERT_EQ(r.areas().size(), 1u);
  EXPECT_NEAR(r.areas()[0].radius_m, 20 + 2 * kCube_m, 1e-9);
  r.p.replica.ghosts().set_base(r.world["TIP"], sim(0s), moving({30, 0, 0}, {2, 0, 0}));
  EXPECT_NEAR(r.areas()[0].radius_m, 30 + 2 * kCube_m, 1e-9);
  const double fastest = r.p.config.regions.fastest_m_s;
  EXPECT_NEAR(r.areas(1.5)[0].radius_m, 30 + 2 * kCube_m + (2 + fastest) * 1.5, 1e-9);
}

// World boxes touch where their corners do.
TEST(ContactRangeOfParts, OfBoxesIsThatOfWholeEnds) {
  const Reaching one(box("ARM", "1 1 1", "0 0 0") + box("OTHER", "1 1 1", "9 0 0"), 0, {"ARM", "OTHER"});
  EXPECT_NEAR(one.areas().at(0).radius_m, std::sqrt(3.0) * 2 * kCube_m, 1e-9);
  const Reaching two(arm() + box("OTHER", "1 1 1", "9 0 0"), 0, {"ARM", "ARM/HAND", "OTHER"});
  EXPECT_EQ(two.areas().at(0).center, Vec3(0, 0, 0));
  EXPECT_NEAR(two.areas()[0].radius_m, std::sqrt(3.0) * (20 + 2 * kCube_m), 1e-9);
}

// The hand is this peer's, and what carries it peer 2's: its region is joined, too, 30 m away behind a border.
TEST(ContactRangeOfParts, WhatCarriesAnOwnObjectIsListenedTo) {
  const World world(arm("OTHER", "HAND") + box("X", "1 1 1", "500 0 0") + interest("HAND", "\"X\""),
                    {"OTHER", "OTHER/HAND"});
  PeerConfig conf = cutting(config(1, {{world["HAND"], true}}));
  conf.interest_radius_m = 0.0;
  PeerParts p{conf, *world.model};
  p.owners.set(world["OTHER"], PeerId{2});
  p.replica.begin(sim(0s));
  p.replica.truth().set_base(world["OTHER"], sim(0s), moving({90, 0, 0}));
  p.regions.follow_interest(sim(0s), sim(0s));
  EXPECT_TRUE(p.regions.interest().joined(RegionId{2})) << "where the hand is";
  EXPECT_TRUE(p.regions.interest().joined(RegionId{1})) << "where its carrier is";
}

TEST(RegionSubscriptions, ListensAroundItsOwnObjectsOrItsViewpoint) {
  Subscribing s;
  s.place(50);
  s.conf.interest_radius_m = 60.0;
  s.part().follow_interest(sim(0s), sim(0s));
  EXPECT_EQ(s.joined(), (std::set{RegionId{1}, RegionId{2}, RegionId{8}}));
  Subscribing looking;
  looking.place(50);
  looking.conf.interest_radius_m = 10.0;
  looking.conf.decisions.viewpoint.emplace().pose.position = {350, 0, 0};
  looking.part().follow_interest(sim(0s), sim(0s));
  EXPECT_EQ(looking.joined(), std::set{RegionId{4}});
}

TEST(RegionSubscriptions, AViewpointOnAnObjectMovesWithIt) {
  Subscribing s;
  s.place(350, 20.0);
  s.conf.interest_radius_m = 25.0;
  s.conf.decisions.viewpoint.emplace().object = s.mine;
  s.conf.decisions.viewpoint->pose.position = {10, 0, 0};
  s.part().follow_interest(sim(0s), sim(0s));  // 40 m to the border; 25 and 20 m of reach, and half a metre
  EXPECT_EQ(s.joined(), (std::set{RegionId{4}, RegionId{5}}));
}

TEST(RegionSubscriptions, WithoutARadiusOrAsTheServerItListensEverywhere) {
  for (const bool server : {false, true}) {
    Subscribing s;
    if (server) {
      s.conf.decisions.policy = DecisionPolicy::kServer;
      s.conf.decisions.server = PeerId{1};
    } else {
      s.conf.interest_radius_m.reset();
    }
    s.part().follow_interest(sim(0s), sim(0s));
    EXPECT_EQ(s.joined().size(), 8u);
    EXPECT_EQ(drain<Join>(s.outbox).size(), 8u);
    EXPECT_EQ(s.counters.regions_joined, 8u);
  }
}

TEST(RegionSubscriptions, AWholeSceneNeedsNone) {
  Subscribing s{RegionSettings{}};
  s.part().follow_interest(sim(0s), sim(0s));
  EXPECT_TRUE(s.joined().empty());
  EXPECT_FALSE(s.part().cuts());
  EXPECT_TRUE(s.accept(s.far, 350));
  s.publish(50, sim(0s));
  EXPECT_FALSE(s.part().has_left_region(s.own.at(s.mine), {350, 0, 0}));
}

// ---- subscriptions ----

// The link has no loss. There is one copy, and there are two repetitions; each travels with a datagram that leaves
// anyway from 100 ms on, or by itself after a hello's usual period of 250 ms.
TEST(RegionSubscriptions, ASubscriptionIsSentOnceAndRepeatedTwice) {
  Subscribing s;
  echo_us(*s.members.find(PeerId{2}), 0.001);
  s.place(50);
  s.part().follow_interest(sim(0s), sim(20ms));
  const std::vector<Subscription> first = s.part().take(10, false);
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].region, RegionId{1});
  EXPECT_EQ(first[0].since, sim(20ms)) << "the time of the call";
  EXPECT_TRUE(s.part().take(10, true).empty()) << "not twice in a tick";
  s.tick_to(200ms);
  EXPECT_TRUE(s.part().take(10, false).empty());
  EXPECT_EQ(s.part().take(10, true).size(), 1u);
  s.tick_to(400ms);
  EXPECT_TRUE(s.part().take(10, false).empty());
  s.tick_to(500ms);
  EXPECT_EQ(s.part().take(10, false).size(), 1u);
  s.tick_to(9s);
  EXPECT_TRUE(s.part().take(10, true).empty()) << "that is all";
}

TEST(RegionSubscriptions, WhereDatagramsGetLostTheNextTickRepeatsASubscription) {
  Subscribing s;
  echo_us(*s.members.find(PeerId{2}), 0.1);
  s.place(50);
  s.part().follow_interest(sim(0s), sim(0s));
  EXPECT_EQ(s.part().take(10, false).size(), 1u);
  EXPECT_TRUE(s.part().take(10, false).empty()) << "copies are a tick apart";
  s.tick_to(100ms);
  EXPECT_EQ(s.part().take(10, false).size(), 1u);
}

TEST(RegionSubscriptions, TakesNoMoreThanThereIsRoomForAndAnnouncesTheRest) {
  Subscribing s;
  s.conf.interest_radius_m.reset();
  s.part().follow_interest(sim(0s), sim(0s));
  EXPECT_EQ(s.part().take(3, true).size(), 3u);
  (void)drain<Join>(s.outbox);
  s.part().announce();
  const auto messages = drain_messages(s.outbox, sim(0s));
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].first, kWholeScene);
  EXPECT_EQ(messages[0].second.subscriptions.size(), 5u);
  s.part().announce();
  EXPECT_TRUE(drain<Send>(s.outbox).empty());
}

TEST(RegionSubscriptions, ALeftRegionIsNotAskedForAndItsObjectsAreNotReceived) {
  Subscribing s;
  s.place(50);
  s.part().follow_interest(sim(0s), sim(0s));
  ASSERT_TRUE(s.accept(s.far, 60));
  s.place(550);
  s.part().follow_interest(sim(1s), sim(1s));
  EXPECT_EQ(s.joined(), std::set{RegionId{6}});
  EXPECT_EQ(drain<Leave>(s.outbox).at(0).region, RegionId{1});
  EXPECT_EQ(s.counters.regions_left, 1u);
  EXPECT_FALSE(s.replica.receives(s.far));
  EXPECT_EQ(s.counters.sights_lost, 1u);
  const auto due = s.part().take(10, true);
  ASSERT_EQ(due.size(), 1u);
  EXPECT_EQ(due[0].region, RegionId{6});
}

// ---- the objects that this peer receives ----

TEST(RegionSubscriptions, ReceivesWhatIsInItsRegions) {
  Subscribing s;
  s.place(50);
  s.part().follow_interest(sim(0s), sim(0s));
  s.part().on_claimed(s.far, sim(0s));
  EXPECT_FALSE(s.replica.receives(s.far)) << "nobody here knows where it is";
  EXPECT_FALSE(s.accept(s.far, 350));
  EXPECT_TRUE(s.changes.empty());
  EXPECT_TRUE(s.accept(s.far, 60));
  EXPECT_TRUE(s.replica.receives(s.far));
  EXPECT_EQ(s.part().region_of(s.far), RegionId{1});
  EXPECT_FALSE(s.accept(s.far, 350)) << "it has gone";
  EXPECT_FALSE(s.replica.receives(s.far));
  EXPECT_EQ(s.part().region_of(s.far), kWholeScene);
  EXPECT_EQ(s.changes, (std::vector<std::pair<ObjectId, bool>>{{s.far, true}, {s.far, false}}));
}

TEST(RegionSubscriptions, AnUpdateOfTheLastOwnerIsNoneOfTheNewOnes) {
  Subscribing s;
  s.place(50);
  s.part().follow_interest(sim(0s), sim(0s));
  ASSERT_TRUE(s.accept(s.far, 60));
  s.part().on_claimed(s.far, sim(0s));
  EXPECT_FALSE(s.replica.receives(s.far));
  EXPECT_TRUE(s.accept(s.far, 60));
  EXPECT_TRUE(s.replica.receives(s.far));
}

TEST(RegionSubscriptions, AStepOfSessionTimeEndsWhatIsReceived) {
  Subscribing s;
  s.place(50);
  s.part().follow_interest(sim(0s), sim(0s));
  ASSERT_TRUE(s.accept(s.far, 60));
  s.part().restart_at(sim(100s));
  EXPECT_FALSE(s.replica.receives(s.far));
  EXPECT_TRUE(s.part().take(10, true).empty());
  EXPECT_EQ(s.part().interest().regions().at(RegionId{1}), sim(100s));
}

TEST(RegionSubscriptions, AHandoverByItsOwnerEndsReceptionUnlessItsRegionIsJoined) {
  Subscribing s;
  s.conf.interest_radius_m = 60.0;
  s.place(50);
  s.part().follow_interest(sim(0s), sim(0s));  // 8, 1 and 2
  ASSERT_TRUE(s.accept(s.far, 60));
  s.members.find(PeerId{2})->last_sequence[s.far] = 5;
  const auto hand_over = [&](std::uint32_t sender, std::uint32_t sequence, std::uint32_t to) {
    s.part().on_handovers(PeerId{sender}, std::vector{Handover{s.far, sequence, RegionId{to}}}, sim(0s));
  };
  add_member(s.members, 3);
  hand_over(3, 6, 4);
  EXPECT_TRUE(s.replica.receives(s.far));
  EXPECT_EQ(s.counters.drops["not_owner"], 1u);
  hand_over(2, 4, 4);
  EXPECT_TRUE(s.replica.receives(s.far)) << "it has come back since";
  hand_over(2, 6, 2);
  EXPECT_TRUE(s.replica.receives(s.far));
  EXPECT_EQ(s.part().region_of(s.far), RegionId{2});
  hand_over(2, 7, 4);
  EXPECT_FALSE(s.replica.receives(s.far));
  EXPECT_EQ(s.members.find(PeerId{2})->last_sequence[s.far], 7u);
}

// The peer asks a silent owner after one and a half time thresholds, and forgets its object when half of one more has
// passed without an answer.
TEST(RegionSubscriptions, SilentObjectsAreAskedForAndThenForgotten) {
  Subscribing s;
  s.place(50);
  s.part().follow_interest(sim(0s), sim(0s));
  (void)s.part().take(10, true);
  s.part().restart_at(sim(0s));  // nothing is pending
  ASSERT_TRUE(s.accept(s.far, 60));
  std::optional<Duration> asked, forgotten;
  for (Duration t = 1s; t <= 15s && !forgotten; t += 1s) {
    s.tick_to(t);
    s.part().follow_interest(sim(t), sim(t));
    if (!asked && !s.part().take(10, true).empty()) asked = t;
    if (!s.replica.receives(s.far)) forgotten = t;
  }
  EXPECT_EQ(asked, 8s) << "after 7.5 s";
  EXPECT_EQ(forgotten, 11s) << "2.5 s later";
}

// It has been handed over while it was asked for.
TEST(RegionSubscriptions, ASilentObjectIsAskedForInItsNewRegionOnceItHasBeenHandedOver) {
  Subscribing s;
  s.conf.interest_radius_m = 60.0;
  s.place(50);
  s.part().follow_interest(sim(0s), sim(0s));  // 8, 1 and 2
  s.part().restart_at(sim(0s));                // nothing is pending
  ASSERT_TRUE(s.accept(s.far, 60));
  const auto asked_at = [&](Duration t) {
    s.tick_to(t);
    s.part().follow_interest(sim(t), sim(t));
    std::set<RegionId> asked;
    for (const Subscription& each : s.part().take(10, true)) asked.insert(each.region);
    return asked;
  };
  EXPECT_EQ(asked_at(8s), std::set{RegionId{1}});
  s.part().on_handovers(PeerId{2}, std::vector{Handover{s.far, 6, RegionId{2}}}, sim(8s));
  EXPECT_TRUE(asked_at(9s).contains(RegionId{2}));
  EXPECT_TRUE(s.replica.receives(s.far));
}

// ---- the regions in which own objects are published ----

TEST(RegionSubscriptions, AnObjectLeavesItsRegionBeyondTheMargin) {
  Subscribing s;
  EXPECT_FALSE(s.part().has_left_region(s.own.at(s.mine), {350, 0, 0})) << "it has not been published";
  s.publish(50, sim(0s));
  EXPECT_EQ(s.part().region_of(s.mine), RegionId{1});
  EXPECT_FALSE(s.part().has_left_region(s.own.at(s.mine), {99, 0, 0}));
  EXPECT_FALSE(s.part().has_left_region(s.own.at(s.mine), {100.5, 0, 0}));
  EXPECT_TRUE(s.part().has_left_region(s.own.at(s.mine), {100.51, 0, 0}));
  EXPECT_TRUE(s.part().has_left_region(s.own.at(s.mine), {-0.51, 0, 0}));
  EXPECT_FALSE(s.part().has_left_region(s.own.at(s.mine), {850, 0, 0})) << "cells eight apart share a region";
}

TEST(RegionSubscriptions, AChangeOfRegionIsHandedOverWhereItWas) {
  Subscribing s;
  const auto nothing_goes = [](RegionId) { return false; };
  s.publish(50, sim(0s));
  EXPECT_FALSE(s.own.at(s.mine).delivery.copy_until_received);
  EXPECT_TRUE(s.part().take_handovers(nothing_goes).empty());
  s.publish(150, sim(0s));
  EXPECT_EQ(s.counters.handovers, 1u);
  EXPECT_TRUE(s.own.at(s.mine).delivery.copy_until_received);
  const auto due = s.part().take_handovers(nothing_goes);
  ASSERT_EQ(due.size(), 1u);
  const Handover& handover = due.at(RegionId{1}).at(0);
  EXPECT_EQ(handover.object, s.mine);
  EXPECT_EQ(handover.sequence, 2u);
  EXPECT_EQ(handover.to, RegionId{2});
  EXPECT_TRUE(s.part().take_handovers(nothing_goes).empty()) << "not twice in a tick";
  s.publish(151, sim(100ms));
  s.tick_to(500ms);
  EXPECT_EQ(s.part().take_handovers(nothing_goes).at(RegionId{1}).at(0).sequence, 2u)
      << "an update in the new region does not cancel it";
  s.publish(150, sim(0s), true);
  EXPECT_TRUE(s.own.at(s.mine).delivery.copy_until_received) << "a receiver may hold nothing";
}

TEST(RegionSubscriptions, AReturnTakesAHandoverBack) {
  Subscribing s;
  for (const double x : {50.0, 150.0, 50.0}) s.publish(x, sim(0s));
  const auto due = s.part().take_handovers([](RegionId) { return true; });
  ASSERT_EQ(due.size(), 1u);
  EXPECT_EQ(due.begin()->first, RegionId{2}) << "the announcement to region 1 would not be true";
  EXPECT_EQ(due.begin()->second.at(0).to, RegionId{1});
}

TEST(RegionSubscriptions, EarlierRegionsLearnTheLatest) {
  Subscribing s;
  for (const double x : {50.0, 150.0, 250.0}) s.publish(x, sim(0s));
  auto due = s.part().take_handovers([](RegionId) { return true; });
  ASSERT_EQ(due.size(), 2u);
  for (const std::uint32_t from : {1u, 2u}) EXPECT_EQ(due[RegionId{from}].at(0).to, RegionId{3});
  s.tick_to(1s);
  s.part().forget_handovers_of(s.mine);
  EXPECT_TRUE(s.part().take_handovers([](RegionId) { return true; }).empty());
}

// ---- where a message for all goes in a large session ----

struct InALargeSession : Subscribing {
  InALargeSession() {
    members = Membership(conf.lost_after, LargeSession{.above = 1});
    add_member(members, 2);
    EXPECT_TRUE(members.follow_size(true));
    place(50);
    part().follow_interest(sim(0s), sim(0s));
    part().measure_contact_ranges(PairNumbers(std::vector{0u}), true);
  }
  // The regions that the message goes to, in datagrams of one number.
  std::vector<std::uint32_t> regions_of(Message m) {
    while (outbox.poll()) {
    }
    const auto number = part().send_to_peers(m);
    std::vector<std::uint32_t> all;
    while (const auto output = outbox.poll()) {
      if (const auto* sent = std::get_if<Send>(&*output)) all.push_back(sent->region.value);
    }
    EXPECT_EQ(number.has_value(), !all.empty());
    EXPECT_TRUE(all.empty() || (m.nearby && number == m.number));
    return all;
  }
  Message decision() {
    Message m = outbox.blank();
    m.decisions.push_back({});
    m.decisions[0].collider = mine;
    m.decisions[0].collidee = fast;
    return m;
  }
};
using Regions = std::vector<std::uint32_t>;

TEST(RegionSubscriptions, AMessageForAllGoesWhereItsSenderPublishes) {
  InALargeSession s;
  s.publish(250, sim(0s));
  EXPECT_EQ(s.regions_of(s.outbox.blank()), (Regions{3}));
  Message asks = s.outbox.blank();
  asks.subscriptions = {{RegionId{7}, sim(0s)}};
  EXPECT_EQ(s.regions_of(asks), (Regions{3, 7})) << "owners listen where they publish";
}

// A bystander that listens where one of the two objects is need not listen where the decider publishes.
TEST(RegionSubscriptions, ADecisionGoesWhereItsObjectsAre) {
  InALargeSession s;
  s.publish(250, sim(0s));
  EXPECT_EQ(s.regions_of(s.decision()), (Regions{3})) << "FAST has never been received";
  ASSERT_TRUE(s.accept(s.fast, 60));
  EXPECT_EQ(s.regions_of(s.decision()), (Regions{1, 3}));
}

// A spectator, or a peer that decides for others.
TEST(RegionSubscriptions, WithoutPublishedObjectsItGoesWhereThePeerListens) {
  InALargeSession s;
  ASSERT_EQ(s.joined(), std::set<RegionId>{RegionId{1}});
  EXPECT_EQ(s.regions_of(s.outbox.blank()), (Regions{1}));
  Message hello = s.outbox.blank();
  hello.hello.emplace();
  hello.subscriptions = {{RegionId{7}, sim(0s)}};
  EXPECT_EQ(s.regions_of(hello), (Regions{7})) << "it is yet to publish its object";
  s.own.remove(std::vector{s.mine});
  EXPECT_EQ(s.regions_of(hello), (Regions{1, 7})) << "those that are near in region 1 wait for a spectator's hello";
  EXPECT_EQ(s.regions_of(s.decision()), (Regions{1}));
}

TEST(RegionSubscriptions, InASmallSessionItGoesToAll) {
  InALargeSession s;
  EXPECT_TRUE(s.members.follow_size(false));
  Message m = s.outbox.blank();
  EXPECT_TRUE(s.part().send_to_peers(m));
  EXPECT_FALSE(m.nearby);
  s.publish(250, sim(0s));
  EXPECT_TRUE(s.part().send_to_peers(m));
  EXPECT_FALSE(m.nearby);
}

TEST(RegionSubscriptions, ASubscriberIsSentWhatWasNotPublishedSince) {
  Subscribing s;
  s.publish(50, sim(10s));
  OwnObject& object = s.own.at(s.mine);
  const auto subscribe = [&](std::uint32_t region, SimTime since, SimTime now = sim(11s)) {
    object.resend = false;
    s.part().on_subscriptions(PeerId{2}, std::vector{Subscription{RegionId{region}, since}}, now);
    return object.resend;
  };
  EXPECT_TRUE(subscribe(1, sim(10s)));
  EXPECT_FALSE(subscribe(1, sim(10s) - 1ns)) << "it has been published since";
  EXPECT_FALSE(subscribe(2, sim(10500ms))) << "it is elsewhere";
  EXPECT_EQ(s.counters.drops["entered_time"], 0u);
  EXPECT_FALSE(subscribe(1, sim(12s) + 1ns)) << "from the future";
  EXPECT_FALSE(subscribe(1, sim(10s) - 1ns, sim(20s))) << "from long ago";
  EXPECT_EQ(s.counters.drops["entered_time"], 2u);
  EXPECT_EQ(s.members.find(PeerId{2})->drops["entered_time"], 2u);
  EXPECT_TRUE(subscribe(1, sim(12s)));
}

}  // namespace peerd::replication::region_subscriptions_test
