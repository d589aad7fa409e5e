#include "replication/session/member_limits.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::member_limits_test {

using namespace test;

class Limits : public testing::Test {
 protected:
  PeerCounters counters;
  Membership members{1750ms};
  Outbox outbox{PeerId{1}, 100, counters};
  MemberLimits limits{members, outbox, counters};
};

TEST_F(Limits, AreCountedAlwaysAndNamedOnceAMinute) {
  add_member(members, 2);
  add_member(members, 3);
  for (int s = 0; s < 61; ++s) limits.refuse(host(1s * s), PeerId{2}, MemberLimit::kClockAhead);
  limits.refuse(host(61s), PeerId{3}, MemberLimit::kClockAhead);
  const auto named = drain<LimitMet>(outbox);
  ASSERT_EQ(named.size(), 3u);
  EXPECT_EQ(named[0].peer, PeerId{2});
  EXPECT_EQ(named[0].times, 1u);
  EXPECT_EQ(named[1].times, 60u) << "since the last time";
  EXPECT_EQ(named[2].peer, PeerId{3}) << "each member for itself";
  EXPECT_EQ(counters.drops["clock_ahead"], 62u);
  EXPECT_EQ(members.find(PeerId{2})->drops["clock_ahead"], 61u);
  EXPECT_EQ(members.find(PeerId{3})->drops["clock_ahead"], 1u);
}

TEST_F(Limits, ARestartForgetsNothing) {
  add_member(members, 2);
  limits.refuse(host(0s), PeerId{2}, MemberLimit::kClockAhead);
  members.remove(PeerId{2});
  add_member(members, 2);
  limits.refuse(host(1s), PeerId{2}, MemberLimit::kClockAhead);
  EXPECT_EQ(drain<LimitMet>(outbox).size(), 1u);
}

// Each far peer of a large session says hello now and then.
TEST_F(Limits, FarPeersLeaveNothing) {
  add_member(members, 2);
  EXPECT_TRUE(limits.take(host(0s), PeerId{2}, MemberLimit::kDatagrams));
  limits.refuse(host(0s), PeerId{3}, MemberLimit::kClockAhead);
  for (std::uint32_t id = 100; id < 2100; ++id) {
    members.note_far(host(0s), PeerId{id}, 1);
    EXPECT_TRUE(limits.take(host(10ms * id), PeerId{id}, MemberLimit::kDatagrams));
  }
  EXPECT_LT(limits.states(), 600u);
  limits.refuse(host(22s), PeerId{3}, MemberLimit::kClockAhead);
  EXPECT_EQ(drain<LimitMet>(outbox).size(), 1u) << "what was named is remembered for a minute";
}

}  // namespace peerd::replication::member_limits_test
