// One member does to the others what it can, against the limits of it (docs/security.md, What a member can do).
#include <gtest/gtest.h>

#include "replication/peer/operation_limits.hpp"
#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::hostile_member_test {

using namespace test;

// Peer 5 owns CUBE, peer 6 owns VAN. Peer 1 is hostile and owns CAR, which stands beside CUBE. All have been here for
// so long that each knows where everything is.
class HostileMember : public testing::Test {
 protected:
  HostileMember() {
    lan.add(config(5, {{world["CUBE"]}}));
    lan.add(config(6, {{world["VAN"]}}));
    lan.add(config(1, {{world["CAR"]}}));
    lan.run_until(15s);
  }

  [[nodiscard]] Message from_hostile() {
    Message m = message_of(1, incarnation_low(100));
    m.number = ++number_;
    return m;
  }
  [[nodiscard]] Message hello_from_hostile() {
    Message m = from_hostile();
    Hello& hello = m.hello.emplace();
    hello.session_tx = lan.session_now(0);
    hello.clock_error = 5ms;
    hello.sessions = 1;
    return m;
  }
  [[nodiscard]] Message introduction_from_hostile(std::uint64_t incarnation) {
    Message m = hello_from_hostile();
    m.incarnation = incarnation;
    m.hello->introduction.emplace();
    m.hello->introduction->name = "peer1";
    m.hello->introduction->world_hash = 0xC0FFEE;
    return m;
  }
  // The first honest peer receives it.
  std::expected<void, Drop> inject(const Message& m) { return lan.inject(0, encode(m)); }
  [[nodiscard]] DecisionRecord decision(const Vec3& cube, const Vec3& car, const Vec3& cube_after, const Vec3& velocity,
                                        Duration ago = 100ms) const {
    return {world["CUBE"],    world["CAR"], lan.session_now(0) - ago,     Vec3::UnitX(),
            moving(cube),     moving(car),  moving(cube_after, velocity), moving(car),
            DecisionRule::kId};
  }
  void decide(const DecisionRecord& d) {
    Message m = from_hostile();
    m.decisions = {d};
    (void)inject(m);
  }
  [[nodiscard]] KinematicState cube() const { return lan.peer(0).truth(world["CUBE"], lan.session_now(0)); }
  // How often the limit was met, and that it was named once.
  [[nodiscard]] std::uint64_t met(MemberLimit limit) const {
    std::uint64_t named = 0;
    for (const LimitMet& each : lan.seen<LimitMet>(0)) {
      EXPECT_EQ(each.peer, PeerId{1});
      if (each.limit == limit) ++named;
    }
    EXPECT_LE(named, 1u) << to_string(limit);
    const std::uint64_t counted = lan.drops(0, to_string(limit));
    EXPECT_EQ(named > 0, counted > 0) << to_string(limit);
    return counted;
  }

  World world{box("CAR", "1 1 1", "2 0 0") + box("CUBE", "1 1 1", "0 0 0", kBounces) + box("VAN", "1 1 1", "9 -9 9") +
              interest("CUBE", "\"CAR\" \"VAN\"")};
  Lan lan{world};

 private:
  std::uint32_t number_ = 1'000'000;
};

// ---- decisions on others' objects ----

TEST_F(HostileMember, HonestPeersMeetNoLimit) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(lan.seen<LimitMet>(i).empty());
}

TEST_F(HostileMember, MayDecideWhatItsObjectHits) {
  decide(decision({0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {-2, 0, 0}));
  EXPECT_EQ(cube().velocity, Vec3(-2, 0, 0));
}

TEST_F(HostileMember, PutsNobodysObjectElsewhere) {
  decide(decision({1e6, 0, 0}, {1e6 + 1, 0, 0}, {1e6, 0, 0}, {0, 0, 0}));
  EXPECT_EQ(met(MemberLimit::kDecisionElsewhere), 1u);
  decide(decision({0, 0, 0}, {1, 0, 0}, {0, 1e6, 0}, {0, 0, 0}, 90ms));
  EXPECT_EQ(met(MemberLimit::kDecisionElsewhere), 2u);
  EXPECT_EQ(cube().position, Vec3(0, 0, 0));
}

// When the decision comes nobody knows the pair yet, and nothing of it can be checked.
TEST(HostileMemberBeforeAnEdit, PutsNobodysObjectElsewhere) {
  const World world{box("CAR", "1 1 1", "2 0 0") + box("CUBE", "1 1 1", "0 0 0", kBounces)};
  const ObjectId car = world["CAR"], cube = world["CUBE"];
  Lan lan{world};
  lan.add(config(5, {{cube}}));
  lan.add(config(1, {{car}}));
  lan.run_until(15s);
  const AddNodes pair{{}, {}, "#VRML V2.0 utf8\n" + interest("CUBE", "\"CAR\""), 0, 0, {{"CUBE", cube}, {"CAR", car}}};
  ASSERT_TRUE(lan.peer(0).edit(lan.host_now(0), pair));
  Message m = message_of(1, incarnation_low(100));
  m.number = 1'000'000;
  m.decisions.push_back({cube, car, lan.session_now(0) + 200ms, Vec3::UnitX(), moving({1e6, 0, 0}),
                         moving({1e6 + 1, 0, 0}), moving({1e6, 0, 0}), moving({1e6 + 1, 0, 0}), DecisionRule::kId});
  ASSERT_TRUE(lan.inject(0, encode(m)));
  EXPECT_EQ(lan.peer(0).counters().records_early, 1u);
  lan.run_until(16s);
  EXPECT_EQ(lan.drops(0, to_string(MemberLimit::kDecisionElsewhere)), 1u);
  EXPECT_EQ(lan.peer(0).truth(cube, lan.session_now(0)).position, Vec3(0, 0, 0));
}

TEST_F(HostileMember, DecidesNothingOnWhatIsFarApart) {
  decide(decision({0, 0, 0}, {-1e6, 0, 0}, {0, 0, 0}, {9, 0, 0}));
  EXPECT_EQ(met(MemberLimit::kDecisionImpossible), 1u);
  EXPECT_EQ(cube().velocity, Vec3::Zero());
}

TEST_F(HostileMember, GivesNobodysObjectAnySpeed) {
  decide(decision({0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1e6, 0, 0}));
  DecisionRecord fast = decision({0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1e6, 0, 0}, 90ms);
  fast.collidee_before.velocity = fast.collidee_after.velocity = {1e6, 0, 0};  // it says that its own was so fast
  decide(fast);
  EXPECT_EQ(met(MemberLimit::kDecisionImpossible), 2u);
  EXPECT_EQ(cube().velocity, Vec3::Zero());
}

TEST_F(HostileMember, DecisionsAreLimited) {
  constexpr int kAtOnce = 1000, kEach = 20;
  for (int i = 0; i < kAtOnce; ++i) {
    Message m = from_hostile();
    for (int k = 0; k < kEach; ++k) {
      DecisionRecord d = decision({0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0});
      d.contact += std::chrono::nanoseconds(kEach * i + k);
      d.collidee_before = d.collidee_after = d.collider_before = d.collider_after = {};
      m.decisions.push_back(d);
    }
    (void)inject(m);
  }
  EXPECT_EQ(met(MemberLimit::kDecisions),
            kAtOnce * kEach - static_cast<std::uint64_t>(rate_of(MemberLimit::kDecisions)->burst));
}

// ---- the future ----

// A peer that has just stepped into a later session does the same, until its hello is here.
TEST_F(HostileMember, PublishesNothingOfTheFuture) {
  const auto forge = [&] {
    Message m = from_hostile();
    m.updates.push_back({world["CAR"], 1000, lan.session_now(0) + 5s, moving({99, 0, 0})});
    (void)inject(m);
    decide(decision({0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {9, 0, 0}, -5s));
  };
  forge();
  EXPECT_EQ(met(MemberLimit::kStampAhead), 0u);
  EXPECT_EQ(lan.drops(0, "update_time") + lan.drops(0, "decision_time"), 2u);
  lan.run_until(20s);
  forge();
  EXPECT_EQ(met(MemberLimit::kStampAhead), 2u);
  lan.run_until(26s);
  EXPECT_EQ(cube().velocity, Vec3::Zero());
  EXPECT_EQ(lan.peer(0).ghost(world["CAR"], lan.session_now(0)).position, Vec3(2, 0, 0));
}

// What was ahead long ago may have been a step into a later session.
TEST_F(HostileMember, AMinuteAgoIsNotForgottenAndLongerAgoIs) {
  const auto forge = [&] {
    Message m = from_hostile();
    m.updates.push_back({world["CAR"], 1000, lan.session_now(0) + 5s, moving({99, 0, 0})});
    (void)inject(m);
    return met(MemberLimit::kStampAhead);
  };
  EXPECT_EQ(forge(), 0u) << "at 15 s";
  lan.run_until(75s);
  EXPECT_EQ(forge(), 1u);
  lan.run_until(75s + 1ns);
  EXPECT_EQ(forge(), 1u) << "the first of a new minute";
}

TEST_F(HostileMember, OperationsOfTheFutureAreNamedAndWait) {
  Message m = from_hostile();
  const Operation operation{{AuthorId{77}, 1}, lan.session_now(0) + 1h, RemoveObject{world["CAR"]}};
  m.operations.push_back({AuthorId{77}, 0, encode(operation)});
  EXPECT_TRUE(inject(m));
  lan.run_until(16s);
  EXPECT_EQ(met(MemberLimit::kOperationAhead), 1u);
  EXPECT_TRUE(lan.peer(0).scene().find("CAR"));
  EXPECT_EQ(lan.peer(1).logs().last(AuthorId{77}).number, 1u) << "all hold it, so that no log forks";
}

// ---- floods ----

TEST_F(HostileMember, DatagramsAreLimited) {
  const auto burst = static_cast<std::uint64_t>(rate_of(MemberLimit::kDatagrams)->burst);
  const Bytes datagram = encode(from_hostile());
  for (std::uint64_t i = 0; i < burst + 1000; ++i) (void)lan.inject(0, datagram);
  EXPECT_GE(met(MemberLimit::kDatagrams), 990u);
  lan.run_until(16s);
  EXPECT_TRUE(lan.peer(0).members().contains(PeerId{6})) << "of this member alone";
  EXPECT_EQ(lan.inject(0, datagram), (std::expected<void, Drop>{})) << "it is heard again";
}

TEST_F(HostileMember, RestartsAreLimited) {
  for (std::uint64_t boot = 101; boot < 201; ++boot) (void)inject(introduction_from_hostile(boot));
  const auto burst = static_cast<std::uint64_t>(rate_of(MemberLimit::kRestarts)->burst);
  EXPECT_GE(met(MemberLimit::kRestarts), 99 - burst);
  EXPECT_LE(lan.seen<PeerJoined>(0).size(), 2 + burst);
}

// Each new session of a member makes everybody publish all that they own anew.
TEST_F(HostileMember, MakesOthersPublishAnewOnlySoOften) {
  const std::uint64_t before = lan.peer(0).counters().updates_out;
  for (std::uint32_t i = 0; i < 300; ++i) {
    Message m = hello_from_hostile();
    m.hello->sessions = 2 + i;
    (void)inject(m);
    lan.run_until(lan.now() + 20ms);
  }
  const LimitRate rate = *rate_of(MemberLimit::kResends);
  EXPECT_GE(met(MemberLimit::kResends), 200u);
  EXPECT_LT(lan.peer(0).counters().updates_out - before, rate.burst + rate.per_s * 6 + 10);
}

TEST_F(HostileMember, ClaimsAreLimited) {
  // Peer 1 has the lowest id, and would have the better claim: as a founder it gives way.
  for (int i = 0; i < 20'100; ++i) {
    Message m = introduction_from_hostile(100);
    m.hello->introduction->owned = {world["VAN"]};
    m.hello->introduction->owned_as_founder = 1;
    (void)inject(m);
  }
  EXPECT_GE(met(MemberLimit::kClaims), 50u);
  EXPECT_EQ(lan.peer(0).owner(world["VAN"]), PeerId{6});
}

// ---- operations ----

TEST_F(HostileMember, TheBytesOfOperationsAreLimited) {
  const auto burst = static_cast<std::uint64_t>(rate_of(MemberLimit::kOperations)->burst);
  const std::vector<std::byte> bytes(1000, std::byte{1});
  Message m = from_hostile();
  m.operations.push_back({AuthorId{77}, 1'000, bytes});
  for (std::uint64_t sent = 0; sent < burst + 100'000; sent += bytes.size()) (void)inject(m);
  EXPECT_GE(met(MemberLimit::kOperations), 95u);
}

TEST_F(HostileMember, ALogHasAGreatestLength) {
  Message m = from_hostile();
  m.operations.push_back({AuthorId{77}, MemberLimits::kLogMax_bytes, std::vector<std::byte>(10)});
  (void)inject(m);
  EXPECT_EQ(met(MemberLimit::kLogLength), 1u);
}

TEST_F(HostileMember, TwoDifferentLogsOfOneAuthorAreCounted) {
  const std::uint64_t operations = lan.peer(0).counters().operations_in;
  for (const std::byte third : {std::byte{5}, std::byte{6}}) {  // of an operation of 255 bytes
    Message m = from_hostile();
    m.operations.push_back({AuthorId{77}, 0, {std::byte{0xFF}, std::byte{0x01}, third}});
    ASSERT_TRUE(inject(m));
  }
  EXPECT_EQ(lan.drops(0, "forked_log"), 1u);
  EXPECT_EQ(lan.peer(0).counters().operations_in, operations);
}

TEST_F(HostileMember, NamesOnlySoManyAuthors) {
  constexpr std::uint32_t kEach = 128;
  for (std::uint32_t first = 1000; first < 21'000; first += kEach) {
    Message m = hello_from_hostile();
    for (std::uint32_t k = 0; k < kEach; ++k) m.hello->logs.push_back({AuthorId{first + k}, 1'000'000});
    (void)inject(m);
  }
  EXPECT_GE(met(MemberLimit::kAuthors), 20'000 - OperationLimits::kUnknownMax);
}

TEST_F(HostileMember, QuestionsAreLimited) {
  Message m = from_hostile();
  for (std::uint32_t k = 0; k < 32; ++k) m.operation_requests.push_back({AuthorId{1000 + k}, 0, 1000});
  for (int i = 0; i < 600; ++i) (void)inject(m);
  EXPECT_EQ(met(MemberLimit::kRequests), 100u);
}

TEST_F(HostileMember, SubscriptionsAreLimited) {
  Message m = from_hostile();
  for (std::uint32_t k = 1; k <= 100; ++k) m.subscriptions.push_back({RegionId{k}, lan.session_now(0)});
  for (int i = 0; i < 300; ++i) (void)inject(m);
  EXPECT_GE(met(MemberLimit::kSubscriptions), 99u);
}

}  // namespace peerd::replication::hostile_member_test
