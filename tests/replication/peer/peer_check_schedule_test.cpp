#include <gtest/gtest.h>

#include "replication/peer/peer.hpp"
#include "tests/replication/peer/lan.hpp"

// These tests count which of its own objects a peer checks at each tick. It skips an object that physics moves while
// the object rests, until an update could be due.
namespace peerd::replication::peer_looks_test {

using namespace test;

const char* const kPushed = " collisionResponse CollisionResponse { responseType 2 } ";
const std::string kThree = box("A", "1 1 1", "-4 0 0", kPushed) + box("B", "1 1 1", "0 0 0", kPushed) +
                           box("C", "1 1 1", "4 0 0", kPushed) + interest("A", "\"B\"") + interest("B", "\"A\"");

std::uint64_t checks(const Lan& lan) { return lan.peer(0).counters().objects_looked_at; }
std::size_t updates_of(const Lan& lan, ObjectId object, PublishReason reason) {
  std::size_t count = 0;
  for (const Published& p : lan.seen<Published>(0)) count += p.object == object && p.reason == reason;
  return count;
}

// The first peer runs A and B, the second runs nothing. Both objects have been resting for ten seconds and more.
struct Resting {
  explicit Resting(const World& world, const std::function<void(PeerConfig&)>& change = {}, std::uint32_t id = 1)
      : lan(world, {5ms, 0ms, 0, 0}) {
    for (const std::uint32_t i : {id, id + 1}) {
      PeerConfig c = config(i);
      if (i == id) c.owned = {{world["A"], false}, {world["B"], false}};
      if (change) change(c);
      lan.add(c);
    }
    lan.run_until(15s);
    const std::uint64_t before = checks(lan);
    lan.run_until(16s);
    EXPECT_EQ(checks(lan), before);
  }
  Lan lan;
};

TEST(CheckSchedule, GoOnWhereSomethingMovesAndEndWhenItRests) {
  const World world(kThree);
  Resting run(world);
  Lan& lan = run.lan;
  const auto set_velocity = [&](const Vec3& v) {
    ASSERT_TRUE(lan.peer(0).change_velocity(lan.host_now(0), world["B"], v, true));
  };
  const std::uint64_t before = checks(lan);
  set_velocity({0, 1, 0});
  lan.run_until(18s);
  EXPECT_NEAR(static_cast<double>(checks(lan) - before), 120.0, 3.0) << "B alone";
  set_velocity({0, 0, 0});
  lan.run_until(20s);
  const std::uint64_t after = checks(lan);
  lan.run_until(22s);
  EXPECT_EQ(checks(lan), after);
  EXPECT_NEAR(lan.peer(1).ghost(world["B"], lan.session_now(1)).position.y(), 2.0, 0.05);
}

// Nobody predicts contacts: the ghosts of other objects say nothing about a hit.
TEST(CheckSchedule, FindAnObjectHitByAnotherOwnObject) {
  const World world(kThree);
  Resting run(world, [](PeerConfig& c) { c.policy.predict_collisions = false; });
  Lan& lan = run.lan;
  ASSERT_TRUE(lan.peer(0).change_velocity(lan.host_now(0), world["A"], {2, 0, 0}, true));
  lan.run_until(19s);
  const SimTime now = lan.session_now(1);
  EXPECT_GT(lan.peer(0).truth(world["B"], now).position.x(), 1.0);
  EXPECT_NEAR(lan.peer(1).ghost(world["B"], now).position.x(), lan.peer(0).truth(world["B"], now).position.x(), 0.6);
}

// The other peer's C turns away just before it hits A. The update takes 400 ms, during which all ghosts of A have been
// hit.
TEST(CheckSchedule, FindAnObjectWhoseGhostWasHitWithoutEffect) {
  const World world(kThree + interest("A", "\"C\"") + interest("C", "\"A\""));
  Lan lan(world, {400ms, 0ms, 0, 0});
  const auto passing = [](SimTime t) {
    const double s = to_seconds(t.time_since_epoch() - kEpoch - 20s), turns_s = 3.4;
    if (s < 0.0) return moving({4, 0, 0});
    if (s < turns_s) return moving({4 - 2 * s, 0, 0}, {-2, 0, 0});
    return moving({4 - 2 * turns_s, 4 * (s - turns_s), 0}, {0, 4, 0});
  };
  lan.add(config(2, {{world["A"], false}}));
  lan.add(config(1, {{world["C"], true}}), 0s, {{world["C"], passing}});
  double worst_m = 0.0;
  for (Duration t = 20s; t < 26s; t += 50ms) {
    lan.run_until(t);
    const SimTime now = lan.session_now(0);
    const Vec3 truth = lan.peer(0).truth(world["A"], now).position;
    ASSERT_EQ(truth, Vec3(-4, 0, 0));
    worst_m = std::max(worst_m, (lan.peer(0).ghost(world["A"], now).position - truth).norm());
  }
  EXPECT_GE(updates_of(lan, world["A"], PublishReason::kError), 1u);
  EXPECT_LT(worst_m, 0.05) << "the tight threshold, and a tick";
}

constexpr Duration kTwoTicks = 34ms;

TEST(CheckSchedule, FindStatesThatAJoiningPeerMayNotHold) {
  const World world(kThree);
  Resting run(world);
  std::optional<Duration> in_session;
  run.lan.on_send = [&](std::size_t from, RegionId, const Message& m) {
    if (from == 2 && m.hello && m.hello->sessions > 0 && !in_session) in_session = run.lan.now();
  };
  run.lan.add(config(3));
  while (!in_session && run.lan.now() < 20s) run.lan.run_until(run.lan.now() + 1ms);
  ASSERT_TRUE(in_session.has_value());
  run.lan.run_until(*in_session + 5ms + kTwoTicks);
  for (const char* name : {"A", "B"}) EXPECT_EQ(updates_of(run.lan, world[name], PublishReason::kJoiner), 2u) << name;
}

TEST(CheckSchedule, FindAnObjectWhoseTimeThresholdHasPassed) {
  const World world(kThree);
  Resting run(world);
  run.lan.run_until(200s);
  EXPECT_EQ(updates_of(run.lan, world["A"], PublishReason::kTime), 3u) << "once a minute";
  EXPECT_EQ(updates_of(run.lan, world["A"], PublishReason::kError), 0u);
}

// A joining peer has acknowledged nothing: the shorter time threshold holds again, and is over.
TEST(CheckSchedule, FindThatAnUpdateIsNoLongerAcknowledgedByAll) {
  const World world(kThree);
  Resting run(world);
  Message m = hello_of(9, run.lan.host_now(0));
  m.hello->session_tx.reset();
  ASSERT_TRUE(run.lan.inject(0, encode(m)).has_value());
  run.lan.run_until(16s + kTwoTicks);
  for (const char* name : {"A", "B"}) EXPECT_EQ(updates_of(run.lan, world[name], PublishReason::kTime), 1u) << name;
}

TEST(CheckSchedule, GoOnWhereSnapshotsAreSent) {
  const World world(kThree);
  Lan lan(world);
  PeerConfig c = config(1, {{world["A"], false}});
  c.policy.snapshots_hz = 20;
  lan.add(c);
  lan.add(config(2));
  lan.run_until(15s);
  const std::size_t before = updates_of(lan, world["A"], PublishReason::kTime);
  lan.run_until(16s);
  EXPECT_EQ(updates_of(lan, world["A"], PublishReason::kTime) - before, 20u);
}

}  // namespace peerd::replication::peer_looks_test
