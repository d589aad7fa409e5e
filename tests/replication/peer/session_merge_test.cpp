#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"

// Two sessions that were founded apart meet: the one whose time is later continues, and the other's peers step forward
// into it.
namespace peerd::replication::session_merge_test {

using namespace test;

class SessionsMeet : public testing::TestWithParam<Duration> {};

TEST_P(SessionsMeet, TheEarlierPeerStepsOnceAndEverythingGoesOn) {
  const World world(box("A", "1 1 1", "0 0 0", "velocityVector 1 0 0") +
                    box("B", "1 1 1", "0 5 0", "velocityVector 0 0 2"));
  Lan lan(world);
  lan.add(config(1, {{world["A"], false}}));
  lan.add(config(2, {{world["B"], false}}), GetParam());
  lan.part({1});
  lan.run_until(4s);
  ASSERT_TRUE(lan.all_in_session());
  ASSERT_EQ(lan.session_now(1) - lan.session_now(0), GetParam());
  const KinematicState b_before = lan.peer(1).truth(world["B"], lan.session_now(1));

  lan.part({});
  lan.run_until(8s);
  const std::size_t earlier = GetParam() > 0s ? 0 : 1;
  EXPECT_EQ(lan.seen<ClockStepped>(1 - earlier).size(), 0u);
  ASSERT_EQ(lan.seen<ClockStepped>(earlier).size(), 1u);
  EXPECT_NEAR(to_seconds(lan.seen<ClockStepped>(earlier)[0].step), to_seconds(std::chrono::abs(GetParam())), 1e-3);
  EXPECT_LE(std::chrono::abs(lan.session_now(1) - lan.session_now(0)), 1ms);
  EXPECT_EQ(lan.peer(0).follows(), PeerId{1});
  EXPECT_EQ(lan.peer(1).follows(), PeerId{1}) << "the lower leads, whoever had to step";

  // B has neither stopped nor jumped on the way, and peer 1 knows where it is; the same holds for A at peer 2.
  const SimTime now = lan.session_now(0);
  const KinematicState b = lan.peer(1).truth(world["B"], now);
  EXPECT_NEAR(b.position.z() - b_before.position.z(), 2.0 * 4.0, 1e-6);
  EXPECT_LT((lan.peer(0).ghost(world["B"], now).position - b.position).norm(), 0.01);
  EXPECT_LT((lan.peer(1).ghost(world["A"], now).position - lan.peer(0).truth(world["A"], now).position).norm(), 0.01);
  EXPECT_GT(lan.peer(1).counters().ticks, 7u * 55u);  // it has not waited for the old time to come again
}
// Until the other peer has stepped into this session, it publishes no state of its objects here, so nothing collides
// with them at their places in the file.
TEST(SessionsMeeting, NothingCollidesWithUnpublishedObjects) {
  const World world(box("BALL", "1 1 1", "-19 0 0", std::string(kBounces) + "velocityVector 5 0 0 ") +
                    box("BOX", "1 1 1", "0 0 0", std::string(kBounces) + "velocityVector 0 0 5 ") +
                    interest("BALL", "\"BOX\"") + interest("BOX", "\"BALL\""));
  Lan lan(world, {20ms});
  lan.add(config(1, {{world["BALL"], false}}), 30s);
  lan.add(config(2, {{world["BOX"], false}}));
  lan.part({1});
  lan.run_until(4s);
  lan.part({});
  Vec3 before = lan.peer(1).truth(world["BOX"], lan.session_now(1)).position;
  while (lan.now() < 9s) {
    lan.run_until(lan.now() + 10ms);
    const Vec3 at = lan.peer(1).truth(world["BOX"], lan.session_now(1)).position;
    ASSERT_LT((at - before).norm(), 0.2);
    before = at;
  }
  EXPECT_EQ(lan.peer(0).counters().decisions, 0u);
  EXPECT_EQ(lan.peer(0).owner(world["BOX"]), PeerId{2});
}

INSTANTIATE_TEST_SUITE_P(ClocksApart, SessionsMeet, testing::Values(3s, -3s, 30s, -30s));

}  // namespace peerd::replication::session_merge_test
