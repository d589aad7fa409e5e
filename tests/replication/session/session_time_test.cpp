#include "replication/session/session_time.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::session_time_test {

using namespace test;

constexpr Duration k2030 = std::chrono::seconds(1'893'456'000);

// This peer is peer 2. The hellos of the others come at times that a test says.
class Timing : public testing::Test {
 protected:
  // Founds a session at 1 s.
  void found() {
    time.start(host(0s));
    ASSERT_TRUE(time.found_session(host(1s)));
    (void)drain<Synchronised>(outbox);
  }
  // A computer whose clock is not surely wrong founds a session a second after this.
  HostTime found_in_2030() {
    const HostTime start{k2030};
    time.start(start);
    EXPECT_TRUE(time.found_session(start + 1s));
    return start;
  }
  // A hello of a peer whose session time is `ahead` of this host's: it answers one that left here 2 ms ago, and each
  // way took 1 ms. Without `error` that peer leads.
  void hear(std::uint32_t id, HostTime now, Duration ahead, std::optional<Duration> error = {},
            std::optional<OsClockNote> os_clock = {}) {
    if (!members.contains(PeerId{id})) add_member(members, id, now);
    Member& member = *members.find(PeerId{id});
    member.last_received = member.hello_rx = now;
    const auto theirs = [&](HostTime t) { return SimTime{t.time_since_epoch() + ahead}; };
    Hello hello;
    hello.session_tx = theirs(now - 1ms);
    hello.clock_error = error;
    hello.os_clock = os_clock;
    time.on_stamps(now, member, hello, OffsetInterval::Echo{now - 2ms, theirs(now - 1ms)});
  }
  // The operating systems' clocks are known, too. Hellos come 10 ms apart from 1 s on.
  void hear_with_os_clock(int hellos, const OsClockNote& note) {
    time.start(host(0s));
    time.on_os_clock(host(1s), OsClock{100s, 10us});
    for (int i = 1; i <= hellos; ++i) {
      hear(1, host(1s) + i * 10ms, 7s, {}, note);
      (void)time.follow_leader(host(1s) + i * 10ms, PeerId{1}, false);
    }
  }
  // Four hellos, 10 ms apart until `now`. After each this peer follows the leader of that hello.
  bool hear_four(std::uint32_t id, HostTime now, Duration ahead, bool in_session, std::optional<Duration> error = {}) {
    bool enters = false;
    for (int i = 3; i >= 0; --i) {
      hear(id, now - i * 10ms, ahead, error);
      enters = time.follow_leader(now - i * 10ms, PeerId{id}, in_session);
    }
    return enters;
  }

  PeerConfig own = config(2);
  PeerCounters counters;
  Membership members{own.lost_after, own.large};
  Outbox outbox{own.id, own.incarnation, counters};
  MemberLimits limits{members, outbox, counters};
  SessionTime time{own, members, outbox, counters, limits};
};

// ---- founding ----

TEST_F(Timing, StartsOnce) {
  EXPECT_EQ(time.started(), std::nullopt);
  EXPECT_TRUE(time.start(host(3s)));
  EXPECT_FALSE(time.start(host(4s)));
  EXPECT_EQ(time.started(), host(3s));
}

TEST_F(Timing, FoundsASessionAfterListening) {
  time.start(host(3s));
  EXPECT_FALSE(time.found_session(host(4s) - 1ns));
  EXPECT_FALSE((time.follows() == PeerId{2}));
  EXPECT_TRUE(time.found_session(host(4s)));
  EXPECT_TRUE((time.follows() == PeerId{2}) && time.clock().synchronised());
  EXPECT_EQ(time.follows(), PeerId{2});
  const auto said = drain<Synchronised>(outbox);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].follows, PeerId{2});
  EXPECT_EQ(said[0].error_bound, 0s);
  EXPECT_FALSE(time.found_session(host(9s))) << "it has one";
}

struct WaitCase {
  const char* name;
  std::uint32_t member;
  bool synchronised, echoes_us;
  std::optional<Duration> founds_at;  // after the start; none: never
};
class Waiting : public Timing, public testing::WithParamInterface<WaitCase> {};
// The peer that is to lead, or has a session, has three times the listening time, and a turn of its hellos, to answer.
TEST_P(Waiting, ForWhomItMayFollow) {
  const WaitCase& c = GetParam();
  time.start(host(0s));
  Member& member = add_member(members, c.member);
  member.synchronised = c.synchronised;
  member.echo.echoes_us = c.echoes_us;
  if (!c.founds_at) {
    EXPECT_FALSE(time.found_session(host(100s)));
    return;
  }
  EXPECT_FALSE(time.found_session(host(*c.founds_at) - 1ns));
  EXPECT_TRUE(time.found_session(host(*c.founds_at)));
}
INSTANTIATE_TEST_SUITE_P(Table, Waiting,
                         testing::Values(WaitCase{"HigherWithoutASession", 3, false, true, 1s},
                                         WaitCase{"LowerThatDoesNotReceiveUs", 1, false, false, 4s},
                                         WaitCase{"LowerThatReceivesUs", 1, false, true, {}},
                                         WaitCase{"HigherInASession", 3, true, true, {}},
                                         WaitCase{"HigherInASessionThatDoesNotReceiveUs", 3, true, false, 4s}),
                         [](const auto& c) { return std::string(c.param.name); });

// In a large session the leader answers a joining peer; a far peer without session time is a joining peer itself.
TEST_F(Timing, ALargeSessionIsWaitedFor) {
  time.start(host(0s));
  FarPeer& far = *members.note_far(host(0s), PeerId{7}, 1).first;
  far.synchronised = true;
  EXPECT_FALSE(time.found_session(host(100s)));
  far.synchronised = false;
  EXPECT_TRUE(time.found_session(host(1s)));
}

TEST_F(Timing, WaitsForAnIntroductionButNotForEver) {
  time.start(host(0s));
  time.on_unintroduced_peer(host(500ms));
  EXPECT_FALSE(time.found_session(host(1500ms) - 1ns));
  time.on_unintroduced_peer(host(2500ms));
  EXPECT_FALSE(time.found_session(host(3s) - 1ns));
  EXPECT_TRUE(time.found_session(host(3s)));
}

// ---- following ----

TEST_F(Timing, FollowsAPeerOnceFourExchangesBoundItsTime) {
  time.start(host(0s));
  for (int i = 1; i <= 3; ++i) {
    hear(1, host(1s) + i * 10ms, 7s);
    EXPECT_FALSE(time.follow_leader(host(1s) + i * 10ms, PeerId{1}, false)) << i;
    EXPECT_FALSE(time.clock().synchronised());
  }
  hear(1, host(1040ms), 7s);
  EXPECT_TRUE(time.follow_leader(host(1040ms), PeerId{1}, false));
  EXPECT_EQ(time.follows(), PeerId{1});
  EXPECT_FALSE((time.follows() == PeerId{2}));
  const auto said = drain<Synchronised>(outbox);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].follows, PeerId{1});
  EXPECT_NEAR(to_seconds(said[0].session_minus_host), 7.0, 1e-3);
  EXPECT_GE(said[0].error_bound, 1ms) << "a way of 1 ms each";
  EXPECT_LT(said[0].error_bound, 2ms);
}

TEST_F(Timing, WhoIsInTheSessionDoesNotEnterItAgain) {
  found();
  const Duration same = time.clock().session_minus_host(host(2s));
  EXPECT_FALSE(hear_four(1, host(2s), same, true)) << "it is in one already";
  EXPECT_EQ(time.follows(), PeerId{1});
  EXPECT_TRUE(drain<Synchronised>(outbox).empty());
}

struct LeaderCase {
  const char* name;
  std::uint32_t member;
  Duration ahead;  // of this peer's session time
  std::uint32_t leader;
};
class Leader : public Timing, public testing::WithParamInterface<LeaderCase> {};
// Session times that are more than 500 ms apart belong to two sessions, of which the later one continues.
TEST_P(Leader, IsTheLowestPeerOfTheLaterSession) {
  found();
  const Duration own_time = time.clock().session_minus_host(host(2s));
  (void)hear_four(GetParam().member, host(2s), own_time + GetParam().ahead, true);
  EXPECT_EQ(time.follows(), PeerId{GetParam().leader});
}
INSTANTIATE_TEST_SUITE_P(Table, Leader,
                         testing::Values(LeaderCase{"LowerInTheSameSession", 1, 0s, 1},
                                         LeaderCase{"HigherInTheSameSession", 3, 0s, 2},
                                         LeaderCase{"LowerNearlyASessionAhead", 1, 490ms, 1},
                                         LeaderCase{"HigherNearlyASessionAhead", 3, 490ms, 2},
                                         LeaderCase{"HigherInALaterSession", 3, 510ms, 3},
                                         LeaderCase{"LowerInAnEarlierSession", 1, -510ms, 2},
                                         LeaderCase{"LowerALittleBehind", 1, -490ms, 1}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST_F(Timing, StepsForwardIntoALaterSession) {
  found();
  (void)hear_four(3, host(2s), 10s, true);
  const auto step = time.adjust(host(2s));
  ASSERT_TRUE(step);
  EXPECT_FALSE(step->same_session);
  EXPECT_NEAR(to_seconds(step->by), 10.0, 1e-2);
  EXPECT_FALSE(time.adjust(host(2s))) << "once";
}

TEST_F(Timing, LosesItsLeader) {
  found();
  EXPECT_FALSE(time.has_lost_leader());
  (void)hear_four(1, host(2s), time.clock().session_minus_host(host(2s)), true);
  EXPECT_FALSE(time.has_lost_leader());
  members.remove(PeerId{1});
  EXPECT_TRUE(time.has_lost_leader());
  EXPECT_FALSE(time.follow_leader(host(2s), std::nullopt, true));
  EXPECT_TRUE((time.follows() == PeerId{2})) << "nobody else is left";
  EXPECT_FALSE(time.has_lost_leader());
  EXPECT_EQ(time.clock().error_bound(host(2s)), 0s);
}

// ---- who leads a large session ----

class TimingOfALargeSession : public Timing {
 protected:
  TimingOfALargeSession() {
    for (std::uint32_t id = 100; id < 160; ++id) {
      members.note_far(host(0s), PeerId{id}, 1).first->synchronised = true;
    }
    EXPECT_TRUE(members.follow_size(true));
  }
  // A far hello of peer 1, which says that it leads. Its clock is not known.
  void claim_to_lead(HostTime now, bool echoes) {
    if (members.find_far(PeerId{1}) == nullptr && !members.contains(PeerId{1})) {
      members.note_far(now, PeerId{1}, 1).first->synchronised = true;
    }
    Member& member = members.contains(PeerId{1}) && members.find(PeerId{1}) != nullptr
                         ? *members.find(PeerId{1})
                         : members.promote(now, PeerId{1}, false);
    member.leads = true;
    member.last_received = now;
    if (echoes) member.echoing = now;
  }
  std::optional<PeerId> leader_at(HostTime now, std::optional<PeerId> sender = {}) {
    EXPECT_FALSE(time.follow_leader(now, sender, true));
    return time.follows();
  }
};

TEST_F(TimingOfALargeSession, ItsLeaderLeadsUntilItFollowsALowerPeer) {
  time.start(host(0s));
  for (std::uint32_t id = 100; id < 160; ++id) members.find_far(PeerId{id})->synchronised = false;
  ASSERT_TRUE(time.found_session(host(20s)));
  claim_to_lead(host(21s), true);
  EXPECT_EQ(leader_at(host(21s), PeerId{1}), PeerId{2}) << "the other may receive nothing";
  hear_four(1, host(22s), 21ms, true);
  EXPECT_EQ(time.follows(), PeerId{1});
}

// The followed leader has gone. A lower peer claims to lead; as long as it answers others this peer waits for it.
TEST_F(TimingOfALargeSession, NobodyBeginsToLeadWhileALowerPeerMay) {
  time.start(host(0s));
  EXPECT_TRUE(hear_four(3, host(1s), 0s, false)) << "a session that was there before";
  ASSERT_EQ(time.follows(), PeerId{3});
  members.remove(PeerId{3});
  members.note_far(host(2s), PeerId{1}, 1).first->synchronised = true;
  EXPECT_EQ(leader_at(host(2s)), std::nullopt) << "a far peer may lead next";
  claim_to_lead(host(3s), false);
  EXPECT_EQ(leader_at(host(3s)), std::nullopt);
  claim_to_lead(host(7s), true);
  EXPECT_EQ(leader_at(host(11s)), std::nullopt) << "it has echoed somebody four seconds ago";
  claim_to_lead(host(12s), false);
  EXPECT_EQ(leader_at(host(12s)), PeerId{2}) << "it echoes nobody: it receives nothing";
}

TEST_F(Timing, AHelloWithoutTimeForgetsWhatWasKnownOfIt) {
  hear(1, host(1s), 7s);
  Member& one = *members.find(PeerId{1});
  EXPECT_TRUE(one.leads);
  EXPECT_TRUE(one.clock.at(host(1s), kDrift_ppm));
  time.on_stamps(host(2s), one, Hello{}, std::nullopt);
  EXPECT_FALSE(one.leads);
  EXPECT_FALSE(one.clock.at(host(2s), kDrift_ppm));
}

TEST_F(Timing, CountsStampsThatContradictEachOther) {
  hear(1, host(1s), 7s);
  EXPECT_EQ(counters.clock_contradictions, 0u);
  hear(1, host(1100ms), 17s);
  EXPECT_EQ(counters.clock_contradictions, 1u);
}

// ---- how far others move it ----

constexpr Duration k31Years = std::chrono::hours(31 * 366 * 24);

TEST_F(Timing, WhoSharesItsTimeFollowsNobodyFarAhead) {
  const HostTime start = found_in_2030();
  for (const Duration ahead : {k31Years, 11 * Duration(1min)}) {
    (void)hear_four(3, start + 2s, 0s, true);
    (void)hear_four(1, start + 2s, ahead, true);
    EXPECT_EQ(time.follows(), PeerId{2});
    EXPECT_FALSE(time.adjust(start + 2s));
    members.remove(PeerId{1});
  }
  EXPECT_GT(counters.drops["clock_ahead"], 0u);
  const auto said = drain<LimitMet>(outbox);
  ASSERT_EQ(said.size(), 1u) << "once a minute";
  EXPECT_EQ(said[0].peer, PeerId{1});
  EXPECT_EQ(said[0].limit, MemberLimit::kClockAhead);
  (void)hear_four(1, start + 3s, 9min, true);
  EXPECT_EQ(time.follows(), PeerId{1}) << "two sessions may meet";
  EXPECT_TRUE(time.adjust(start + 3s));
}

TEST_F(Timing, ManySmallStepsAreNoMore) {
  const HostTime start = found_in_2030();
  HostTime now = start + 2s;
  for (Duration ahead{0}; ahead < 20min; ahead += 20s, now += 10s) {
    (void)hear_four(3, now, time.clock().session_minus_host(now), true);
    members.remove(PeerId{1});
    (void)hear_four(1, now, ahead, true);
    (void)time.adjust(now);
  }
  EXPECT_GT(time.clock().session_minus_host(now), 9min);
  EXPECT_LT(time.clock().session_minus_host(now), 10min + 2s) << "and what clocks drift apart";
}

TEST_F(Timing, WhoIsAloneFollowsForAYear) {
  const HostTime start = found_in_2030();
  (void)hear_four(1, start + 2s, k31Years, true);
  EXPECT_FALSE(time.adjust(start + 2s));
  (void)hear_four(3, start + 3s, 24h * 300, true);
  EXPECT_EQ(time.follows(), PeerId{3});
  EXPECT_TRUE(time.adjust(start + 3s)) << "its own clock may be late";
}

TEST_F(Timing, WhoKnowsTheRightTimeDoesNot) {
  const HostTime start = found_in_2030();
  time.on_os_clock(start + 1s, OsClock{1h, 10ms});
  (void)hear_four(3, start + 2s, 24h * 300, true);
  EXPECT_FALSE(time.adjust(start + 2s));
  (void)hear_four(4, start + 3s, 1h, true);
  EXPECT_TRUE(time.adjust(start + 3s)) << "the right time is an hour ahead";
}

// A computer without a clock of its own begins in 1970.
TEST_F(Timing, ASurelyWrongClockFollowsAnything) {
  found();
  (void)hear_four(3, host(2s), k2030, true);
  EXPECT_TRUE(time.adjust(host(2s)));
}

TEST_F(Timing, ANewcomerPrefersASessionThatIsNear) {
  const HostTime start{k2030};
  time.start(start);
  (void)hear_four(1, start + 1s, 24h, false);
  EXPECT_EQ(time.follows(), PeerId{1});
  members = Membership{own.lost_after};
  SessionTime again{own, members, outbox, counters, limits};
  again.start(start);
  for (int i = 0; i < 4; ++i) {
    hear(1, start + 1s + i * 10ms, 24h);
    hear(3, start + 1s + i * 10ms, 1s);
    (void)again.follow_leader(start + 1s + i * 10ms, PeerId{3}, false);
  }
  EXPECT_EQ(again.follows(), PeerId{3});
}

TEST_F(Timing, ANewcomerFoundsBesideASessionThatIsTooFarAhead) {
  const HostTime start{k2030};
  time.start(start);
  EXPECT_FALSE(hear_four(1, start + 1s, k31Years, false));
  members.find(PeerId{1})->echo.echoes_us = true;
  EXPECT_TRUE(time.found_session(start + 4s));
}

struct LateSessionCase {
  const char* name;
  Duration behind;  // the session is, of the newcomer's clock, which shows the time of its last edit
  std::size_t members;
  std::optional<Duration> right_time;  // as the members' operating systems know it, ahead of the session
  bool comes_forward;
};
class LateSession : public Timing, public testing::WithParamInterface<LateSessionCase> {};
// The edits of a newcomer, and the new ones behind them, would wait in a session whose founder's clock is behind.
TEST_P(LateSession, ComesForwardToTheEditsOfANewcomer) {
  const LateSessionCase& c = GetParam();
  const HostTime start{k2030};
  time.begin_behind(SimTime{k2030});
  time.start(start);
  std::optional<OsClockNote> os_clock;
  if (c.right_time) os_clock = OsClockNote{*c.right_time, 1ms};
  for (HostTime now = start + 900ms; now <= start + 1s; now += 20ms) {
    for (std::uint32_t id = 3; id < 3 + c.members; ++id) {
      hear(id, now, -c.behind, {}, os_clock);
      members.find(PeerId{id})->echo.echoes_us = true;
      if (now > start + 900ms) (void)time.follow_leader(now, PeerId{id}, false);
    }
  }
  EXPECT_EQ(time.found_session(start + 1s), c.comes_forward);
  EXPECT_EQ(time.clock().session_minus_host(start + 1s), c.comes_forward ? Duration{0} : -c.behind);
}
INSTANTIATE_TEST_SUITE_P(Table, LateSession,
                         testing::Values(LateSessionCase{"OfMinutes", 300s, 1, {}, true},
                                         LateSessionCase{"OfHours", 2h, 1, {}, true},
                                         LateSessionCase{"OfNoMoreThanStampsMayBeAhead", 10s, 1, {}, false},
                                         LateSessionCase{"OfTwoThatFollowSoFar", 300s, 2, {}, true},
                                         LateSessionCase{"OfTwoThatDoNot", 2h, 2, {}, false},
                                         LateSessionCase{"OfOneThatKnowsTheTime", 2h, 1, 2h, true},
                                         LateSessionCase{"OfOneThatIsRight", 2h, 1, 0s, false}),
                         [](const auto& each) { return std::string(each.param.name); });

TEST_F(Timing, EditsThatThisComputersClockHasNotReachedMoveNoSession) {
  const HostTime start{k2030};
  time.begin_behind(SimTime{k2030 + 1h});
  time.start(start);
  EXPECT_TRUE(hear_four(3, start + 1s, 0s, false));
  EXPECT_EQ(time.follows(), PeerId{3});
}

TEST_F(Timing, AnErrorBeyondTheReachIsFollowedByNobody) {
  const HostTime start = found_in_2030();
  (void)hear_four(1, start + 2s, 0s, true, 24h);
  EXPECT_EQ(time.follows(), PeerId{2});
}

// ---- what a hello says ----

TEST_F(Timing, StampsHellosWithItsTimeAndItsError) {
  Hello before;
  time.stamp(before, host(0s));
  EXPECT_FALSE(before.session_tx || before.clock_error);
  found();
  Hello leading;
  time.stamp(leading, host(3s));
  EXPECT_EQ(leading.session_tx, time.clock().to_session(host(3s)));
  EXPECT_FALSE(leading.clock_error) << "its time is the session's";
  (void)hear_four(1, host(4s), time.clock().session_minus_host(host(4s)), true, 5ms);
  Hello following;
  time.stamp(following, host(4s));
  EXPECT_EQ(following.session_tx, time.clock().to_session(host(4s)));
  ASSERT_TRUE(following.clock_error);
  EXPECT_GE(*following.clock_error, 6ms) << "the leader's own error, and a way";
  EXPECT_LT(*following.clock_error, 8ms);
}

TEST_F(Timing, SaysHowGoodTheOperatingSystemsClockIs) {
  found();
  const auto note = [this](HostTime now) {
    Hello hello;
    time.stamp(hello, now);
    return hello.os_clock;
  };
  EXPECT_FALSE(note(host(2s)));
  time.on_os_clock(host(2s), OsClock{3s, 4ms});
  ASSERT_TRUE(note(host(2s)));
  EXPECT_EQ(note(host(2s))->minus_session, 3s - time.clock().session_minus_host(host(2s)));
  EXPECT_NEAR(to_seconds(note(host(2s))->error), 0.004, 1e-8);
  EXPECT_NEAR(to_seconds(note(host(12s))->error), 0.004 + 10 * 1001e-6, 1e-6) << "it drifts";
  time.on_os_clock(host(2s), OsClock{3s, kOsErrorMax + 1ns});
  EXPECT_FALSE(note(host(2s))) << "as good as none";
  time.on_os_clock(host(2s), std::nullopt);
  EXPECT_FALSE(note(host(2s)));
}

// Both clocks are off UTC by 10 us at most: these bounds are narrower than those of a way of 1 ms.
TEST_F(Timing, OperatingSystemsClocksNarrowTheError) {
  hear_with_os_clock(4, {93s, 10us});
  const auto said = drain<Synchronised>(outbox);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NEAR(to_seconds(said[0].session_minus_host), 7.0, 3e-5);
  EXPECT_LT(said[0].error_bound, 200us);
  EXPECT_EQ(counters.os_clocks_doubted, 0u);
}

TEST_F(Timing, OperatingSystemsClocksThatContradictTheStampsAreDoubtedOnce) {
  hear_with_os_clock(6, {94s, 10us});  // 1 s apart
  const auto doubted = drain<OsClockDoubted>(outbox);
  ASSERT_EQ(doubted.size(), 1u);
  EXPECT_EQ(doubted[0].peer, PeerId{1});
  EXPECT_NEAR(to_seconds(doubted[0].apart), 1.0, 0.01);
  EXPECT_EQ(counters.os_clocks_doubted, 1u);
  EXPECT_NEAR(to_seconds(time.clock().session_minus_host(host(1060ms))), 7.0, 1e-2) << "the stamps are believed";
}

// ---- suspensions ----

TEST_F(Timing, AGapBetweenCallsIsASuspensionWhereOthersAreHere) {
  found();
  EXPECT_EQ(time.check_suspension(host(1s), true), std::nullopt) << "the first call";
  EXPECT_EQ(time.check_suspension(host(60s), true), std::nullopt) << "nobody is out of step with it";
  add_member(members, 3, host(60s));
  EXPECT_EQ(time.check_suspension(host(60s) + SessionTime::kSuspendedAfter, true), std::nullopt);
  const HostTime slept = host(60s) + SessionTime::kSuspendedAfter;
  const SimTime before = time.clock().to_session(slept);
  EXPECT_EQ(time.check_suspension(slept + 9s, true), 9s);
  EXPECT_EQ(time.clock().to_session(slept + 9s), before) << "session time goes on from where it was";
  EXPECT_FALSE(time.clock().synchronised());
  EXPECT_EQ(time.follows(), std::nullopt);
  EXPECT_EQ(members.find(PeerId{3})->last_received, slept + 9s) << "it was not silent";
  EXPECT_FALSE(time.found_session(slept + 9s)) << "it listens anew";
}

TEST_F(Timing, AfterASuspensionItStepsWithinItsSession) {
  found();
  (void)time.check_suspension(host(2s), true);
  (void)hear_four(1, host(3s), time.clock().session_minus_host(host(3s)), true);
  (void)time.check_suspension(host(3s), true);
  ASSERT_EQ(time.check_suspension(host(13s), true), 10s);
  const Duration was = time.clock().session_minus_host(host(13s));
  (void)hear_four(1, host(13500ms), was + 10s, true);
  const auto step = time.adjust(host(13500ms));
  ASSERT_TRUE(step);
  EXPECT_TRUE(step->same_session);
  EXPECT_NEAR(to_seconds(step->by), 10.0, 1e-2);
}

}  // namespace peerd::replication::session_time_test
