#include "replication/physics/laws/convergence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "replication/objects/contacts/decision.hpp"
#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::convergence_test {

using namespace test;

constexpr Duration kOver = 200ms, kFrame = 10ms;
constexpr auto kFree = [](const Vec3&, const Vec3&) { return true; };

// The ghost moves straight on at 2 m/s. At 1 s an update says that the object has turned, and is 0.6 m from the ghost.
KinematicState before(SimTime t) { return advance(moving({0, 0, 0}, {2, 0, 0}), to_seconds(t - sim(0s))); }
KinematicState after(SimTime t) {
  KinematicState turned = moving({2, 0.6, 0}, {1, 1, 0}, {0, 0.5, 0});
  turned.orientation = quat_exp({0, 0, 0.5});
  return advance(turned, to_seconds(t - sim(1s)));
}

struct Case {
  const char* name;
  ConvergenceMethod method;
  double largest_step_m;    // of a frame; the ghost's own is 0.02
  double largest_turn_m_s;  // change of velocity from frame to frame
};
class Converging : public testing::TestWithParam<Case> {};
TEST_P(Converging, GoesFromWhereItWasToTheGhostInTime) {
  Convergence convergence({GetParam().method, kOver});
  std::vector<Vec3> way;
  for (Duration t = 0s; t <= 1500ms; t += kFrame) {
    const bool updated = t >= 1s;
    const KinematicState ghost = updated ? after(sim(t)) : before(sim(t));
    const Pose shown = convergence.shown(sim(t), ghost, updated ? 1u : 0u, kFree);
    way.push_back(shown.position);
    const bool on_it = t < 1s || t >= 1s - kFrame + kOver || GetParam().method == ConvergenceMethod::kJump;
    if (on_it) {
      ASSERT_EQ(shown.position, ghost.position) << to_seconds(t);
      ASSERT_EQ(shown.orientation.coeffs(), ghost.orientation.coeffs());
    } else {
      ASSERT_LT((shown.position - ghost.position).norm(), 0.7);
    }
  }
  double step = 0.0, turn = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    step = std::max(step, (way[i] - way[i - 1]).norm());
    if (i > 1) turn = std::max(turn, (way[i] - 2.0 * way[i - 1] + way[i - 2]).norm() / to_seconds(kFrame));
  }
  EXPECT_LT(step, GetParam().largest_step_m);
  EXPECT_LT(turn, GetParam().largest_turn_m_s);
  if (GetParam().method == ConvergenceMethod::kJump) {
    EXPECT_GT(step, 0.5);
  }
}
INSTANTIATE_TEST_SUITE_P(Table, Converging,
                         testing::Values(Case{"Jump", ConvergenceMethod::kJump, 0.7, 70.0},
                                         Case{"Linear", ConvergenceMethod::kLinear, 0.06, 5.0},
                                         Case{"Cubic", ConvergenceMethod::kCubic, 0.08, 4.0},
                                         Case{"Parabola", ConvergenceMethod::kParabola, 0.1, 8.0}),
                         [](const auto& which) { return std::string(which.param.name); });

TEST(Convergence, OppositeOrientationsAreNoWay) {
  Convergence convergence({ConvergenceMethod::kLinear, kOver});
  KinematicState ghost = moving({0, 0, 0});
  (void)convergence.shown(sim(0s), ghost, 0, kFree);
  ghost.orientation = Quat(0, 0, 0, 1);  // half a turn
  for (Duration t = kFrame; t < 400ms; t += kFrame) {
    const Pose shown = convergence.shown(sim(t), ghost, 1, kFree);
    ASSERT_NEAR(shown.orientation.norm(), 1.0, 1e-12);
  }
}

TEST(Convergence, WhatMayNotPassJumps) {
  Convergence convergence({ConvergenceMethod::kLinear, kOver});
  (void)convergence.shown(sim(0s), moving({-1, 0, 0}), 0, kFree);
  const auto wall = [](const Vec3& from, const Vec3& to) { return (from.x() < 0) == (to.x() < 0); };
  const KinematicState behind = moving({1, 0, 0});
  bool jumped = false;
  for (Duration t = kFrame; t < 400ms; t += kFrame) {
    const Vec3 shown = convergence.shown(sim(t), behind, 1, wall).position;
    jumped |= shown == behind.position;
    ASSERT_TRUE(shown.x() < 0 || shown == behind.position);
  }
  EXPECT_TRUE(jumped);
  EXPECT_EQ(convergence.blocked(), 1u);
}

// The update says that the object was thrown over the wall half a second ago.
TEST(Convergence, WhatMayNotPassFollowsTheGhostsOwnWay) {
  for (const auto method : {ConvergenceMethod::kLinear, ConvergenceMethod::kCubic, ConvergenceMethod::kParabola}) {
    Convergence convergence({method, kOver});
    const SimTime thrown = sim(1s), heard = sim(1500ms);
    const KinematicState ball = moving({-5, 0, 0}, {20, 15, 0}, {0, -30, 0});
    const auto over = [&](SimTime t) {
      return t < thrown ? at_rest(ball.pose()) : advance(ball, to_seconds(t - thrown));
    };
    const auto was = [&](SimTime t) { return std::optional(over(t).pose()); };
    // The path leads up to y = 2 at x = 0.
    const auto wall = [](const Vec3& from, const Vec3& to) {
      if ((from.x() < 0) == (to.x() < 0)) return true;
      return from.y() + (to.y() - from.y()) * from.x() / (from.x() - to.x()) > 2.0;
    };
    Vec3 last(-5, 0, 0);
    std::size_t frames = 0;
    for (SimTime t = sim(0s); t < sim(2s); t += kFrame) {
      const bool updated = t >= heard;
      const KinematicState ghost = updated ? over(t) : at_rest(ball.pose());
      const Vec3 now = convergence.shown(t, ghost, updated ? 1u : 0u, wall, was).position;
      ASSERT_TRUE(wall(last, now)) << "from " << last.transpose() << " to " << now.transpose();
      frames += updated && now != ghost.position;
      last = now;
    }
    EXPECT_EQ(last, over(sim(1990ms)).position);
    EXPECT_GT(frames, 5u) << "it doesn't jump";
    EXPECT_LT(frames, 30u) << "it catches up";
    EXPECT_EQ(convergence.detours(), 1u);
    EXPECT_EQ(convergence.blocked(), 0u);
  }
}

// The object follows the ghost's trail until it can reach no place on it, because everything is barred or because the
// ghost's former places are forgotten. It waits for as long as a way back takes, and then jumps.
TEST(Convergence, WaitsOnABarredTrailNoLongerThanAWayBackTakes) {
  for (const bool forgotten : {false, true}) {
    Convergence convergence({ConvergenceMethod::kLinear, kOver});
    const KinematicState start = moving({0, 0, 0}, {20, 0, 0});
    const auto ghost = [&](SimTime t) { return advance(start, std::max(0.0, to_seconds(t - sim(500ms)))); };
    bool barred = false;
    const auto near_by = [&](const Vec3& from, const Vec3& to) { return (to - from).norm() <= (barred ? 0.0 : 0.5); };
    const auto was = [&](SimTime t) { return barred && forgotten ? std::nullopt : std::optional(ghost(t).pose()); };
    (void)convergence.shown(sim(1s), at_rest({}), 0, near_by, was);
    SimTime t = sim(1s);
    Vec3 last = Vec3::Zero();
    for (int frame = 0; frame < 10; ++frame) {
      t += kFrame;
      last = convergence.shown(t, ghost(t), 1, near_by, was).position;
    }
    ASSERT_EQ(convergence.detours(), 1u);
    ASSERT_TRUE(last.x() > 0.1 && last.x() < 6.0) << "on the trail, far behind";
    barred = true;
    const SimTime moved_at = t;
    while (t < moved_at + kOver) {
      t += kFrame;
      ASSERT_EQ(convergence.shown(t, ghost(t), 1, near_by, was).position, last) << "it waits";
    }
    EXPECT_EQ(convergence.blocked(), 0u);
    t += kFrame;
    EXPECT_EQ(convergence.shown(t, ghost(t), 1, near_by, was).position, ghost(t).position);
    EXPECT_EQ(convergence.blocked(), 1u);
  }
}

PeerConfig joins(const World& world, std::uint32_t id, const char* owns, ConvergencePolicy convergence = {}) {
  PeerConfig config{.id = PeerId{id}, .name = id == 1 ? "one" : "two", .convergence = convergence};
  if (owns != nullptr) config.owned.push_back({world[owns], true});
  return config;
}
Duration phase(SimTime t) { return t.time_since_epoch() - kEpoch; }
// The object goes from x = -1 to x = 1, and nobody sees how.
KinematicState carried(SimTime t) { return moving({phase(t) < 3s ? -1.0 : 1.0, 0, 0}); }

// A peer that drew the ball a second ago no longer knows where its own wall was then. The wall has been on the other
// side in between, which hinders nothing.
TEST(Convergence, AnOwnWallBeyondTheHistoryBlocksNothing) {
  const World world(box("BALL", "0.5 0.5 0.5", "-1 0 0", kBounces) + box("WALL", "0.2 9 9", "-5 0 0") +
                    interest("BALL", "\"WALL\""));
  Lan lan(world, {5ms, 0ms, 0, 0});
  lan.add(joins(world, 1, "BALL"), 0s, {{world["BALL"], carried}});
  lan.add(joins(world, 2, "WALL", {ConvergenceMethod::kLinear, 2s}), 0s, {{world["WALL"], [](SimTime t) {
                                                                             const bool away =
                                                                                 phase(t) > 2600ms && phase(t) < 3100ms;
                                                                             return moving({away ? 5.0 : -5.0, 0, 0});
                                                                           }}});
  std::vector<double> drawn;
  for (const Duration t : {2500ms, 3500ms}) {
    lan.run_until(t);
    Peer& two = lan.peer(1);
    const SimTime now = lan.session_now(1);
    two.advance_ghosts(now);
    drawn.push_back(two.shown(world["BALL"], now).position.x());
  }
  EXPECT_NEAR(drawn[0], -1.0, 1e-3);
  EXPECT_NEAR(drawn[1], 0.0, 1e-2);  // half of the two seconds
  EXPECT_EQ(lan.peer(1).counters().convergence_blocked, 0u);
  EXPECT_EQ(lan.peer(1).counters().convergence_detours, 0u);
}

}  // namespace peerd::replication::convergence_test
