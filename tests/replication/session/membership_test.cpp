#include "replication/session/membership.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::membership_test {

using namespace test;
using Admission = Membership::Admission;
constexpr PeerId kTwo{2}, kThree{3}, kFive{5};

TEST(Membership, RecognisesAPeerByItsIncarnation) {
  Membership members(2s);
  EXPECT_EQ(members.on_datagram(host(0s), kTwo, 10), Admission::kJoined);
  EXPECT_EQ(members.on_datagram(host(1s), kTwo, 10), Admission::kKnown);
  EXPECT_EQ(members.on_datagram(host(1s), kThree, 1), Admission::kJoined);
  EXPECT_EQ(members.on_datagram(host(1s), kTwo, 9), Admission::kStale);
  EXPECT_EQ(members.on_datagram(host(1s), kTwo, 11), Admission::kRestarted);
  EXPECT_EQ(members.on_datagram(host(1s), kTwo, 10), Admission::kStale);
  EXPECT_EQ(members.all().size(), 2u);
}

TEST(Membership, ARestartForgetsTheEarlierIncarnation) {
  Membership members(2s);
  members.on_datagram(host(0s), kTwo, 10);
  members.find(kTwo)->last_sequence[ObjectId{1}] = 100;
  members.find(kTwo)->synchronised = true;
  members.on_datagram(host(1s), kTwo, 11);
  EXPECT_TRUE(members.find(kTwo)->last_sequence.empty());
  EXPECT_FALSE(members.find(kTwo)->synchronised);
}

TEST(Membership, AStaleDatagramDoesNotRefreshAMember) {
  Membership members(2s);
  members.on_datagram(host(0s), kTwo, 10);
  members.on_datagram(host(1s), kTwo, 9);
  EXPECT_EQ(members.next_expiry(), host(2s));
}

TEST(Membership, SilenceExpiresAscendingAndAtOnce) {
  Membership members(2s);
  EXPECT_EQ(members.next_expiry(), std::nullopt);
  for (PeerId p : {kFive, kTwo, kThree}) members.on_datagram(host(0s), p, 1);
  members.on_datagram(host(1s), kThree, 1);
  EXPECT_EQ(members.next_expiry(), host(2s));
  EXPECT_TRUE(members.expire(host(2s) - 1ns).empty());
  const auto lost = members.expire(host(2s));  // what next_expiry names is due then, or a driver would spin
  ASSERT_EQ(lost.size(), 2u);
  EXPECT_EQ(lost[0].first, kTwo);
  EXPECT_EQ(lost[1].first, kFive);
  EXPECT_EQ(members.find(kTwo), nullptr);
  EXPECT_NE(members.find(kThree), nullptr);
  EXPECT_EQ(members.next_expiry(), host(3s));
}

constexpr LargeSession kLarge{.above = 3, .hellos_per_s = 10.0};

// A member of a large session falls silent where this peer listens; its far hellos go on.
TEST(Membership, WhoFallsSilentIsFarAsLongAsItsFarHellosCome) {
  Membership members(2s, kLarge);
  for (PeerId p : {kTwo, kThree, kFive}) members.on_datagram(host(0s), p, 7);
  members.find(kFive)->expected_until = host(30s);
  members.find(kFive)->name = "five";
  members.find(kFive)->synchronised = true;
  std::vector<PeerId> far;
  const auto lost = members.expire(host(2s), {}, std::nullopt, &far);
  ASSERT_EQ(lost.size(), 2u);
  EXPECT_EQ(lost[0].first, kTwo);
  EXPECT_EQ(lost[1].first, kThree);
  EXPECT_EQ(far.size(), 0u) << "the lowest that is left may lead next, and remains a member";
  ASSERT_NE(members.find(kFive), nullptr);
  EXPECT_FALSE(members.find(kFive)->is_near);
  (void)members.note_far(host(3s), kTwo, 8);
  members.find_far(kTwo)->expected_until = host(30s);
  members.find_far(kTwo)->synchronised = true;
  EXPECT_TRUE(members.expire(host(3s), {}, std::nullopt, &far).empty());
  EXPECT_EQ(far, std::vector{kFive});
  ASSERT_NE(members.find_far(kFive), nullptr);
  EXPECT_EQ(members.find_far(kFive)->name, "five");
  EXPECT_TRUE(members.contains(kFive));
  EXPECT_EQ(members.count(), 2u);
}

// A peer whose objects this peer receives says there that it is here. It is silent, and lost.
TEST(Membership, WhoIsToBeHeardIsLost) {
  Membership members(2s, kLarge);
  for (PeerId p : {kTwo, kThree}) {
    members.on_datagram(host(0s), p, 7);
    members.find(p)->expected_until = host(30s);
  }
  const auto lost = members.expire(
      host(2s), [](PeerId p) { return p == kThree; }, std::nullopt, nullptr);
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].first, kThree);
  EXPECT_FALSE(members.contains(kThree));
}

TEST(Membership, AFarPeerComesNearAsItIs) {
  Membership members(2s, kLarge);
  const auto [far, is_new] = members.note_far(host(0s), kFive, 7);
  EXPECT_TRUE(is_new);
  EXPECT_FALSE(members.note_far(host(1s), kFive, 7).second);
  far->name = "five";
  far->owned = {ObjectId{3}, ObjectId{9}};
  far->expected_until = host(10s);
  EXPECT_EQ(members.far_owner(ObjectId{9}), kFive);
  EXPECT_EQ(members.far_owner(ObjectId{4}), kNobody);
  const Member& member = members.promote(host(2s), kFive, true);
  EXPECT_EQ(member.name, "five");
  EXPECT_EQ(member.since, host(0s));
  EXPECT_EQ(members.find_far(kFive), nullptr);
  EXPECT_EQ(members.on_datagram(host(2s), kFive, 7), Admission::kKnown);
}

TEST(Membership, AFarPeerWhoseHellosCeaseIsLostOnce) {
  Membership members(2s, kLarge);
  members.note_far(host(0s), kFive, 7).first->expected_until = host(10s);
  EXPECT_TRUE(members.expire_far(host(9s)).empty());
  EXPECT_EQ(members.expire_far(host(11s)).size(), 1u);
  EXPECT_TRUE(members.expire_far(host(13s)).empty());
}

// Peer 5 has promised its next hello for what it knew of then: three peers. There are a hundred now, each of which says
// hello every ten seconds.
void note_five_and_a_hundred(Membership& members) {
  FarPeer& five = *members.note_far(host(0s), kFive, 7).first;
  five.expected_until = host(4s);
  five.promises_hellos = true;
  five.far_hello.receive(1, host(0s));
  for (std::uint32_t p = 6; p <= 104; ++p) members.note_far(host(0s), PeerId{p}, 1).first->expected_until = host(90s);
}

TEST(Membership, AFarPeerIsWaitedForAsLongAsManyPeersTake) {
  Membership members(2s, kLarge);
  note_five_and_a_hundred(members);
  EXPECT_TRUE(members.expire_far(host(41s)).empty());
  EXPECT_EQ(members.expire_far(host(43s)).size(), 1u) << "four mean intervals, and what makes any peer lost";
}

// The same of one that has come near for a moment: an operation of its may have come to all.
TEST(Membership, AMemberThatWasFarIsWaitedForAsLong) {
  Membership members(2s, kLarge);
  note_five_and_a_hundred(members);
  members.promote(host(3s), kFive, true);
  std::vector<PeerId> far;
  EXPECT_TRUE(members.expire(host(6s), {}, std::nullopt, &far).empty()) << "not lost";
  EXPECT_EQ(far, std::vector{kFive});
}

// A peer that has just come hears one that is near, and moves away, before its first far hello.
TEST(Membership, WhoSaysWhatIsNearbySaysFarHellosToo) {
  Membership members(2s, kLarge);
  for (PeerId p : {kTwo, kThree, kFive}) members.on_datagram(host(0s), p, 7);
  members.find(kFive)->received[kNearby].on_datagram(1);
  members.find(kFive)->channel = RegionId{4};  // its last datagram was an update
  std::vector<PeerId> far;
  EXPECT_EQ(members.expire(host(2s), {}, kFive, &far).size(), 2u);
  ASSERT_NE(members.find(kFive), nullptr);
  EXPECT_EQ(members.find(kFive)->is_near, false) << "it is followed";
  EXPECT_GT(members.next_expiry(), host(2s)) << "a driver that sleeps until then would never sleep";
  EXPECT_TRUE(members.expire(host(2s), {}, std::nullopt, &far).empty());
  EXPECT_EQ(far, std::vector{kFive});
  EXPECT_TRUE(members.expire_far(host(2s)).empty());
}

TEST(Membership, WhoLeadsIsMissedAsSoonAsItsHellosCease) {
  Membership members(2s, kLarge);
  members.on_datagram(host(0s), kFive, 7);
  Member& five = *members.find(kFive);
  five.received[kNearby].on_datagram(1);
  five.leads = five.synchronised = true;
  five.expected_until = host(3s);
  EXPECT_TRUE(members.expire(host(2s), {}, kFive).empty());
  EXPECT_EQ(members.next_expiry(), host(3s));
  EXPECT_EQ(members.expire(host(3s), {}, kFive).size(), 1u);
}

// Nobody leads, or is waited for, who has no session time: it may hear nothing.
TEST(Membership, TheLowestIsOneThatHasJoined) {
  Membership members(2s, kLarge);
  members.on_datagram(host(0s), kTwo, 7);
  (void)members.note_far(host(0s), kThree, 7);
  EXPECT_EQ(members.lowest(), std::nullopt);
  members.note_far(host(0s), kFive, 7).first->synchronised = true;
  EXPECT_EQ(members.lowest(), kFive);
  members.find_far(kThree)->synchronised = true;
  EXPECT_EQ(members.lowest(), kThree);
  members.find(kTwo)->synchronised = true;
  EXPECT_EQ(members.lowest(), kTwo);
  EXPECT_EQ(members.find_any(kTwo), members.find(kTwo));
  EXPECT_EQ(members.find_any(kThree), members.find_far(kThree));
  EXPECT_EQ(members.find_any(PeerId{4}), nullptr);
}

TEST(Membership, TheStartIsKnownOfFarPeersToo) {
  Membership members(2s, kLarge);
  members.on_datagram(host(0s), kThree, 7);
  EXPECT_EQ(members.announced_start(), std::nullopt);
  members.find(kThree)->start = SimTime{5s};
  EXPECT_EQ(members.announced_start(), SimTime{5s});
  members.note_far(host(0s), kTwo, 7).first->start = SimTime{4s};
  EXPECT_EQ(members.announced_start(), SimTime{4s});
}

// 37 to 48 peers: some have seen a 49th and others have not.
TEST(Membership, WhoComesToALargeSessionTakesItForOne) {
  Membership members(2s, {.above = 4, .hellos_per_s = 10.0});
  for (std::uint32_t p = 2; p <= 4; ++p) members.on_datagram(host(0s), PeerId{p}, 1);
  EXPECT_FALSE(members.follow_size(true));
  members.find(kThree)->echoes_on = kNearby;
  EXPECT_TRUE(members.follow_size(true));
  EXPECT_TRUE(members.is_large());
}

TEST(Membership, ASessionIsLargeUntilAQuarterFewerAreHere) {
  Membership members(2s, {.above = 4, .hellos_per_s = 10.0});
  for (std::uint32_t p = 2; p <= 4; ++p) members.on_datagram(host(0s), PeerId{p}, 1);
  EXPECT_FALSE(members.follow_size(true)) << "four are not more than four";
  (void)members.note_far(host(0s), kFive, 1);
  EXPECT_FALSE(members.follow_size(false)) << "this peer is not in the session";
  EXPECT_TRUE(members.follow_size(true));
  EXPECT_TRUE(members.is_large());
  EXPECT_EQ(members.channel(), kNearby);
  (void)members.remove_far(kFive);
  EXPECT_FALSE(members.follow_size(true));
  (void)members.remove(PeerId{4});
  EXPECT_TRUE(members.follow_size(true));
  EXPECT_FALSE(members.is_large());
}

TEST(Membership, RemovesOnce) {
  Membership members(2s);
  for (PeerId p : {kFive, kTwo, kThree}) members.on_datagram(host(0s), p, 1);
  EXPECT_TRUE(members.remove(kThree).has_value());
  EXPECT_FALSE(members.remove(kThree).has_value());
}

}  // namespace peerd::replication::membership_test
