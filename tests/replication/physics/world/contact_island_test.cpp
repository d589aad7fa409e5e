#include "replication/physics/world/contact_island.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::contact_island_test {

using namespace test;

constexpr const char* kDrops = " collisionResponse CollisionResponse { responseType 2 restitution 0 } ";

// Movers that fall onto a floor, onto each other, and stay there.
const char* const kMovers[] = {"A", "B", "C"};
std::string falling_boxes() {
  return box("FLOOR", "40 1 40", "0 -0.5 0") + box("A", "1 1 1", "-10 9 0", kDrops) +
         box("B", "1 1 1", "0 9 0", kDrops) + box("C", "1 1 1", "10 9 0", kDrops) +
         interest("A", "\"FLOOR\" \"B\" \"C\"") + interest("B", "\"FLOOR\" \"A\" \"C\"") +
         interest("C", "\"FLOOR\" \"A\" \"B\"");
}

struct Update {
  const char* object;
  Duration at, arrives;
  KinematicState state;
};

// The states of the movers at some instants, where updates arrive when they say, or at the instant from which they say
// how an object moves.
std::vector<KinematicState> lived(const World& w, std::vector<Update> updates, bool late) {
  MotionWorld world(*w.model, sim(0s));
  for (const char* const mover : kMovers) world.declare(w[mover], Role::kPredicted);
  const auto when = [&](const Update& update) { return late ? update.arrives : update.at; };
  std::ranges::stable_sort(updates, {}, when);
  for (const Update& update : updates) {
    world.advance(sim(when(update)));
    world.set_base(w[update.object], sim(update.at), update.state);
  }
  world.advance(sim(5s));
  std::vector<KinematicState> states;
  for (Duration t = 1s; t <= 5s; t += 50ms) {
    for (const char* const mover : kMovers) states.push_back(world.at(w[mover], sim(t)));
  }
  return states;
}

KinematicState falling(const Vec3& from, const Vec3& velocity = Vec3::Zero()) {
  return moving(from, velocity, {0, -9.81, 0});
}

// C lies on the floor, and then on A, before B's update says that C has met B above them. C fell beside B then: what
// came to bear it later bears nothing.
TEST(ContactIsland, WhatBearsLaterDoesNotBearNow) {
  const World w(falling_boxes());
  const std::vector<Update> updates = {{"C", 500ms, 1860ms, falling({-0.24, 6.24, 0}, {-2.43, 1.87, 0})},
                                       {"A", 150ms, 2220ms, falling({-0.92, 1.74, 0}, {-1.46, -0.15, 0})},
                                       {"B", 400ms, 2330ms, falling({-2.99, 3.8, 0}, {0.51, 1.39, 0})}};
  const auto in_time = lived(w, updates, false), late = lived(w, updates, true);
  for (std::size_t i = 0; i < in_time.size(); ++i) {
    EXPECT_LT((in_time[i].position - late[i].position).norm(), 1e-6) << kMovers[i % 3] << " at the instant " << i / 3;
  }
}

// A box between a wall that stands and a press that comes: the press goes through, and the wall stays one.
TEST(ContactIsland, OnlyWhatComesAndGivesWayToNothingGoesThrough) {
  const std::uint32_t wall = 0, box = 1, press = 2;
  ContactIsland island{.objects = {ContactIsland::kNone, 7, ContactIsland::kNone},
                       .bodies = {{{0, 0, 0}, 0.0}, {{-0.5, 0, 0}, 1.0}, {{-1, 0, 0}, 0.0}},
                       .constraints = {{box, wall, Vec3::UnitX()}, {press, box, Vec3::UnitX()}},
                       .pairs = {30, 40}};
  EXPECT_EQ(solve(island), std::vector<std::uint32_t>{40});
  EXPECT_TRUE(island.bodies[box].value.isZero(0.0)) << "the wall holds it";
  EXPECT_EQ(island.bodies[press].value, Vec3(-1, 0, 0));
}

// A is pushed to the right, towards a wall that it has been foreseen to meet.
TEST(ContactIsland, GivesUpWhatItForeseesBeforeItLetsThrough) {
  ContactIsland island;
  island.objects = {ContactIsland::kNone, 7, ContactIsland::kNone};
  island.reached_from = {7, ContactIsland::kNone, 7};
  island.bodies = {{Vec3(1, 0, 0), 0.0}, {Vec3::Zero(), 1.0}, {Vec3::Zero(), 0.0}};
  island.constraints = {{1, 0, Vec3::UnitX()}, {2, 1, Vec3::UnitX(), -0.1}};
  island.pairs = {3, 4};
  island.foreseen = {1};
  EXPECT_TRUE(solve(island).empty());
  EXPECT_TRUE(island.is_solved);
  EXPECT_EQ(island.bodies[1].value, Vec3(1, 0, 0));
  EXPECT_EQ(island.pairs, std::vector<std::uint32_t>{3});
  EXPECT_EQ(island.constraints.size(), 1u);
}

}  // namespace peerd::replication::contact_island_test
