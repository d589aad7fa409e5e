// What an edit removes and an undo brings back is as if it had never been gone: also for peers that receive both at
// once, and have never seen it gone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/peer/peers.hpp"

namespace peerd::replication::peer_removed_test {

using namespace test;
using testing::Each;

// CAR is peer 3's by its configuration, CUP the founder's by the file, and BALL is nobody's: it lies in the way of the
// BAT, which peer 2 drives at 7 s.
const std::string kWorld =
    box("CAR", "1 1 1", "0 9 0", kBounces) + box("CUP", "1 1 1", "0 20 0", "enslaved TRUE") +
    box("BALL", "0.5 0.5 0.5", "0 0 0", " collisionResponse CollisionResponse { responseType 2 restitution 1 } ") +
    box("BAT", "1 1 1", "-12 0 0") + box("WALL", "1 3 3", "90 9 0") + interest("CAR", "\"WALL\"") +
    interest("BALL", "\"BAT\" \"WALL\"");

class Removed : public Peers {
 protected:
  Removed() : Peers(kWorld, {"CAR", "CUP", "BAT"}) {}

  void begin() {
    lan = std::make_unique<Lan>(world, Link{.latency = 20ms}, 1);
    PeerConfig founder = config(1);
    founder.owned_by_founder = {{world["CUP"]}};
    lan->add(founder);
    const auto strikes = [](SimTime t) {
      const double s = to_seconds(t.time_since_epoch() - kEpoch);
      if (s < 4.0 || s >= 7.2) return moving({-12, 0, 0});
      return moving({-12 + 4.0 * (s - 4.0), 0, 0}, {4, 0, 0});
    };
    lan->add(config(2, {{world["BAT"], true}}), 5s, {{world["BAT"], strikes}});
    lan->add(config(3, {{world["CAR"]}}), -2s);
    lan->add(config(4), 1s);
    lan->run_until(3s);
  }
  // Peer 1 removes the object and undoes that a second later; the others receive both at once if they are apart.
  void remove_for_a_second(const char* path, std::set<std::size_t> apart) {
    lan->part(std::move(apart));
    ASSERT_TRUE(lan->peer(0).edit(lan->host_now(0), RemoveObject{world[path]}));
    run_on(1s);
    EXPECT_FALSE(lan->peer(0).scene().contains(world[path]));
    ASSERT_TRUE(lan->peer(0).undo(lan->host_now(0), false));
    run_on(500ms);
    lan->part({});
    run_on(6s);
    for (std::size_t i = 0; i < lan->size(); ++i) EXPECT_TRUE(lan->peer(i).scene().contains(world[path])) << i + 1;
  }
};

TEST_F(Removed, AConfigurationGivesWhatIsBackToItsOwner) {
  for (const std::set<std::size_t>& apart : {std::set<std::size_t>{}, {1}, {2}, {1, 2}, {1, 2, 3}}) {
    begin();
    remove_for_a_second("CAR", apart);
    EXPECT_THAT(owners_of("CAR"), Each(3u)) << apart.size() << " apart";
    expect_one_ghost("CAR", 200ms);
    push(2, "CAR", Vec3(1, 0, 0));
    run_on(2s);
    expect_one_ghost("CAR", 200ms);
    EXPECT_NEAR(ghost(3, "CAR").position.x(), 2.0, 0.05);
  }
}

// Its owner has driven it elsewhere, and does not know that it was gone for others.
TEST_F(Removed, ItStandsWhereItsOwnerHasItThatHasNeverSeenItGone) {
  begin();
  push(2, "CAR", Vec3(2, 0, 0));
  lan->run_until(4s);
  push(2, "CAR", Vec3(0, 0, 0));
  lan->run_until(7s);  // all have acknowledged where it stands
  remove_for_a_second("CAR", {2});
  EXPECT_THAT(owners_of("CAR"), Each(3u));
  expect_one_ghost("CAR", 200ms);
  EXPECT_NEAR(ghost(0, "CAR").position.x(), 2.0, 0.1);
}

TEST_F(Removed, TheFounderHasWhatIsBack) {
  begin();
  ASSERT_THAT(owners_of("CUP"), Each(1u));
  remove_for_a_second("CUP", {1});
  EXPECT_THAT(owners_of("CUP"), Each(1u));
}

// The bat has struck the ball, which never rests: it is peer 2's by a decision.
TEST_F(Removed, WhatADecisionHasLentIsLentStill) {
  for (const std::set<std::size_t>& apart : {std::set<std::size_t>{}, {1}, {2}, {2, 3}}) {
    begin();
    lan->run_until(8s);
    ASSERT_THAT(owners_of("BALL"), Each(2u));
    remove_for_a_second("BALL", apart);
    // Where its owner has seen it gone it lies where the scene has it, so that the owner lets it go.
    EXPECT_THAT(owners_of("BALL"), Each(apart.contains(1) ? 2u : 0u)) << apart.size() << " apart";
    expect_one_ghost("BALL", 200ms);
  }
}

// An object is removed when a peer has not started yet that owns it by its configuration.
TEST_F(Removed, APeerThatComesWhileItIsGoneOwnsItThen) {
  begin();
  lan->kill(2);
  lan->run_until(6s);
  ASSERT_TRUE(lan->peer(0).edit(lan->host_now(0), RemoveObject{world["CAR"]}));
  lan->run_until(7s);
  PeerConfig again = config(3, {{world["CAR"]}});
  again.incarnation = 101;
  lan->restart(2, again);
  lan->run_until(10s);
  ASSERT_TRUE(lan->peer(0).undo(lan->host_now(0), false));
  lan->run_until(15s);
  EXPECT_THAT(owners_of("CAR"), Each(3u));
  expect_one_ghost("CAR", 200ms);
}

// Whether it answers contacts when it is released does not depend on whether a peer has seen it gone.
TEST_F(Removed, WhatIsReleasedIsTheSameToAll) {
  begin();
  remove_for_a_second("CAR", {1});
  push(2, "CAR", Vec3(1, 0, 0));
  run_on(1s);
  ASSERT_TRUE(lan->peer(2).give(lan->host_now(2), world["CAR"], kNobody));
  run_on(3s);
  EXPECT_THAT(owners_of("CAR"), Each(0u));
  expect_one_ghost("CAR", 200ms);
}

}  // namespace peerd::replication::peer_removed_test
