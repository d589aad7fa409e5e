// Peers whose scene is cut into regions: who receives which object, when, and what the ghosts are then.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/messages.hpp"

namespace peerd::replication::peer_regions_test {

using namespace test;
using testing::IsEmpty;

// Cells of 10 m along x: region 1 is [0, 10), 2 is [10, 20), .. 8 is [-10, 0).
RegionSettings cut() {
  RegionSettings r;
  r.cell_m = 10.0;
  r.regions = {8, 1, 1};
  r.hysteresis = {0.5, 500ms};
  r.fastest_m_s = 5.0;
  return r;
}

PeerConfig in_regions(std::uint32_t id, std::vector<OwnedObject> owned = {}, std::optional<double> radius_m = {}) {
  PeerConfig c = config(id, std::move(owned));
  c.regions = cut();
  c.interest_radius_m = radius_m;
  return c;
}

// The peer has a viewpoint that stands.
PeerConfig looking_from(PeerConfig c, double x) {
  c.decisions.viewpoint.emplace().pose.position = {x, 0, 0};
  return c;
}

// The motion starts from x at 3 s of the test's time and keeps its speed.
Lan::Motion steady(const Lan& lan, double x, double v) {
  return [&lan, x, v](SimTime t) {
    const double s = to_seconds(t - (lan.session_now(0) - lan.now())) - 3.0;  // time of the test
    return moving({x + v * s, 0, 0}, {v, 0, 0});
  };
}

struct Sent {
  Duration at;
  std::size_t from;
  RegionId region;
  Message message;
};

class Regions : public testing::Test {
 protected:
  Regions() {
    lan.on_send = [this](std::size_t from, RegionId region, const Message& m) {
      sent.push_back({lan.now(), from, region, m});
    };
  }
  // The regions to which the object's updates went since `since`, one entry for each change.
  [[nodiscard]] std::vector<std::uint32_t> sent_in(const char* object, Duration since = 0s) const {
    std::vector<std::uint32_t> regions;
    for (const Sent& s : sent) {
      for (const UpdateRecord& u : s.message.updates) {
        if (s.at < since || u.object != world[object]) continue;
        if (regions.empty() || regions.back() != s.region.value) regions.push_back(s.region.value);
      }
    }
    return regions;
  }
  // Copies of earlier updates do not count.
  [[nodiscard]] std::size_t updates_of(const char* object, Duration since) const {
    std::map<std::uint32_t, Duration> first;
    for (const Sent& s : sent) {
      for (const UpdateRecord& u : s.message.updates) {
        if (u.object == world[object]) first.try_emplace(u.sequence, s.at);
      }
    }
    return static_cast<std::size_t>(std::ranges::count_if(first, [&](const auto& f) { return f.second >= since; }));
  }
  [[nodiscard]] bool holds(std::size_t i, const char* object) const { return lan.peer(i).receives(world[object]); }
  [[nodiscard]] bool right(std::size_t i, const char* object, std::size_t owner) const {
    const SimTime t = lan.session_now(owner);
    return same_bits(lan.peer(i).ghost(world[object], t), lan.peer(owner).ghost(world[object], t));
  }

  // The first peers have A where its owner has left it, at y = 2.
  void expect_one_place(std::size_t peers) const {
    const auto place = [&](std::size_t i) { return lan.peer(i).ghost(world["A"], lan.session_now(i)); };
    EXPECT_EQ(place(0).position.y(), 2.0) << "not where the file has it";
    for (std::size_t i = 1; i < peers; ++i) EXPECT_TRUE(same_bits(place(0), place(i))) << "at peer " << i + 1;
  }

  World world{box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "0 0 5") + box("C", "1 1 1", "0 0 9")};
  Lan lan{world, {.latency = 40ms}};
  std::vector<Sent> sent;
};

TEST_F(Regions, UpdatesGoToTheObjectsRegionAndHellosToEveryone) {
  lan.add(in_regions(1, {{world["A"], true}}), 0s, {{world["A"], steady(lan, -25, 10)}});
  lan.add(in_regions(2));
  lan.run_until(7s);
  EXPECT_EQ(sent_in("A", 3s), (std::vector<std::uint32_t>{7, 8, 1, 2})) << "from -25 to 15 m";
  for (const Sent& s : sent) {
    if (s.message.hello) {
      EXPECT_EQ(s.region, kWholeScene);
    }
  }
  EXPECT_EQ(lan.joined(1).size(), 9u) << "no area of interest: it hears of everything";
}

TEST_F(Regions, AnObjectHandedOverIsDroppedAndReturnsClean) {
  const auto there_and_back = [&](SimTime t) {
    const double s = to_seconds(t - (lan.session_now(0) - lan.now())) - 3.0;
    const double x = s < 3.0 ? 5.0 + 5.0 * s : 20.0 - 5.0 * (s - 3.0);
    return moving({x, 0, 0}, {s < 3.0 ? 5.0 : -5.0, 0, 0});
  };
  lan.add(in_regions(1, {{world["A"], true}}), 0s, {{world["A"], there_and_back}});
  PeerConfig c = looking_from(in_regions(2, {}, 2.0), 5.0);
  c.convergence = {ConvergenceMethod::kLinear, 1s};
  const auto b = lan.add(c);
  const auto shown_x = [&] { return lan.peer(b).shown(world["A"], lan.session_now(b)).position.x(); };
  lan.run_until(3s);
  EXPECT_EQ(lan.joined(b), (std::set<RegionId>{kWholeScene, RegionId{1}}));
  lan.run_until(4100ms);  // 10.5 m at 4.1 s
  EXPECT_TRUE(holds(b, "A")) << "its owner has not said a word yet";
  EXPECT_NEAR(shown_x(), 10.5, 0.1);
  lan.run_until(4100ms + 40ms + 17ms);
  EXPECT_FALSE(holds(b, "A"));
  EXPECT_EQ(lan.peer(b).last_update_of(world["A"]), nullptr);
  EXPECT_EQ(lan.peer(b).counters().sights_lost, 1u);
  lan.run_until(8100ms);  // 9.5 m at 8.1 s
  (void)shown_x();        // means nothing, and must not be where it comes from
  EXPECT_FALSE(holds(b, "A"));
  lan.run_until(8100ms + 40ms + 17ms);
  EXPECT_TRUE(holds(b, "A"));
  EXPECT_EQ(shown_x(), lan.peer(b).ghost(world["A"], lan.session_now(b)).position.x()) << "at once where it is";
  lan.run_until(8500ms);
  EXPECT_TRUE(right(b, "A", 0));
  EXPECT_NEAR(shown_x(), 20.0 - 5.0 * 2.5, 0.05);
}

// The joiner's area comes to resting objects, of which no update is due.
TEST_F(Regions, SubscribersReceiveStatesWithinTwoLatenciesAndTicks) {
  lan.add(in_regions(1, {{world["A"], true}}), 0s, {{world["A"], [](SimTime) { return moving({25, 0, 0}); }}});
  lan.add(in_regions(2, {{world["B"], true}}), 0s, {{world["B"], [](SimTime) { return moving({-5, 0, 0}); }}});
  PeerConfig c = in_regions(3, {{world["C"], true}}, 1.0);
  c.decisions.viewpoint.emplace().object = world["C"];
  const auto visitor = lan.add(c, 0s, {{world["C"], steady(lan, -20, 10)}});
  lan.run_until(5s);
  EXPECT_FALSE(holds(visitor, "A"));
  std::optional<Duration> joined, held;
  for (Duration t = 5s; t < 8s && !held; t += 1ms) {
    lan.run_until(t);
    if (!joined && lan.joined(visitor).contains(RegionId{3})) joined = t;
    if (holds(visitor, "A")) held = t;
  }
  ASSERT_TRUE(joined && held);
  EXPECT_LE(*held - *joined, 2 * 40ms + 2 * 17ms);
  // The limit is 20 m less the radius, the margin and the flight meanwhile: the peer has the state before its area gets
  // there.
  EXPECT_LE(to_seconds(*held - 3s) * 10.0 - 20.0, 19.0);
  EXPECT_TRUE(right(visitor, "A", 0));
  EXPECT_LE(updates_of("A", 5s), 2u) << "the answer, and the time threshold's at most";
  EXPECT_FALSE(holds(visitor, "B"));
}

// A joins at a tick that comes late, so it has missed updates between the tick's time and the joining.
TEST_F(Regions, LateSubscribersReceiveWhatWasPublishedMeanwhile) {
  for (const Duration phase : {1ms, 3ms, 5ms, 7ms}) {
    SCOPED_TRACE(phase.count());
    std::optional<Duration> joins;
    for (const bool late : {false, true}) {
      Lan apart(world, {.latency = 1ms});
      std::optional<SimTime> moves;
      PeerConfig a = in_regions(1, {{world["A"], true}});
      a.tick_hz = 500;
      apart.add(a, 0s, {{world["A"], [&](SimTime t) { return moving({25, 0, moves && t >= *moves ? 3.0 : 0.0}); }}});
      const auto b = apart.add(in_regions(2, {{world["B"], true}}, 1.0), 0s, {{world["B"], steady(apart, -20, 10)}});
      if (!late) {  // when it would join
        while (apart.now() < 9s && !apart.joined(b).contains(RegionId{3})) apart.run_until(apart.now() + 1ms);
        joins = apart.now();
        continue;
      }
      apart.run_until(*joins - 2ms);
      moves = apart.session_now(0) + phase;
      apart.node(b).running = false;
      apart.run_until(*joins + 12ms);
      apart.node(b).running = true;
      apart.run_until(*joins + 112ms);
      ASSERT_TRUE(apart.peer(b).receives(world["A"]));
      EXPECT_NEAR(apart.peer(b).ghost(world["A"], apart.session_now(b)).position.z(), 3.0, 0.01);
    }
  }
}

// The object's updates go to the region of its origin, but the object reaches farther.
TEST_F(Regions, ALongObjectIsReceivedAsFarAsItExtends) {
  const World long_one(box("A", "30 1 1", "0 0 0") + box("B", "1 1 1", "0 0 5"));
  Lan apart(long_one, {.latency = 40ms});
  apart.add(in_regions(1, {{long_one["A"], true}}), 0s, {{long_one["A"], [](SimTime) { return moving({25, 0, 0}); }}});
  apart.add(looking_from(in_regions(2, {}, 1.0), 9.5));  // its end is at 10
  apart.add(looking_from(in_regions(3, {}, 1.0), -15.0));
  apart.run_until(6s);
  EXPECT_TRUE(apart.peer(1).receives(long_one["A"]));
  EXPECT_FALSE(apart.peer(2).receives(long_one["A"]));
}

// region_subscriptions_test asks who may announce a handover.
TEST_F(Regions, AnUpdateThatAHandoverHasOvertakenIsDropped) {
  const auto self = lan.add(looking_from(in_regions(1, {}, 1.0), 5.0));
  lan.run_until(2s);
  lan.inject(self, encode(hello_of(7, lan.host_now(self), {world["A"]})));
  EXPECT_FALSE(holds(self, "A")) << "its owner has not published it";
  Message update = message_of(7);
  update.updates = {{world["A"], 5, lan.session_now(self), moving({5, 0, 0}), {}}};
  lan.inject(self, encode(update), RegionId{1});
  EXPECT_TRUE(holds(self, "A"));
  Message gone = message_of(7);
  gone.handovers = {{world["A"], 6, RegionId{3}}};
  lan.inject(self, encode(gone), RegionId{1});
  EXPECT_FALSE(holds(self, "A"));
  lan.inject(self, encode(update), RegionId{1});
  EXPECT_FALSE(holds(self, "A")) << "overtaken";
  update.updates.front().sequence = 6;
  lan.inject(self, encode(update), RegionId{1});
  EXPECT_TRUE(holds(self, "A")) << "that very update, heard after all";
}

// The owner has no update due for a minute. Far away, the request and its answer take longer than half a threshold and
// a latency.
TEST(RegionsFarAway, OneWhoseOwnerSpeaksSeldomIsAskedForAndMayTakeItsTimeToAnswer) {
  const World world(box("A", "1 1 1", "0 0 0"));
  for (const auto& [latency, threshold] : {std::pair{40ms, 1000ms}, {520ms, 300ms}, {520ms, 800ms}}) {
    Lan lan(world, {.latency = latency});
    PeerConfig a = in_regions(1, {{world["A"], true}});
    PeerConfig b = looking_from(in_regions(2, {}, 2.0), 5.0);
    a.policy.time_threshold = 60s;
    b.policy.time_threshold = threshold;
    lan.add(a, 0s, {{world["A"], [](SimTime) { return moving({5, 0, 0}); }}});
    lan.add(b);
    lan.run_until(6s);
    EXPECT_TRUE(lan.peer(1).receives(world["A"]));
    const std::uint64_t updates = lan.peer(0).counters().updates_out;
    lan.run_until(26s);
    EXPECT_GT(lan.peer(0).counters().updates_out, updates) << "nobody asked";
    EXPECT_LE(lan.peer(0).counters().updates_out, updates + 20s / threshold) << "once in more than a threshold";
    EXPECT_EQ(lan.peer(1).counters().sights_lost, 0u) << to_seconds(threshold);
  }
}

// A hello has room for some of the requests. The others have a datagram of their own.
TEST(RegionsMany, NoHelloTakesMoreThanFit) {
  const World world(box("A", "1 1 1", "0 0 0"));
  Lan lan(world, {.latency = 20ms});
  std::map<RegionId, int> said;
  std::size_t most = 0;
  lan.on_send = [&](std::size_t from, RegionId, const Message& m) {
    if (from != 0) return;
    for (const Subscription& e : m.subscriptions) ++said[e.region];
    if (m.hello) most = std::max(most, m.subscriptions.size());
  };
  for (std::uint32_t id : {1u, 2u}) {
    PeerConfig c = in_regions(id);
    c.regions.regions = {40, 1, 1};
    lan.add(c);
  }
  lan.run_until(8s);
  EXPECT_EQ(most, kSubscriptionsWithHello);
  EXPECT_EQ(said.size(), 40u);
  for (const auto& [region, times] : said) EXPECT_GE(times, 3) << region.value;
}

// The object shakes along the border, not over it, so an update is due every few ticks.
Lan::Motion shaking(const Lan& lan, double x, double v) {
  return [&lan, x, v](SimTime t) {
    const double s = to_seconds(t - (lan.session_now(0) - lan.now())) - 3.0;
    return moving({x + v * s, 0, 0.3 * std::sin(40 * s)}, {v, 0, 12.0 * std::cos(40 * s)});
  };
}

// The object's owner was away, and the object is elsewhere now.
TEST_F(Regions, WhatWentElsewhereInAPartitionIsNotHeld) {
  const auto goes = [&](SimTime t) {
    const double s = to_seconds(t - (lan.session_now(1) - lan.now()));
    const double x = s < 6 ? 5 : s < 8 ? 5 + 20 * (s - 6) : 45;
    return moving({x, 0, 0}, {s < 6 || s > 8 ? 0.0 : 20.0, 0, 0});
  };
  lan.add(looking_from(in_regions(1, {}, 3.0), 5));
  lan.add(looking_from(in_regions(2, {{world["A"], true}}, 3.0), 5), 0s, {{world["A"], goes}});
  lan.run_until(5500ms);
  EXPECT_TRUE(holds(0, "A"));
  lan.part({1});
  lan.run_until(8500ms);
  EXPECT_EQ(lan.peer(0).owner(world["A"]), kNobody);
  EXPECT_TRUE(holds(0, "A")) << "orphaned where it was";
  lan.part({});
  lan.run_until(11s);
  EXPECT_EQ(lan.peer(0).owner(world["A"]), PeerId{2});
  EXPECT_FALSE(holds(0, "A"));
}

TEST_F(Regions, WhatARestartedPeerHasElsewhereIsNotHeld) {
  const auto stands = [](double x) { return [x](SimTime) { return moving({x, 0, 0}); }; };
  lan.add(looking_from(in_regions(1, {{world["A"], true}}, 4.0), 5), 0s, {{world["A"], stands(5)}});
  lan.add(looking_from(in_regions(2, {}, 3.0), 5));
  lan.run_until(5s);
  EXPECT_TRUE(holds(1, "A"));
  PeerConfig again = looking_from(in_regions(1, {{world["A"], true}}, 4.0), 45);
  again.incarnation = 101;
  lan.node(0).motions = {{world["A"], stands(45)}};
  lan.restart(0, again);
  lan.run_until(9s);
  EXPECT_EQ(lan.peer(1).owner(world["A"]), PeerId{1});
  EXPECT_FALSE(holds(1, "A"));
}

TEST_F(Regions, ObjectsHandedOverDuringASuspensionAreDropped) {
  lan.add(looking_from(in_regions(1, {{world["A"], true}, {world["B"], true}}, 4.0), 5), 0s,
          {{world["A"], steady(lan, 5, 4)}, {world["B"], [](SimTime) {
                                               return moving({7, 0, 0});
                                             }}});
  lan.add(looking_from(in_regions(2, {}, 3.0), 5));
  lan.run_until(3500ms);
  EXPECT_TRUE(holds(1, "A"));
  lan.kill(1);
  lan.run_until(9500ms);
  lan.node(1).running = true;
  lan.run_until(11500ms);  // sooner than silence makes it forgotten
  ASSERT_THAT(lan.seen<HostSuspended>(1), testing::SizeIs(1));
  EXPECT_EQ(lan.peer(1).owner(world["A"]), PeerId{1});
  EXPECT_FALSE(holds(1, "A"));
  EXPECT_TRUE(holds(1, "B")) << "it is republished where it has stayed";
}

// The object's owner has left, so nobody could publish it again.
TEST_F(Regions, OrphanedObjectsStayWithAPeerThatLeavesTheirRegion) {
  const auto there_and_back = [&](SimTime t) {
    const double s = to_seconds(t - (lan.session_now(0) - lan.now()));
    const double x = s < 9 ? 5 : s < 13 ? 5 + 10 * (s - 9) : s < 17 ? 45 - 10 * (s - 13) : 5;
    return moving({x, 0, 0}, {s < 9 || s > 17 ? 0.0 : s < 13 ? 10.0 : -10.0, 0, 0});
  };
  lan.add(looking_from(in_regions(1, {}, 3.0), 5));
  const auto visitor = lan.add(in_regions(2, {{world["B"], true}}, 3.0), 0s, {{world["B"], there_and_back}});
  const auto stands = [](double x) { return [x](SimTime) { return moving({x, 0, 0}); }; };
  const auto owner = lan.add(in_regions(3, {{world["A"], true}, {world["C"], true}}, 3.0), 0s,
                             {{world["A"], stands(7)}, {world["C"], stands(65)}});
  lan.run_until(5s);
  EXPECT_TRUE(holds(visitor, "A"));
  EXPECT_FALSE(holds(visitor, "C"));
  lan.kill(owner);
  lan.run_until(13s);
  EXPECT_EQ(lan.peer(visitor).owner(world["A"]), kNobody);
  EXPECT_FALSE(lan.joined(visitor).contains(RegionId{1}));
  lan.run_until(19s);
  EXPECT_TRUE(lan.joined(visitor).contains(RegionId{1}));
  EXPECT_TRUE(holds(visitor, "A"));
  const auto orphaned = lan.seen<ObjectOrphaned>(visitor);
  ASSERT_THAT(orphaned, testing::SizeIs(1)) << "a peer reports no object that it does not receive";
  EXPECT_EQ(orphaned.front().object, world["A"]);
}

// The lowest peer has never received the object.
TEST_F(Regions, APeerThatKnowsSaysWhereALeftObjectStands) {
  const auto swings = [](SimTime t) {
    const double s = to_seconds(t.time_since_epoch());
    return moving({5 + std::sin(s), 2, 0}, {std::cos(s), 0, 0});
  };
  lan.add(looking_from(in_regions(1, {}, 3.0), 45));
  lan.add(looking_from(in_regions(2, {}, 3.0), 5));
  lan.add(looking_from(in_regions(3, {}, 3.0), 5));
  const auto owner = lan.add(in_regions(4, {{world["A"], true}}, 3.0), 0s, {{world["A"], swings}});
  lan.run_until(5s);
  EXPECT_FALSE(holds(0, "A"));
  EXPECT_TRUE(holds(1, "A"));
  EXPECT_TRUE(holds(2, "A"));
  lan.kill(owner);
  lan.run_until(9s);
  expect_one_place(3);
}

// Nobody receives the object any more when its owner goes. One peer has, and says where it saw the object last.
TEST_F(Regions, APeerThatKnewSaysWhereALeftObjectStands) {
  const auto goes = [&](SimTime t) {
    const double s = to_seconds(t - (lan.session_now(0) - lan.now()));
    const double x = s < 6 ? 5 : s < 10 ? 5 + 10 * (s - 6) : 45;
    return moving({x, 2, 0}, {s < 6 || s > 10 ? 0.0 : 10.0, 0, 0});
  };
  lan.add(looking_from(in_regions(1, {}, 3.0), 75));
  lan.add(looking_from(in_regions(2, {}, 3.0), 5));
  lan.add(looking_from(in_regions(3, {}, 3.0), 65));
  const auto owner = lan.add(in_regions(4, {{world["A"], true}}, 3.0), 0s, {{world["A"], goes}});
  lan.run_until(5s);
  EXPECT_TRUE(holds(1, "A"));
  lan.run_until(11s);
  for (const std::size_t i : {0, 1, 2}) EXPECT_FALSE(holds(i, "A"));
  lan.kill(owner);
  lan.run_until(20s);
  expect_one_place(3);
}

// In a large session a peer takes another one for gone that it does not receive any more where it listens. The far
// hellos of the other still come.
TEST_F(Regions, OnlyAnOwnerThatIsGoneLeavesObjectsBehind) {
  const auto in_large = [](PeerConfig c) {
    c.large = {.above = 2};
    return c;
  };
  const auto swings = [](SimTime t) {
    const double s = to_seconds(t.time_since_epoch());
    return moving({5 + std::sin(s), 2, 0}, {std::cos(s), 0, 0});
  };
  lan.add(in_large(looking_from(in_regions(1, {}, 3.0), 45)));
  lan.add(in_large(looking_from(in_regions(2, {}, 3.0), 5)));
  const auto owner = lan.add(in_large(in_regions(3, {{world["A"], true}}, 3.0)), 0s, {{world["A"], swings}});
  lan.run_until(8s);
  EXPECT_TRUE(holds(1, "A"));
  EXPECT_TRUE(lan.peer(1).members().is_large());
  bool is_silent = true;
  lan.filter = [&](std::size_t from, std::size_t to, const Message& m) {
    return !is_silent || from != owner || to != 1 || m.next_hello;
  };
  lan.run_until(24s);
  EXPECT_FALSE(lan.seen<ObjectOrphaned>(1).empty()) << "else this is no test of it";
  EXPECT_EQ(lan.peer(1).owner(world["A"]), PeerId{3});
  EXPECT_FALSE(holds(1, "A"));
  for (const std::size_t i : {0, 1, 2}) EXPECT_TRUE(lan.peer(i).logs().lengths().empty()) << "at peer " << i + 1;
  is_silent = false;
  lan.run_until(28s);
  EXPECT_TRUE(holds(1, "A"));
  lan.kill(owner);
  lan.run_until(40s);
  expect_one_place(2);
}

// A peer that listens to six regions gets six copies of a `nearby` hello. Twenty hellos that echo nobody would make
// their sender unreachable.
TEST_F(Regions, CopiesOfAHelloCountOnce) {
  const auto self = lan.add(in_regions(1));
  lan.run_until(2s);
  Message hello = hello_of(8, lan.host_now(self));
  hello.nearby = true;
  const auto send = [&] {
    ++hello.number;
    for (std::uint32_t region = 1; region <= 6; ++region) lan.inject(self, encode(hello), RegionId{region});
  };
  for (int i = 0; i < 4; ++i) send();
  const Member& member = lan.peer(self).members().all().at(PeerId{8});
  EXPECT_FALSE(member.echo.unreachable);
  EXPECT_EQ(member.received.at(kNearby).duplicates(), 20u);
  for (int i = 0; i < 20; ++i) send();
  EXPECT_TRUE(member.echo.unreachable) << "else this is no test of it";
}

// A carrier and its follower cross a border every 1.4 s. Handovers of them are always under way, and cause no hello.
// They travel with datagrams that leave anyway: hellos, and the follower's updates in the region that the carrier has
// left.
TEST_F(Regions, FrequentBorderCrossingsSendNoExtraHellos) {
  PeerConfig c = in_regions(1, {{world["A"], true}, {world["B"], true}}, 3.0);
  c.decisions.viewpoint.emplace().object = world["A"];
  lan.add(c, 0s, {{world["A"], steady(lan, 0, 7)}, {world["B"], shaking(lan, -6, 7)}});
  lan.add(in_regions(2));
  lan.run_until(10s);
  sent.clear();
  lan.run_until(40s);
  std::size_t hellos = 0, entered = 0, with_hello = 0, gone = 0, with_updates = 0;
  std::map<RegionId, std::vector<Duration>> said;
  for (const Sent& s : sent) {
    if (s.from != 0) continue;
    hellos += s.message.hello.has_value();
    for (const Subscription& e : s.message.subscriptions) said[e.region].push_back(s.at);
    entered += s.message.subscriptions.size();
    with_hello += s.message.hello ? s.message.subscriptions.size() : 0;
    gone += s.message.handovers.size();
    with_updates += s.message.updates.empty() ? 0 : s.message.handovers.size();
  }
  EXPECT_LE(hellos, 32u) << "once a second";
  EXPECT_GE(entered, 60u) << "21 regions, three times each";
  EXPECT_GE(gone, 80u) << "two objects, twice each";
  EXPECT_GE(with_hello, 3u);
  EXPECT_GE(with_updates, gone / 4) << "the first one's second words";
  for (const auto& [region, at] : said) {
    for (std::size_t i = 1; i < at.size(); ++i) {
      EXPECT_GE(at[i] - at[i - 1], 99ms) << region.value << ": one burst would lose both";
    }
  }
}

TEST_F(Regions, LeavingIsNoLoss) {
  lan.add(in_regions(1, {{world["A"], true}, {world["B"], true}}), 0s,
          {{world["A"], steady(lan, 5, 3)},
           {world["B"], [](SimTime t) {
              const double s = to_seconds(t.time_since_epoch() % std::chrono::seconds(1000));
              return moving({25.0 + std::sin(3.0 * s), 0, 0}, {3.0 * std::cos(3.0 * s), 0, 0});
            }}});
  PeerConfig c = in_regions(2, {{world["C"], true}}, 1.0);
  c.decisions.viewpoint.emplace().object = world["C"];
  lan.add(c, 0s, {{world["C"], [](SimTime t) {
                     const double s = to_seconds(t.time_since_epoch() % std::chrono::seconds(1000));
                     return moving({15.0 + 14.0 * std::sin(0.8 * s), 0, 0}, {11.2 * std::cos(0.8 * s), 0, 0});
                   }}});
  lan.run_until(25s);
  EXPECT_GT(lan.peer(1).counters().regions_left, 5u);
  const Member& sender = lan.peer(1).members().all().at(PeerId{1});
  EXPECT_LT(sender.received_in_all().loss(), 0.006);
}

// By hellos alone the judgement would take 20 s.
TEST_F(Regions, AFarPeerJudgesALinkByTheOthersToo) {
  const auto fast = [](double x, double w) {
    return [x, w](SimTime t) {
      const double s = to_seconds(t.time_since_epoch() % std::chrono::seconds(1000));
      return moving({x + 2.0 * std::sin(w * s), 0, 0}, {2.0 * w * std::cos(w * s), 0, 0});
    };
  };
  lan.add(in_regions(1, {{world["A"], true}}), 0s, {{world["A"], fast(5, 5)}});
  lan.add(in_regions(2, {{world["B"], true}}), 0s, {{world["B"], fast(45, 6)}});
  lan.add(looking_from(in_regions(3, {}, 2.0), 45.0));
  lan.run_until(10s);
  EXPECT_FALSE(holds(2, "A"));
  EXPECT_LT(lan.peer(0).members().all().at(PeerId{3}).echo.loss_to_peer.value(), 0.006);
}

TEST(RegionsInLoss, UpdatesThatReceiversDependOnAreCopiedMoreOften) {
  const World world(box("A", "1 1 1", "0 0 0"));
  Lan lan(world, {.latency = 20ms, .loss = 0.1});
  lan.add(in_regions(1, {{world["A"], true}}), 0s, {{world["A"], steady(lan, 5, 12)}});
  lan.add(in_regions(2));
  std::map<std::uint32_t, int> sends, gone;  // by sequence number
  lan.on_send = [&](std::size_t, RegionId, const Message& m) {
    if (lan.now() < 4s) return;
    for (const UpdateRecord& u : m.updates) ++sends[u.sequence];
    for (const Handover& g : m.handovers) ++gone[g.sequence];
  };
  lan.run_until(9s);
  ASSERT_GE(gone.size(), 4u);
  for (const auto& [sequence, times] : gone) {
    EXPECT_GE(times, 3) << sequence;
    EXPECT_GE(sends[sequence], 3) << sequence;
  }
}

// The copies are sent whatever else makes an update due; here the error does.
TEST(RegionsInLoss, StatesForAJoiningPeerAreCopiedMoreOften) {
  const World world(box("A", "1 1 1", "0 0 0"));
  Lan lan(world, {.latency = 20ms, .loss = 0.1});
  bool jumped = false;
  const auto jumps = [&](SimTime) { return moving({jumped ? 6.0 : 5.0, 0, 0}); };
  PeerConfig c = in_regions(1, {{world["A"], true}});
  c.policy.copies = 1;
  const auto self = lan.add(c, 0s, {{world["A"], jumps}});
  lan.add(in_regions(2));
  lan.run_until(4s);
  const Duration asked = lan.now();
  std::map<std::uint32_t, int> sends;
  lan.on_send = [&](std::size_t from, RegionId, const Message& m) {
    for (const UpdateRecord& u : m.updates) sends[u.sequence] += from == self ? 1 : 0;
  };
  Message m = message_of(2);
  m.subscriptions = {{RegionId{1}, lan.session_now(self)}};
  jumped = true;
  lan.inject(self, encode(m));
  lan.run_until(asked + 100ms);
  const auto published = lan.seen<Published>(self);
  ASSERT_FALSE(published.empty());
  EXPECT_EQ(published.back().reason, PublishReason::kError);
  ASSERT_FALSE(sends.empty());
  EXPECT_GE(sends.rbegin()->second, 3);
}

// Two objects that may collide belong to two peers without any other area of interest. The peers find each other's
// object, and the same contacts as without regions.
TEST(RegionsCollide, OwnObjectsAreSurroundedByWhatTheyMayMeet) {
  const auto run = [](bool regions) {
    const World world(box("A", "6 1 1", "0 0 0", kBounces) + box("B", "6 1 1", "40 0 0", kBounces) +
                      interest("A", "\"B\"") + interest("B", "\"A\""));
    Lan lan(world, {.latency = 20ms});
    std::vector<Duration> held;
    for (std::uint32_t id : {1u, 2u}) {
      PeerConfig c = regions ? looking_from(in_regions(id, {}, 0.0), 0.0) : config(id);
      c.decisions.viewpoint.reset();
      c.interest_radius_m = 0.0;
      c.owned = {{world[id == 1 ? "A" : "B"], false, {2s, Vec3(id == 1 ? 4.0 : -4.0, 0, 0), Vec3::Zero()}}};
      lan.add(c);
    }
    lan.run_until(3s);
    if (regions) {
      EXPECT_FALSE(lan.peer(0).receives(world["B"])) << "far away";
    }
    lan.run_until(12s);
    std::vector<std::pair<double, double>> all;  // where A was hit, and which way
    for (std::size_t i : {0u, 1u}) {
      for (const auto kind : {ContactKind::kDecided, ContactKind::kApplied}) {
        for (const ContactSeen& c : lan.contacts(i, kind)) {
          all.emplace_back(c.contact.collider_before.position.x(), c.contact.normal.x());
        }
      }
    }
    return all;
  };
  const auto with = run(true), without = run(false);
  ASSERT_EQ(without.size(), 2u) << "decided by one, applied by the other";
  ASSERT_EQ(with.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(with[i].first, without[i].first, 0.02);
    EXPECT_EQ(with[i].second, without[i].second);
  }
}

// An object that a peer only remembers collides with nothing.
TEST(RegionsCollide, ObjectsThatAreNotReceivedCollideWithNothing) {
  const World world(box("A", "1 1 1", "5 0 0", kBounces) + box("B", "1 1 1", "5 0 -8", kBounces) +
                    interest("B", "\"A\""));
  Lan lan(world, {.latency = 20ms});
  const auto leaving = [&](SimTime t) {
    const double s = to_seconds(t - (lan.session_now(0) - lan.now())) - 3.0;
    return moving({s < 0.0 ? 5.0 : 35.0, 0, 0});  // at once: nobody hears of it on the way
  };
  lan.add(in_regions(2, {{world["A"], true}}), 0s, {{world["A"], leaving}});
  PeerConfig b = looking_from(in_regions(1, {{world["B"], false, {4s, Vec3(0, 0, 2.0), Vec3::Zero()}}}, 1.0), 5.0);
  b.regions.fastest_m_s = 0.0;
  lan.add(b);  // the lower id: it would decide
  lan.run_until(4s);
  EXPECT_FALSE(lan.peer(1).receives(world["A"]));
  const auto tests = lan.peer(1).counters().proximity_tests, skipped = lan.peer(1).counters().predictions_skipped;
  lan.run_until(12s);
  EXPECT_FALSE(lan.peer(1).receives(world["A"]));
  EXPECT_EQ(lan.peer(1).counters().proximity_tests, tests) << "nor is it close to anything";
  EXPECT_EQ(lan.peer(1).counters().predictions_skipped, skipped + 8 * 60) << "of one pair";
  EXPECT_THAT(lan.contacts(1, ContactKind::kDecided), IsEmpty());
  EXPECT_THAT(lan.contacts(1, ContactKind::kOwner), IsEmpty());
  EXPECT_GT(lan.peer(1).truth(world["B"], lan.session_now(1)).position.z(), 1.0) << "it flew through where A was";
}

// Two objects have met across a border: a peer that receives only one of them still receives the outcome.
TEST(RegionsCollide, OutcomesArePublishedAcrossABorder) {
  const World world(box("A", "1 1 1", "8.5 0 0", kBounces) + box("B", "1 1 1", "13 0 0", kBounces) +
                    interest("A", "\"B\"") + interest("B", "\"A\""));
  Lan lan(world, {.latency = 20ms});
  // One peer owns both objects, so no decision publishes the outcome.
  lan.add(in_regions(1, {{world["A"], false, {3s, Vec3(0.5, 0, 0), Vec3::Zero()}},
                         {world["B"], false, {3s, Vec3(-0.9, 0, 0), Vec3::Zero()}}}));
  const auto b = lan.add(looking_from(in_regions(2, {}, 2.0), 5.0));
  lan.run_until(4s);
  EXPECT_TRUE(lan.peer(b).receives(world["A"]));
  EXPECT_FALSE(lan.peer(b).receives(world["B"]));
  lan.run_until(7s);  // they meet at about 6 s
  const SimTime t = lan.session_now(0);
  ASSERT_TRUE(lan.peer(b).receives(world["A"]));
  EXPECT_LT(lan.peer(0).truth(world["A"], t).velocity.x(), 0.0) << "it has bounced";
  EXPECT_TRUE(same_bits(lan.peer(b).ghost(world["A"], t), lan.peer(0).ghost(world["A"], t)));
}

}  // namespace peerd::replication::peer_regions_test
