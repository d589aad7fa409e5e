#include "replication/objects/sight/sight.hpp"

#include "replication/peer/peer_parts.hpp"
#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::sight_test {
namespace {

using namespace test;

// Peer 1 owns the ball of a corridor, which bounces; 2 and 3 watch, of which 2 skips what it does not see.
struct Watched {
  explicit Watched(PeerConfig skipper = config(2)) {
    PeerConfig owner = config(1, {{world["BALL"]}});
    owner.owned[0].launch.velocity = Vec3(2, 0, 0);
    lan.add(owner);
    skipper.sight.skip_unseen = true;
    lan.add(std::move(skipper));
    lan.add(config(3));
  }
  [[nodiscard]] const MotionWorld::Counters counters(std::size_t i) const { return lan.peer(i).motion_counters(); }

  World world{corridor(), {"BALL"}};
  Lan lan{world};
};

View looking_along(const Vec3& from, double turned_rad) {
  return {{std::nullopt, {from, Quat(Eigen::AngleAxisd(turned_rad, Vec3::UnitY()))}, 0.8, 1.0}};
}
constexpr double kHalfTurn = 3.14159265358979323846;

TEST(Sight, SkipsWhatNoViewShowsUntilItDoes) {
  PeerConfig skipper = config(2);
  skipper.sight.views = {looking_along({0, 0, 20}, kHalfTurn)};  // away from the corridor
  Watched w(skipper);
  w.lan.run_until(8s);
  const ObjectId ball = w.world["BALL"];
  EXPECT_EQ(w.counters(1).contact_searches, 0u);
  EXPECT_GT(w.counters(1).searches_put_off, 0u);
  EXPECT_GT(w.counters(2).contact_searches, 0u);
  EXPECT_GT(w.lan.peer(1).counters().predictions_unseen, 0u);
  EXPECT_EQ(w.lan.peer(2).counters().predictions_unseen, 0u);
  w.lan.peer(1).look({looking_along({0, 0, 20}, 0.0)});
  const SimTime t = w.lan.session_now(1);
  for (const std::size_t i : {1u, 2u}) w.lan.peer(i).advance_ghosts(t);
  EXPECT_TRUE(same_bits(w.lan.peer(1).ghost(ball, t), w.lan.peer(2).ghost(ball, t))) << "on that very frame";
  EXPECT_EQ(w.lan.peer(1).shown(ball, t).position, w.lan.peer(1).ghost(ball, t).position);
  EXPECT_GT(w.counters(1).contact_searches, 0u);
}

TEST(Sight, SeveralViewsSeeWhatAnyOfThemSees) {
  PeerConfig skipper = config(2);
  skipper.sight.views = {looking_along({0, 0, 20}, kHalfTurn), looking_along({0, 0, 20}, 0.0)};
  Watched w(skipper);
  w.lan.run_until(4s);
  EXPECT_EQ(w.counters(1).searches_put_off, 0u);
  EXPECT_EQ(w.counters(1).contact_searches, w.counters(2).contact_searches);
}

TEST(Sight, AViewEndsWhereItsDistanceDoes) {
  for (const double far_m : {10.0, 30.0}) {
    PeerConfig skipper = config(2);
    skipper.sight.views = {looking_along({0, 0, 20}, 0.0)};
    skipper.sight.views[0].far_m = far_m;
    Watched w(skipper);
    w.lan.run_until(4s);
    EXPECT_EQ(w.counters(1).searches_put_off > 0, far_m < 15.0) << far_m;
  }
}

// What carries a view is kept, so what it shows is where it should be.
TEST(Sight, AViewThatRidesOnAnObjectSeesFromThere) {
  PeerConfig skipper = config(2);
  skipper.sight.views = {looking_along({0, 0, 0}, 0.0)};
  Watched w(skipper);
  View riding = looking_along({0, 0, 5}, 0.0);
  riding.viewpoint.object = w.world["BALL"];
  w.lan.peer(1).look({riding});
  w.lan.run_until(6s);
  EXPECT_EQ(w.counters(1).searches_put_off, 0u);
}

// The file may have a view stand in something of no further interest.
TEST(Sight, AViewGoesWithWhatMovesItsNode) {
  const World world(box_with("BALL", "0.5 0.5 0.5", "0 0 0", kBounces, "DEF EYE Group { }\n") +
                    box("RIGHT", "1 50 50", "3.75 0 0") + interest("BALL", "\"RIGHT\""));
  ASSERT_EQ(world.model->node(world["BALL/EYE"]), nullptr);
  Lan lan(world);
  PeerConfig owner = config(1, {{world["BALL"]}}), skipper = config(2);
  owner.owned[0].launch.velocity = Vec3(0, 4, 0);
  skipper.sight = {true, {looking_along({0, 0, 5}, 0.0)}};
  skipper.sight.views[0].viewpoint.object = world["BALL/EYE"];
  skipper.sight.views[0].far_m = 10.0;
  lan.add(owner);
  lan.add(skipper);
  lan.run_until(6s);
  EXPECT_GT(lan.peer(1).ghost(world["BALL"], lan.session_now(1)).position.y(), 15.0);
  EXPECT_EQ(lan.peer(1).counters().predictions_unseen, 0u);
}

// What is left behind stands where everybody has it, also when the others have slept meanwhile.
TEST(Sight, WhatOthersGoByIsComputedFirst) {
  for (const Duration sleep : {0s, 20s}) {
    SCOPED_TRACE(sleep / 1s);
    Watched w;
    w.lan.run_until(5900ms);
    const auto ghost = [&](std::size_t i) { return w.lan.peer(i).ghost(w.world["BALL"], w.lan.session_now(i)); };
    ASSERT_GT(std::abs(ghost(1).position.x()), 3.5) << "gone through a wall, as nobody looks";
    if (sleep > 0s) {
      w.lan.kill(0);
      w.lan.skip(sleep);
      w.lan.run_until(29s);
    } else {
      w.lan.leave(0);
      w.lan.run_until(6s);
    }
    EXPECT_EQ(ghost(1).velocity, Vec3(Vec3::Zero()));
    EXPECT_LT((ghost(1).position - ghost(2).position).norm(), 0.1);
  }
}

// The parts of a peer that skips, and of one that does not; both are told the same.
struct TwoPeers {
  explicit TwoPeers(const World& w) : world(w), skips(skipper(), *w.model), computes(config(3), *w.model) {
    for (PeerParts* const p : {&skips, &computes}) {
      p->replica.begin(sim(0s));
      p->replica.ghosts().watch_by([](const CollisionPair&) { return true; });
    }
  }
  static PeerConfig skipper() {
    PeerConfig c = config(2);
    c.sight.skip_unseen = true;
    return c;
  }
  void give_to_another(const char* path) {
    for (PeerParts* const p : {&skips, &computes}) {
      p->owners.set(world[path], PeerId{9});
      p->replica.declare_remote(world[path], Role::kPredicted);
    }
  }
  void declare_scene_object(const char* path) {
    for (PeerParts* const p : {&skips, &computes}) p->replica.declare_remote(world[path], Role::kPredicted);
  }
  void move(const char* path, SimTime t, const KinematicState& state) {
    for (PeerParts* const p : {&skips, &computes}) p->replica.set_ghost(world[path], t, state, false);
  }
  void advance(SimTime to) {
    now = to;
    for (PeerParts* const p : {&skips, &computes}) p->replica.advance_ghosts(to);
  }
  [[nodiscard]] bool agree_on(const char* path) const {
    return same_bits(skips.replica.ghost(world[path], now), computes.replica.ghost(world[path], now));
  }

  const World& world;
  PeerParts skips, computes;
  SimTime now{};
};

// A part of what the ball meets gets an owner: from then on it is a part of its own.
TEST(Sight, WhatWasPutOffIsFoundBeforeTheModelChanges) {
  const World world(box("BALL", "0.5 0.5 0.5", "0 0 0", kBounces) + "DEF ROOM Group { children [ " +
                        box("LEFT", "1 50 50", "-3.75 0 0") + box("RIGHT", "1 50 50", "3.75 0 0") +
                        box("LAMP", "1 1 1", "0 9 0") + "] }\n" + interest("BALL", "\"ROOM\""),
                    {"BALL"});
  TwoPeers two(world);
  two.give_to_another("BALL");
  two.move("BALL", sim(1s), moving({0, 0, 0}, {2, 0, 0}));
  two.advance(sim(4s));
  EXPECT_FALSE(two.agree_on("BALL"));
  const std::vector<ObjectId> lamp{world["ROOM/LAMP"]};
  for (PeerParts* const p : {&two.skips, &two.computes}) {
    p->owners.set(lamp[0], PeerId{9});
    ASSERT_TRUE(p->let_move(lamp));
  }
  EXPECT_TRUE(two.agree_on("BALL"));
  two.advance(sim(7s));
  EXPECT_FALSE(two.agree_on("BALL")) << "it goes on as before";
  two.skips.sight.look({looking_along({0, 0, 20}, 0.0)});
  two.advance(sim(7016ms));
  EXPECT_TRUE(two.agree_on("BALL"));
}

TEST(Sight, ASceneObjectThatNobodySawStruckComesIntoSightAsItIs) {
  const World world(
      box("CAR", "1 1 1", "-9 0 0") + box("BALL", "1 1 1", "0 0 0", kBounces) + interest("BALL", "\"CAR\""), {"CAR"});
  TwoPeers two(world);
  two.give_to_another("CAR");
  two.declare_scene_object("BALL");
  two.move("CAR", sim(10ms), moving({-9, 0, 0}, {4, 0, 0}));
  two.advance(sim(3s));
  EXPECT_FALSE(two.agree_on("BALL"));
  View down = looking_along(two.computes.replica.ghost(world["BALL"], sim(3s)).position + Vec3(0, 0, 3), 0.0);
  down.viewpoint.field_of_view = 0.1;
  two.skips.sight.look({down});
  two.advance(sim(3016ms));
  EXPECT_TRUE(two.agree_on("BALL"));
}

TEST(Sight, TheServerOfDecisionsPutsNothingOff) {
  PeerConfig skipper = config(2);
  skipper.decisions.policy = DecisionPolicy::kServer;
  skipper.decisions.server = PeerId{2};
  Watched w(skipper);
  w.lan.run_until(4s);
  EXPECT_EQ(w.lan.peer(1).counters().predictions_unseen, 0u);
}

TEST(Sight, APeerThatIsNotAskedToSkipPutsNothingOff) {
  Watched w;
  w.lan.run_until(4s);
  EXPECT_EQ(w.counters(0).searches_put_off + w.counters(2).searches_put_off, 0u);
  EXPECT_GT(w.counters(1).searches_put_off, 0u) << "it has no view at all";
}

}  // namespace
}  // namespace peerd::replication::sight_test
