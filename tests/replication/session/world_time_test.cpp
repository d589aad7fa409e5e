#include "replication/session/world_time.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::world_time_test {

using namespace test;

constexpr PeerId kTwo{2}, kThree{3};

TEST(WorldTime, BeginsWithTheFirstAnnouncedStart) {
  WorldTime time;
  EXPECT_FALSE(time.zero() || time.start());
  time.announce_start(sim(5s));
  EXPECT_EQ(time.zero(), sim(5s));
  EXPECT_EQ(time.start(), sim(5s));
  time.announce_start(sim(9s));
  EXPECT_EQ(time.zero(), sim(5s)) << "the session has one already";
  EXPECT_EQ(time.start(), sim(9s));
}

TEST(WorldTime, AnybodyMaySayItFirstAndThenOnlyTheFollowedPeer) {
  WorldTime time;
  EXPECT_TRUE(time.on_zero(kThree, kTwo, sim(5s)));
  EXPECT_FALSE(time.on_zero(kThree, kTwo, sim(6s)));
  EXPECT_EQ(time.zero(), sim(5s));
  EXPECT_FALSE(time.on_zero(kTwo, kTwo, sim(5s))) << "nothing new";
  EXPECT_TRUE(time.on_zero(kTwo, kTwo, sim(7s)));
  EXPECT_EQ(time.zero(), sim(7s));
  EXPECT_FALSE(time.on_zero(kTwo, std::nullopt, sim(8s)));
}

TEST(WorldTime, InAnotherSessionOnlyItsSourceOrTheFollowedPeerCounts) {
  WorldTime time;
  time.announce_start(sim(5s));
  time.on_other_session(100s, kThree);
  EXPECT_EQ(time.zero(), std::nullopt);
  EXPECT_FALSE(time.on_zero(PeerId{4}, kTwo, sim(50s))) << "it may be of the old session";
  EXPECT_TRUE(time.on_zero(kThree, kTwo, sim(60s)));
  EXPECT_EQ(time.zero(), sim(60s));
}

TEST(WorldTime, GoesOnAsBeforeWhereItsSourceLeavesWithoutSayingIt) {
  WorldTime time;
  time.announce_start(sim(5s));
  time.on_other_session(100s, kThree);
  time.on_other_session(10s, kThree);  // once more before it was said
  EXPECT_FALSE(time.on_peer_lost(kTwo));
  EXPECT_TRUE(time.on_peer_lost(kThree));
  EXPECT_EQ(time.zero(), sim(115s)) << "by today's session time";
  EXPECT_FALSE(time.on_peer_lost(kThree)) << "once";
}

TEST(WorldTime, ASourceThatHasSaidItMayLeave) {
  WorldTime time;
  time.announce_start(sim(5s));
  time.on_other_session(100s, kThree);
  ASSERT_TRUE(time.on_zero(kThree, kThree, sim(60s)));
  EXPECT_FALSE(time.on_peer_lost(kThree));
  EXPECT_EQ(time.zero(), sim(60s));
}

TEST(WorldTime, AfterItsSourceHasLeftAnybodyMaySayIt) {
  WorldTime time;
  time.on_other_session(100s, kThree);
  EXPECT_FALSE(time.on_zero(kTwo, std::nullopt, sim(1s)));
  EXPECT_TRUE(time.on_peer_lost(kThree));
  EXPECT_EQ(time.zero(), std::nullopt) << "there was none before";
  EXPECT_TRUE(time.on_zero(kTwo, std::nullopt, sim(1s)));
}

}  // namespace peerd::replication::world_time_test
