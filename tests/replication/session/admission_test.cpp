#include "replication/session/admission.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::admission_test {

using namespace test;
using Known = Membership::Admission;

class Admitting : public testing::Test {
 protected:
  std::expected<Known, Drop> admit(const Message& m, HostTime now = host(10s),
                                   std::optional<HostTime> started = host(0s)) {
    return admission.admit(now, region, m, leads, started, [this](PeerId peer, const OtherPeer& gone) {
      EXPECT_FALSE(members.contains(peer)) << "it has been removed already";
      EXPECT_FALSE(outbox.poll()) << "its loss comes before the report of its world";
      lost.emplace_back(peer, gone.incarnation);
    });
  }
  static Message introduction(std::uint32_t id, std::uint64_t incarnation = 100) {
    return hello_of(id, host(10s), {}, incarnation);
  }
  static Message of_other_world(std::uint32_t id, std::uint64_t incarnation = 100) {
    Message m = introduction(id, incarnation);
    m.hello->introduction->world_hash = 0xBAD;
    return m;
  }

  PeerConfig own = config(1);
  PeerCounters counters;
  Membership members{own.lost_after};
  Outbox outbox{own.id, own.incarnation, counters};
  MemberLimits limits{members, outbox, counters};
  Admission admission{own, members, outbox, limits};
  RegionId region = kWholeScene;  // that datagrams come to
  bool leads = false;             // this peer
  std::vector<std::pair<PeerId, std::uint64_t>> lost;
};

// ---- large sessions ----

class AdmittingFar : public Admitting {
 protected:
  AdmittingFar() { members = Membership(own.lost_after, LargeSession{.above = 1}); }
  static Message far_hello(std::uint32_t id, std::uint64_t incarnation = 100) {
    Message m = introduction(id, incarnation);
    m.next_hello = 10s;
    return m;
  }
};

TEST_F(AdmittingFar, AFarPeerComesNearByWhatItSaysToARegion) {
  EXPECT_EQ(admit(far_hello(2)), Known::kFar);
  EXPECT_EQ(members.find(PeerId{2}), nullptr);
  (void)members.note_far(host(10s), PeerId{2}, 100);
  region = RegionId{4};
  EXPECT_EQ(admit(message_of(2, 99)), std::unexpected(Drop::kUnintroduced)) << "another incarnation's";
  EXPECT_EQ(admit(message_of(2, 100)), Known::kNear);
  EXPECT_NE(members.find(PeerId{2}), nullptr);
  EXPECT_EQ(admit(far_hello(2)), Known::kFar) << "it does not make its sender near";
  EXPECT_NE(members.find(PeerId{2}), nullptr);
  EXPECT_TRUE(lost.empty());
}

TEST_F(AdmittingFar, WhatBeginsAnewIsLostBefore) {
  for (const std::uint32_t id : {2u, 3u}) (void)members.note_far(host(10s), PeerId{id}, 100);
  EXPECT_EQ(admit(far_hello(2, 99)), std::unexpected(Drop::kStaleIncarnation));
  EXPECT_EQ(admit(introduction(3, 99)), std::unexpected(Drop::kStaleIncarnation));
  EXPECT_TRUE(lost.empty());
  EXPECT_EQ(admit(far_hello(2, 101)), Known::kFar);
  EXPECT_EQ(admit(introduction(3, 101)), Known::kJoined);
  EXPECT_EQ(lost, (std::vector<std::pair<PeerId, std::uint64_t>>{{PeerId{2}, 100}, {PeerId{3}, 100}}));
}

// In a large session only the peer that leads answers a joining one; for the others it is far.
TEST_F(AdmittingFar, WhoSaysItsPresenceAloneIsFar) {
  (void)members.note_far(host(10s), PeerId{9}, 100);
  ASSERT_TRUE(members.follow_size(true));
  Message joining = introduction(2);
  joining.hello->session_tx.reset();
  EXPECT_EQ(admit(joining), Known::kFar);
  leads = true;
  EXPECT_EQ(admit(joining), Known::kJoined);
  EXPECT_EQ(admit(introduction(3)), Known::kFar) << "it has session time already";
}

TEST_F(Admitting, APeerIsKnownOnceItHasIntroducedItself) {
  EXPECT_EQ(admit(message_of(2)), std::unexpected(Drop::kUnintroduced));
  EXPECT_EQ(admit(introduction(2)), Known::kJoined);
  EXPECT_EQ(admit(introduction(2)), Known::kKnown);
  EXPECT_EQ(admit(message_of(2)), Known::kKnown);
  EXPECT_EQ(admit(message_of(2, 101)), std::unexpected(Drop::kStaleIncarnation)) << "another incarnation's";
  EXPECT_EQ(admit(introduction(2, 101)), Known::kRestarted);
  EXPECT_EQ(admit(introduction(2, 100)), std::unexpected(Drop::kStaleIncarnation));
  EXPECT_EQ(members.find(PeerId{2})->incarnation, 101u);
}

// A datagram without an introduction carries only the low bits of its incarnation.
TEST_F(Admitting, TheLowBitsOfAnIncarnationAreEnough) {
  constexpr std::uint64_t kLong = 0xABCDEF01'23456789;
  ASSERT_EQ(admit(introduction(2, kLong)), Known::kJoined);
  EXPECT_EQ(admit(message_of(2, incarnation_low(kLong)), host(11s)), Known::kKnown);
  EXPECT_EQ(members.find(PeerId{2})->incarnation, kLong);
  EXPECT_EQ(members.find(PeerId{2})->last_received, host(11s));
}

// Two programs are peer 2, and the one that started earlier goes on: its datagrams can't be under way for so long.
TEST_F(Admitting, AnEarlierLifeThatGoesOnIsNamedOnce) {
  ASSERT_EQ(admit(introduction(2, 101), host(10s)), Known::kJoined);
  EXPECT_EQ(admit(introduction(2, 100), host(11s)), std::unexpected(Drop::kStaleIncarnation));
  EXPECT_TRUE(drain<IdInUse>(outbox).empty());
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(admit(introduction(2, 100), host(12s)), std::unexpected(Drop::kStaleIncarnation));
  }
  const auto named = drain<IdInUse>(outbox);
  ASSERT_EQ(named.size(), 1u);
  EXPECT_EQ(named[0].peer, PeerId{2});
  EXPECT_FALSE(named[0].is_ours);
}

class IdentityChecking : public Admitting {
 protected:
  Drop check(std::uint32_t id, const IdentityCheck& identity, HostTime now = host(10s)) {
    Message m = message_of(id);
    m.identity = identity;
    return admission.on_identity_check(now, m);
  }
};

TEST_F(IdentityChecking, AQuestionForThisPeerIsAnsweredWithoutANumber) {
  EXPECT_EQ(check(1, {777, own.world_hash, false}), Drop::kIdentityCheck);
  const auto sent = drain_messages(outbox, SimTime{});
  ASSERT_EQ(sent.size(), 1u);
  const Message& answer = sent[0].second;
  EXPECT_EQ(answer.sender, PeerId{1});
  EXPECT_EQ(answer.number, 0u);
  EXPECT_EQ(outbox.last_number(), 0u);
  ASSERT_TRUE(answer.identity);
  EXPECT_EQ(answer.identity->asker, 777u);
  EXPECT_TRUE(answer.identity->answers);
}

TEST_F(IdentityChecking, WhatDoesNotConcernThisPeerIsNotAnswered) {
  EXPECT_EQ(check(2, {777, own.world_hash, false}), Drop::kIdentityCheck);
  EXPECT_EQ(check(1, {777, own.world_hash + 1, false}), Drop::kIdentityCheck) << "of another world";
  EXPECT_EQ(check(1, {777, own.world_hash, true}), Drop::kOwn) << "its own answer, by loopback";
  EXPECT_EQ(check(1, {own.incarnation, own.world_hash, false}), Drop::kOwn) << "its own question";
  EXPECT_TRUE(drain<Send>(outbox).empty());
  EXPECT_TRUE(members.all().empty()) << "nobody becomes known by a question";
}

TEST_F(IdentityChecking, AFloodOfQuestionsGetsFewAnswers) {
  for (int i = 0; i < 100; ++i) (void)check(1, {777, own.world_hash, false}, host(10s + i * 1ms));
  EXPECT_EQ(drain<Send>(outbox).size(), 2u) << "one in 50 ms";
}

struct OwnCase {
  const char* name;
  bool introduces;
  std::uint64_t incarnation;  // this peer's is 100
  std::optional<HostTime> started;
  Drop drop;
  bool reported;
};
class OwnId : public Admitting, public testing::WithParamInterface<OwnCase> {};
TEST_P(OwnId, IsDroppedForItsReason) {
  const OwnCase& c = GetParam();
  const Message m = c.introduces ? introduction(1, c.incarnation) : message_of(1, c.incarnation);
  EXPECT_EQ(admit(m, host(10s), c.started), std::unexpected(c.drop));
  EXPECT_TRUE(drain<IdInUse>(outbox).empty()) << "one datagram may be damaged";
  (void)admit(m, host(10s + 50ms), c.started);
  const auto reported = drain<IdInUse>(outbox);
  ASSERT_EQ(reported.size(), c.reported ? 1u : 0u);
  if (c.reported) {
    EXPECT_EQ(reported[0].ours_is_replaced, c.incarnation > 100);
  }
  (void)admit(m, host(10s + 50ms), c.started);
  EXPECT_TRUE(drain<IdInUse>(outbox).empty()) << "once";
  EXPECT_TRUE(members.all().empty());
}
// lost_after is 1750 ms: a start at 8.25 s of the host's time is just long enough ago.
INSTANTIATE_TEST_SUITE_P(
    Table, OwnId,
    testing::Values(OwnCase{"Loopback", true, 100, host(0s), Drop::kOwn, false},
                    OwnCase{"LoopbackWithoutIntroduction", false, 100, host(0s), Drop::kOwn, false},
                    OwnCase{"LoopbackBeforeTheStart", true, 100, std::nullopt, Drop::kOwn, false},
                    OwnCase{"ItsEarlierIncarnation", true, 99, host(8251ms), Drop::kStaleIncarnation, false},
                    OwnCase{"BeforeTheStart", true, 99, std::nullopt, Drop::kStaleIncarnation, false},
                    OwnCase{"EarlierButLongAfterTheStart", true, 99, host(8250ms), Drop::kIdInUse, true},
                    OwnCase{"LaterSoonAfterTheStart", true, 101, host(9s), Drop::kIdInUse, true},
                    OwnCase{"UnintroducedSoonAfterTheStart", false, 101, host(9s), Drop::kStaleIncarnation, false},
                    OwnCase{"UnintroducedLongAfterTheStart", false, 101, host(0s), Drop::kIdInUse, false}),
    [](const auto& c) { return std::string(c.param.name); });

TEST_F(Admitting, ItsOwnIdInAnotherWorldIsReportedAsThat) {
  EXPECT_EQ(admit(of_other_world(1, 101)), std::unexpected(Drop::kOtherWorld));
  EXPECT_TRUE(admission.has_other_world(PeerId{1}));
  EXPECT_EQ(drain<OtherWorld>(outbox).size(), 1u);
}

TEST_F(Admitting, APeerOfAnotherWorldIsReportedOnce) {
  EXPECT_FALSE(admission.has_other_world(PeerId{2}));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(admit(of_other_world(2)), std::unexpected(Drop::kOtherWorld));
  const auto reported = drain<OtherWorld>(outbox);
  ASSERT_EQ(reported.size(), 1u);
  EXPECT_EQ(reported[0].peer, PeerId{2});
  EXPECT_EQ(reported[0].name, "forged2");
  EXPECT_TRUE(admission.has_other_world(PeerId{2}));
  EXPECT_TRUE(members.all().empty() && lost.empty());
}

TEST_F(Admitting, AMemberThatTurnsOutToHaveAnotherWorldIsLost) {
  ASSERT_EQ(admit(introduction(2, 100)), Known::kJoined);
  EXPECT_EQ(admit(of_other_world(2, 99)), std::unexpected(Drop::kStaleIncarnation)) << "from before its restart";
  EXPECT_TRUE(members.contains(PeerId{2}) && lost.empty());
  EXPECT_EQ(admit(of_other_world(2, 101)), std::unexpected(Drop::kOtherWorld));
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0], std::pair(PeerId{2}, std::uint64_t{100}));
  EXPECT_EQ(drain<OtherWorld>(outbox).size(), 1u);
}

TEST_F(Admitting, ADepartedPeerReturnsInALaterIncarnationOnly) {
  ASSERT_EQ(admit(introduction(2, 100)), Known::kJoined);
  const Member left = admission.dismiss(PeerId{2});
  EXPECT_EQ(left.incarnation, 100u);
  EXPECT_FALSE(members.contains(PeerId{2}));
  EXPECT_EQ(admit(message_of(2, 100)), std::unexpected(Drop::kUnintroduced));
  for (const std::uint64_t incarnation : {99u, 100u}) {
    EXPECT_EQ(admit(introduction(2, incarnation)), std::unexpected(Drop::kStaleIncarnation));
  }
  EXPECT_EQ(admit(introduction(2, 101)), Known::kJoined);
  EXPECT_EQ(admit(introduction(3, 1)), Known::kJoined) << "nobody else";
}

TEST_F(Admitting, NoMoreThan4096Members) {
  for (std::uint32_t id = 2; id < 2 + 4096; ++id) ASSERT_EQ(admit(introduction(id)), Known::kJoined) << id;
  EXPECT_EQ(admit(introduction(9999)), std::unexpected(Drop::kTooMany));
  EXPECT_EQ(admit(introduction(2)), Known::kKnown);
  EXPECT_EQ(admit(introduction(3, 101)), Known::kRestarted);
}

TEST_F(Admitting, OtherVersionsAreReportedOnceEachAndNoMoreThanEight) {
  admission.on_other_version(kNobody, 3);
  admission.on_other_version(PeerId{2}, 0);
  EXPECT_TRUE(drain<OtherVersion>(outbox).empty());
  for (int round = 0; round < 2; ++round) {
    for (std::uint32_t version = 20; version < 40; ++version) admission.on_other_version(PeerId{2}, version);
  }
  const auto reported = drain<OtherVersion>(outbox);
  ASSERT_EQ(reported.size(), 8u);
  for (std::uint32_t i = 0; i < 8; ++i) EXPECT_EQ(reported[i].version, 20 + i);
}

// ---- lines of descent ----

class AdmittingLines : public Admitting {
 protected:
  // This peer is in a session of that line from now on, and has its edits.
  void be_in(std::uint64_t line) {
    EXPECT_EQ(admit(of_line(9, line, true)), Known::kJoined);
    admission.follow(true, true);
    drain<LineTaken>(outbox);
  }
  static Message of_line(std::uint32_t id, std::uint64_t line, bool has_edits, std::uint64_t incarnation = 100) {
    Message m = introduction(id, incarnation);
    m.hello->session_tx = SimTime{1s};
    m.hello->introduction->line = line;
    m.hello->introduction->has_edits = has_edits;
    return m;
  }
};

TEST_F(AdmittingLines, APeerWithoutEditsTakesThatOfTheSession) {
  EXPECT_EQ(admit(of_line(2, 7, true)), Known::kJoined);
  EXPECT_EQ(admission.line(), 7u);
  const auto taken = drain<LineTaken>(outbox);
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].from, PeerId{2});
  EXPECT_EQ(taken[0].line, 7u);
}

TEST_F(AdmittingLines, EditsOfAnotherLineAreSaidOnce) {
  admission.follow(true, false);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(admit(of_line(2, 7, false)), std::unexpected(Drop::kOtherLine));
  EXPECT_EQ(admission.line(), 0u);
  EXPECT_TRUE(admission.has_other_line(PeerId{2}));
  const auto said = drain<OtherLine>(outbox);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].line, 7u);
  EXPECT_TRUE(said[0].goes_over);
  EXPECT_TRUE(members.all().empty());
}

TEST_F(AdmittingLines, TwoSessionsThatHaveEditsStayApart) {
  be_in(5);
  EXPECT_EQ(admit(of_line(2, 7, true)), std::unexpected(Drop::kOtherLine));
  EXPECT_EQ(admit(of_line(3, 7, false)), std::unexpected(Drop::kOtherLine)) << "that one comes over";
  const auto said = drain<OtherLine>(outbox);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_FALSE(said[0].goes_over);
  EXPECT_EQ(admit(of_line(3, 5, false)), Known::kJoined);
  EXPECT_FALSE(admission.has_other_line(PeerId{3}));
}

TEST_F(AdmittingLines, AMemberThatGoesToAnotherLineIsLost) {
  be_in(5);
  EXPECT_EQ(admit(of_line(2, 5, true)), Known::kJoined);
  EXPECT_EQ(admit(of_line(2, 7, true, 99)), std::unexpected(Drop::kStaleIncarnation)) << "a datagram of before";
  EXPECT_TRUE(lost.empty());
  drain<PeerJoined>(outbox);
  EXPECT_EQ(admit(of_line(2, 7, true)), std::unexpected(Drop::kOtherLine));
  EXPECT_EQ(lost, (std::vector<std::pair<PeerId, std::uint64_t>>{{PeerId{2}, 100}}));
}

}  // namespace peerd::replication::admission_test
