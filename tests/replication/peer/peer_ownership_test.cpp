// Objects change hands while the session runs: at one instant for all, to one peer, and they go on as they moved.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/replication/peer/peers.hpp"

namespace peerd::replication::peer_ownership_test {

using namespace test;
using testing::SizeIs;

// BALL answers contacts and is nobody's at first; CART stands still, and answers nothing; CAR is peer 2's.
const std::string kWorld = box("BALL", "0.5 0.5 0.5", "0 0 0", kBounces) + box("CART", "1 1 1", "0 9 0") +
                           box("CAR", "1 1 1", "0 20 0") + box("WALL", "1 3 3", "5 0 0") + interest("BALL", "\"WALL\"");

class Ownership : public Peers {
 protected:
  Ownership() : Peers(kWorld, {"CAR"}) {}

  void begin(Link link = {.latency = 20ms}, std::uint64_t seed = 1, std::size_t peers = 3) {
    lan = std::make_unique<Lan>(world, link, seed);
    lan->add(config(1, {}));
    lan->add(config(2, {{world["CAR"]}}), 5s);
    while (lan->size() < peers) lan->add(config(static_cast<std::uint32_t>(lan->size() + 1)));
    lan->run_until(3s);
  }
  OperationId own(std::size_t i, const char* path) const {
    const auto taking = lan->peer(i).own(lan->host_now(i), world[path]);
    EXPECT_TRUE(taking) << taking.error();
    return taking.value_or(Taking{}).operation;
  }
  OperationId give(std::size_t i, const char* path, PeerId to) const {
    const auto id = lan->peer(i).give(lan->host_now(i), world[path], to);
    EXPECT_TRUE(id) << id.error();
    return id.value_or(OperationId{});
  }
};

TEST_F(Ownership, WhatIsNobodysIsWhosOperationIsFirst) {
  begin();
  (void)own(0, "CART");
  (void)own(2, "CART");  // at the same instant; the stamps are equal, and the author decides
  lan->run_until(4s);
  const PeerId owner = lan->peer(0).owner(world["CART"]);
  EXPECT_TRUE(owner == PeerId{1} || owner == PeerId{3});
  expect_owner("CART", owner);
  std::vector<SimTime> since;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto given = lan->seen<ObjectGiven>(i);
    ASSERT_THAT(given, SizeIs(1));
    EXPECT_EQ(given[0].owner, owner);
    since.push_back(given[0].at);
  }
  EXPECT_THAT(since, testing::Each(since[0]));
}

TEST_F(Ownership, ItsOwnerMovesIt) {
  begin();
  (void)own(0, "CART");
  lan->run_until(4s);
  push(0, "CART", Vec3(1, 0, 0));
  lan->run_until(6s);
  expect_one_ghost("CART");
  EXPECT_NEAR(ghost(2, "CART").position.x(), 2.0, 0.05);
  (void)give(0, "CART", PeerId{3});
  lan->run_until(7s);
  expect_owner("CART", PeerId{3});
  expect_one_ghost("CART");
  EXPECT_NEAR(ghost(0, "CART").position.x(), 3.0, 0.05) << "it goes on as it moved";
  EXPECT_FALSE(lan->peer(0).change_velocity(lan->host_now(0), world["CART"], Vec3(0, 1, 0), true));
  push(2, "CART", Vec3(0, 0, 1));
  lan->run_until(8s);
  expect_one_ghost("CART");
  EXPECT_NEAR(ghost(0, "CART").position.z(), 1.0, 0.05);
  (void)give(2, "CART", PeerId{1});  // who owned it before: what it publishes is newer than what it published then
  lan->run_until(9s);
  push(0, "CART", Vec3(-1, 0, 0));
  lan->run_until(10s);
  expect_owner("CART", PeerId{1});
  expect_one_ghost("CART");
  EXPECT_NEAR(ghost(2, "CART").velocity.x(), -1.0, 0.01);
}

TEST_F(Ownership, WhatIsReleasedStands) {
  begin();
  (void)own(0, "CART");
  lan->run_until(4s);
  push(0, "CART", Vec3(1, 0, 0));
  lan->run_until(6s);
  (void)give(0, "CART", kNobody);
  lan->run_until(7s);
  expect_owner("CART", kNobody);
  expect_one_ghost("CART");
  EXPECT_NEAR(ghost(2, "CART").position.x(), 2.1, 0.05);
  EXPECT_EQ(ghost(2, "CART").velocity, Vec3(0, 0, 0));
  (void)own(1, "CART");
  lan->run_until(8s);
  expect_owner("CART", PeerId{2});
  EXPECT_NEAR(ghost(0, "CART").position.x(), 2.1, 0.05);
}

// The scene is not edited for what stands in its place already.
TEST_F(Ownership, WhatHasNotMovedIsReleasedAsItIs) {
  begin();
  (void)own(0, "CART");
  lan->run_until(4s);
  expect_owner("CART", PeerId{1});
  (void)give(0, "CART", kNobody);
  lan->run_until(5s);
  expect_owner("CART", kNobody);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(lan->peer(i).counters().scene_changes, 0u);
}

TEST_F(Ownership, WhatAnswersContactsGoesOnWhenItIsReleased) {
  begin();
  (void)own(0, "BALL");
  lan->run_until(4s);
  push(0, "BALL", Vec3(1, 0, 0));
  lan->run_until(6s);
  (void)give(0, "BALL", kNobody);
  lan->run_until(8s);
  expect_owner("BALL", kNobody);
  expect_one_ghost("BALL");
  EXPECT_EQ(ghost(2, "BALL").velocity.x(), 1.0);
  EXPECT_NEAR(ghost(2, "BALL").position.x(), 4.0, 0.05);
  lan->run_until(9s);  // it has met the wall
  expect_one_ghost("BALL");
  EXPECT_EQ(ghost(2, "BALL").velocity.x(), -1.0);
}

TEST_F(Ownership, AnOwnerIsAsked) {
  begin();
  const OperationId request = own(2, "CAR");
  EXPECT_FALSE(lan->peer(0).own(lan->host_now(0), world["CART"]).value().asks);
  lan->run_until(3500ms);
  const auto asked = lan->seen<ObjectRequested>(1);
  ASSERT_THAT(asked, SizeIs(1));
  EXPECT_EQ(asked[0].request, request);
  EXPECT_EQ(asked[0].object, world["CAR"]);
  EXPECT_EQ(asked[0].by, PeerId{3});
  EXPECT_TRUE(lan->seen<ObjectRequested>(0).empty());
  expect_owner("CAR", PeerId{2});
  ASSERT_TRUE(lan->peer(1).edit(lan->host_now(1), RefuseRequest{request, "it is driven"}));
  lan->run_until(4s);
  const auto refused = lan->seen<RequestRefused>(2);
  ASSERT_THAT(refused, SizeIs(1));
  EXPECT_EQ(refused[0].request, request);
  EXPECT_EQ(refused[0].reason, "it is driven");
  (void)give(1, "CAR", PeerId{3});
  lan->run_until(5s);
  expect_owner("CAR", PeerId{3});
  EXPECT_FALSE(lan->peer(1).owns_any());
}

// A configuration gives the car to peer 2; an operation has given it to peer 3, or to nobody.
TEST_F(Ownership, OperationsCountMoreThanConfigurations) {
  for (const PeerId to : {PeerId{3}, kNobody}) {
    begin();
    (void)give(1, "CAR", to);
    lan->run_until(4s);
    lan->kill(1);
    lan->run_until(8s);
    PeerConfig again = config(2, {{world["CAR"]}});
    again.incarnation = 101;
    lan->restart(1, again);
    lan->run_until(14s);
    expect_owner("CAR", to);
  }
  (void)own(2, "CAR");
  lan->run_until(15s);
  expect_owner("CAR", PeerId{3});
}

// The ball goes on and meets the wall, for the peers that stay and for one that joins.
TEST_F(Ownership, WhatALostPeerHasThrownAnswersContacts) {
  begin();
  (void)own(2, "BALL");
  lan->run_until(4s);
  push(2, "BALL", Vec3(0.5, 0, 0));
  lan->run_until(6s);
  lan->kill(2);
  lan->run_until(9s);
  lan->add(config(4));
  lan->run_until(16s);
  expect_owner("BALL", kNobody);
  expect_one_ghost("BALL");
  EXPECT_EQ(ghost(0, "BALL").velocity.x(), -0.5);
}

TEST_F(Ownership, AJoiningPeerKnowsOwnersAndFindsWhatWasReleasedWhereItStands) {
  begin();
  (void)own(0, "CART");
  (void)give(1, "CAR", PeerId{3});
  lan->run_until(4s);
  push(0, "CART", Vec3(1, 0, 0));
  lan->run_until(6s);
  (void)give(0, "CART", kNobody);
  (void)own(0, "BALL");
  lan->run_until(8s);
  lan->add(config(4));
  lan->run_until(13s);
  expect_owner("CART", kNobody);
  expect_owner("CAR", PeerId{3});
  expect_owner("BALL", PeerId{1});
  expect_one_ghost("CART");
  EXPECT_NEAR(ghost(3, "CART").position.x(), 2.1, 0.05);
}

// Its owner is gone: somebody else may take it, and keeps it when the owner comes back.
TEST_F(Ownership, WhatALostPeerOwnsCanBeTaken) {
  begin();
  (void)own(2, "CART");
  lan->run_until(4s);
  expect_owner("CART", PeerId{3});
  lan->kill(2);
  lan->run_until(8s);
  expect_owner("CART", kNobody);
  (void)own(0, "CART");
  lan->run_until(9s);
  expect_owner("CART", PeerId{1});
  lan->node(2).running = true;
  lan->run_until(15s);
  expect_owner("CART", PeerId{1});
}

TEST_F(Ownership, AnOwnerThatIsBackHasWhatItHad) {
  begin();
  (void)own(2, "CART");
  lan->run_until(4s);
  lan->kill(2);
  lan->run_until(8s);
  expect_owner("CART", kNobody);
  lan->node(2).running = true;
  lan->run_until(14s);
  expect_owner("CART", PeerId{3});
  expect_one_ghost("CART");
}

// A contact lends an object whose owner is gone to the peer that has pushed it, whoever joins meanwhile.
TEST_F(Ownership, AJoiningPeerTakesNothingThatIsLent) {
  const World pushed{
      box("BALL", "0.5 0.5 0.5", "0 0 0", kBounces) + box("CAR", "1 1 1", "0 5 0") + interest("BALL", "\"CAR\""),
      {"CAR"}};
  Lan peers(pushed, {.latency = 20ms}, 1);
  peers.add(config(1));
  peers.add(config(2, {{pushed["CAR"]}}));
  peers.add(config(3));
  peers.run_until(3s);
  EXPECT_TRUE(peers.peer(2).own(peers.host_now(2), pushed["BALL"]));
  peers.run_until(4s);
  peers.kill(2);
  peers.run_until(7s);
  EXPECT_EQ(peers.peer(0).owner(pushed["BALL"]), kNobody);
  EXPECT_TRUE(peers.peer(1).change_velocity(peers.host_now(1), pushed["CAR"], Vec3(0, -4, 0), true));
  peers.run_until(9s);
  for (const std::size_t i : {0u, 1u}) ASSERT_EQ(peers.peer(i).owner(pushed["BALL"]), PeerId{2}) << "at peer " << i + 1;
  peers.add(config(4));
  peers.run_until(9500ms);
  for (const std::size_t i : {0u, 1u}) EXPECT_EQ(peers.peer(i).owner(pushed["BALL"]), PeerId{2}) << "at peer " << i + 1;
}

// Whatever gets lost, and whoever asks: at the end all have the same owner, and the same ghost.
TEST_F(Ownership, ManyTakeAndGive) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    begin({.latency = 30ms, .jitter = 20ms, .loss = 0.1}, seed, 4);
    std::mt19937_64 random(seed);
    for (int step = 1; step <= 60; ++step) {
      lan->run_until(3s + step * 150ms);
      const std::size_t i = random() % 4;
      const char* const path = random() % 2 == 0 ? "CART" : "BALL";
      if (random() % 3 == 0) {
        (void)lan->peer(i).give(lan->host_now(i), world[path], PeerId{static_cast<std::uint32_t>(random() % 5)});
      } else {
        (void)lan->peer(i).own(lan->host_now(i), world[path]);
      }
      (void)lan->peer(i).change_velocity(lan->host_now(i), world[path], Vec3(0.1, 0, 0), true);
    }
    lan->run_until(16s);  // between two updates for the time alone, which may get lost
    EXPECT_GT(lan->peer(0).counters().objects_given, 10u);
    for (const char* const path : {"CART", "BALL"}) {
      expect_owner(path, lan->peer(0).owner(world[path]));
      expect_one_ghost(path);
    }
    if (HasFailure()) FAIL() << "seed " << seed;
  }
}

}  // namespace peerd::replication::peer_ownership_test
