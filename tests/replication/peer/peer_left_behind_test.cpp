// Objects that owners leave behind stand at one place at all peers, also at those who come later and at the owner
// itself.
#include <gtest/gtest.h>

#include "tests/replication/peer/peers.hpp"

namespace peerd::replication::peer_left_behind_test {

using namespace test;

// CAR is peer 3's, and is driven along x.
const std::string kWorld = box("CAR", "1 1 1", "0 5 0") + box("TREE", "1 1 1", "0 9 0");

class LeftBehind : public Peers {
 protected:
  LeftBehind() : Peers(kWorld, {"CAR"}) {}

  void begin(Link link = {.latency = 40ms, .jitter = 30ms}, std::uint64_t seed = 1) {
    lan = std::make_unique<Lan>(world, link, seed);
    lan->add(config(1));
    lan->add(config(2), 5s);
    lan->add(config(3, {{world["CAR"], true}}), -2s, drive());
    lan->run_until(5s);
  }
  [[nodiscard]] std::map<ObjectId, Lan::Motion> drive() const {
    return {{world["CAR"], [](SimTime t) {
               const double s = to_seconds(t.time_since_epoch());
               KinematicState state = at_rest(Pose{{std::sin(s), 5, std::cos(s)}, Quat::Identity()});
               state.velocity = Vec3(std::cos(s), 0, -std::sin(s));
               state.acceleration = Vec3(-std::sin(s), 0, -std::cos(s));
               return state;
             }}};
  }
  [[nodiscard]] KinematicState car_at(std::size_t i) const { return ghost(i, "CAR", 10ms); }
  void expect_it_stands_at_one_place(std::initializer_list<std::size_t> peers) const {
    const KinematicState first = car_at(*peers.begin());
    EXPECT_EQ(first.velocity, Vec3::Zero());
    for (const std::size_t i : peers) {
      EXPECT_TRUE(same_bits(car_at(i), first))
          << "at peer " << i + 1 << ": " << car_at(i).position.transpose() << ", not " << first.position.transpose();
    }
  }
};

TEST_F(LeftBehind, ItStandsAtOnePlaceForAll) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    begin({.latency = 40ms, .jitter = 30ms, .loss = 0.1}, seed);
    seed % 2 == 0 ? lan->kill(2) : lan->leave(2);
    lan->run_until(9s);
    expect_it_stands_at_one_place({0, 1});
    EXPECT_NEAR(car_at(0).position.head<3>().norm(), std::sqrt(26.0), 2.0);
    lan->add(config(4), 1s);
    lan->run_until(12s);
    expect_it_stands_at_one_place({0, 1, 3});
    if (HasFailure()) FAIL() << "seed " << seed;
  }
}

// Whoever is first by its number says so; the others do where that one goes, too.
TEST_F(LeftBehind, ALonePeerSaysItForWhoComesLater) {
  begin();
  lan->kill(0);
  lan->kill(2);
  lan->run_until(9s);
  lan->add(config(4), 1s);
  lan->run_until(12s);
  expect_it_stands_at_one_place({1, 3});
  EXPECT_GT((car_at(3).position - Vec3(0, 5, 0)).norm(), 0.5) << "not where the file has it";
}

TEST_F(LeftBehind, ItsOwnerFindsItThere) {
  begin();
  lan->kill(2);
  lan->run_until(9s);
  const Vec3 left = car_at(0).position;
  lan->node(2).motions.clear();
  PeerConfig again = config(3, {{world["CAR"]}});
  again.incarnation = 2;
  lan->restart(2, again);
  lan->run_until(13s);
  EXPECT_EQ(lan->peer(0).owner(world["CAR"]), PeerId{3});
  expect_it_stands_at_one_place({0, 1, 2});
  EXPECT_LT((car_at(2).position - left).norm(), 1e-5);
}

// An owner that was only silent has gone on meanwhile, and goes on.
TEST_F(LeftBehind, AnOwnerThatWasSilentGoesOn) {
  lan = std::make_unique<Lan>(world, Link{.latency = 20ms}, 1);
  lan->add(config(1));
  lan->add(config(2, {{world["CAR"]}}));
  lan->run_until(3s);
  push(1, "CAR", Vec3(1, 0, 0));
  lan->run_until(4s);
  lan->part({1});
  lan->run_until(8s);
  lan->part({});
  lan->run_until(12s);
  const Vec3 truth = lan->peer(1).truth(world["CAR"], lan->session_now(1) - 10ms).position;
  EXPECT_NEAR(truth.x(), 9.0, 0.1) << "it has gone on all the time";
  EXPECT_LT((car_at(0).position - truth).norm(), 0.1);
}

// While one side takes the owner for gone, that gives the object to a third peer, which goes on with it.
TEST_F(LeftBehind, AnObjectThatChangedHandsMeanwhileStaysWhereItIs) {
  lan = std::make_unique<Lan>(world, Link{.latency = 20ms}, 1);
  lan->add(config(1));
  lan->add(config(2));
  lan->add(config(3, {{world["CAR"]}}));
  lan->run_until(3s);
  lan->part({0});
  push(2, "CAR", Vec3(1, 0, 0));
  lan->run_until(4s);
  EXPECT_TRUE(lan->peer(2).give(lan->host_now(2), world["CAR"], PeerId{2}));
  lan->run_until(9s);
  EXPECT_EQ(lan->peer(1).owner(world["CAR"]), PeerId{2});
  lan->part({});
  lan->run_until(13s);
  EXPECT_NEAR(lan->peer(1).truth(world["CAR"], lan->session_now(1) - 10ms).position.x(), 10.0, 0.2);
  EXPECT_NEAR(car_at(0).position.x(), 10.0, 0.3);
}

}  // namespace peerd::replication::peer_left_behind_test
