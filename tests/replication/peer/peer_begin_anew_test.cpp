// Edits of the place or the velocityVector of an object that moves, and a world's gravity.
#include <gtest/gtest.h>

#include "tests/replication/peer/peers.hpp"

namespace peerd::replication::peer_begin_anew_test {

using namespace test;

constexpr double kGravity = -9.81;
const std::string kGravityInFile = "WorldInfo { gravity 0 -9.81 0 returnBelow -30 }\n";

class BeginAnew : public Peers {
 protected:
  explicit BeginAnew(const std::string& more = "")
      : Peers(
            more + box("BALL", "0.5 0.5 0.5", "0 9 0", kBounces) + box("FLOOR", "1 1 1", "0 -1000 0") +
                "DEF CLOUD Transform { translation 50 0 0 velocityVector 2 0 0 children Shape { geometry Box { } } }" +
                interest("BALL", "\"FLOOR\" \"CLOUD\""),
            {"BALL"}) {}

  void begin(const Launch& launch) {
    lan = std::make_unique<Lan>(world, Link{.latency = 20ms}, 1);
    lan->add(config(1, {{world["BALL"], false, launch}}));
    lan->add(config(2));
    lan->run_until(3s);
  }
  void set(std::size_t i, const char* path, const char* field, const std::string& value) const {
    (void)edit(i, SetField{node(path, i), field, value, 0});
  }
  [[nodiscard]] KinematicState truth() const { return lan->peer(0).truth(world["BALL"], lan->session_now(0)); }
};

TEST_F(BeginAnew, WhatFallsIsPutSomewhereWithoutItsSpeed) {
  begin({.acceleration = Vec3(0, kGravity, 0)});
  ASSERT_LT(truth().velocity.y(), -15.0);
  set(1, "BALL", "translation", "4 3 0");  // an edit of another peer counts as well
  run_on(1s);
  EXPECT_EQ(truth().position.x(), 4.0);
  EXPECT_GT(truth().position.y(), 3.0 + kGravity / 2 - 0.1) << "it has fallen for a second at most";
  EXPECT_GT(truth().velocity.y(), kGravity - 0.1);
  EXPECT_LT(truth().velocity.y(), -5.0) << "it falls again";
  EXPECT_NEAR(ghost(1, "BALL").position.y(), truth().position.y(), 0.1);
}

TEST_F(BeginAnew, ItGoesBackToWhereTheFileHasItBeSetThereAgain) {
  begin({.velocity = Vec3(3, 0, 0)});
  set(0, "BALL", "translation", "0 9 0");
  run_on(1s);
  EXPECT_EQ(truth().position, Vec3(0, 9, 0));
  EXPECT_EQ(truth().velocity, Vec3::Zero());
}

TEST_F(BeginAnew, AVelocityVectorOfZeroStopsIt) {
  begin({.velocity = Vec3(3, 0, 0)});
  ASSERT_EQ(truth().velocity, Vec3(3, 0, 0));
  set(0, "BALL", "velocityVector", "0 0 0");
  run_on(1s);
  EXPECT_EQ(truth().velocity, Vec3::Zero()) << "though the field was that before";
  set(0, "BALL", "velocityVector", "0 0 1");
  run_on(1s);
  EXPECT_EQ(truth().velocity, Vec3(0, 0, 1));
  set(0, "BALL", "velocityVector", "0 0 0");
  run_on(1s);
  const Vec3 place = truth().position;
  EXPECT_EQ(truth().velocity, Vec3::Zero());
  run_on(1s);
  EXPECT_EQ(truth().position, place);
  EXPECT_EQ(ghost(1, "BALL").position, place);
}

TEST_F(BeginAnew, WhatTheWorldMovesGoesOnFromWhereItIs) {
  begin({});
  lan->peer(0).announce_start(lan->session_now(0) + 1s);
  run_on(3s);
  const double before = ghost(0, "CLOUD").position.x();
  ASSERT_GT(before, 53.0);
  set(0, "CLOUD", "velocityVector", "0 0 0");
  run_on(2s);
  EXPECT_NEAR(ghost(0, "CLOUD").position.x(), before, 0.6) << "0.1 s or so until the edit counts";
  EXPECT_EQ(ghost(0, "CLOUD").velocity, Vec3::Zero());
  set(1, "CLOUD", "velocityVector", "0 1 0");
  run_on(2s);
  EXPECT_NEAR(ghost(0, "CLOUD").position.x(), before, 0.6);
  EXPECT_NEAR(ghost(0, "CLOUD").position.y(), 2.0, 0.3);
  EXPECT_EQ(ghost(1, "CLOUD").position, ghost(0, "CLOUD").position);
}

class ACartOfNobody : public BeginAnew {
 protected:
  ACartOfNobody()
      : BeginAnew(box("CART", "1 1 1", "0 0 50", std::string(kBounces) + "velocityVector 2 0 0 ") +
                  box("STOP", "1 9 9", "4 0 50") + interest("CART", "\"STOP\"")) {}
};

TEST_F(ACartOfNobody, GoesOnOtherwiseAtAllPeersAfterAContact) {
  begin({});
  lan->peer(0).announce_start(lan->session_now(0) + 1s);
  run_on(4s);
  ASSERT_EQ(ghost(0, "CART").velocity, Vec3(-2, 0, 0)) << "it has met STOP";
  set(1, "CART", "velocityVector", "0 1 0");
  run_on(2s);
  EXPECT_EQ(ghost(0, "CART").velocity, Vec3(0, 1, 0));
  EXPECT_NEAR(ghost(0, "CART").position.y(), 2.0, 0.3);
  EXPECT_EQ(ghost(1, "CART").position, ghost(0, "CART").position);
}

class WorldOfGravity : public BeginAnew {
 protected:
  WorldOfGravity() : BeginAnew(kGravityInFile) {}
};

TEST_F(WorldOfGravity, PullsWhatNoSettingSaysAnythingOf) {
  begin({});
  EXPECT_LT(truth().velocity.y(), -15.0);
}

TEST_F(WorldOfGravity, GivesWayToASetting) {
  begin({.acceleration = Vec3::Zero()});
  EXPECT_EQ(truth().position, Vec3(0, 9, 0));
}

TEST_F(WorldOfGravity, BringsBackWhatFallsOutOfTheWorld) {
  begin({});
  double lowest = 0;
  for (int i = 0; i < 60; ++i) {
    run_on(100ms);
    lowest = std::min(lowest, truth().position.y());
  }
  EXPECT_LT(lowest, -25.0);
  EXPECT_GT(lowest, -50.0) << "half a second below the limit at most";
  lan->run_until(lan->now());
  EXPECT_LT(truth().position.y(), 9.1);
}

}  // namespace peerd::replication::peer_begin_anew_test
