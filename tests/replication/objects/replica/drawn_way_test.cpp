#include "replication/objects/replica/drawn_way.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::drawn_way_test {

using namespace test;

// Where everything stands at 1 s; ways are of the last 100 ms.
struct Drawing {
  explicit Drawing(const std::string& text, const std::vector<const char*>& owned,
                   const std::vector<const char*>& mine = {})
      : world(text, owned) {
    std::vector<OwnedObject> here;
    for (const char* path : mine) here.push_back({world[path]});
    own.emplace(*world.in_force, here, false);
    replica.emplace(*world.in_force);
    replica->begin(sim(0s));
    for (const char* path : owned) {
      if (own->contains(world[path])) {
        replica->truth().declare(world[path], Role::kDriven);
        replica->ghosts().declare(world[path], Role::kPredicted);
      } else {
        replica->declare_remote(world[path], Role::kPredicted);
      }
    }
    replica->set_world_zero(sim(0s), sim(0s));
  }
  bool free(const char* object, const Vec3& from, const Vec3& to) {
    replica->truth().advance(sim(1s));
    replica->ghosts().advance(sim(1s));
    return is_free({world[object], sim(900ms), sim(1s), from, to}, *world.model, *own, *replica);
  }

  World world;
  std::optional<OwnObjects> own;
  std::optional<Replica> replica;
};

const Vec3 kHere(0, 0, -3), kThere(0, 0, 3);  // before a wall in the plane z = 0, and behind it
std::string wall_at(double x) { return box("WALL", "4 9 0.2", std::to_string(x) + " 0 0"); }

TEST(DrawnWay, APartThatIsFarFromItsEndMeetsWhatIsThere) {
  for (const int type : {0, 1, 2}) {
    Drawing d(arm() + wall_at(20) + interest("ARM", "\"WALL\"", type), {"ARM", "ARM/HAND"});
    EXPECT_FALSE(d.free("ARM", kHere, kThere)) << type;
    EXPECT_TRUE(d.free("ARM", kHere, {0, 0, -2})) << type;
    Drawing beside(arm() + wall_at(0) + interest("ARM", "\"WALL\"", type), {"ARM", "ARM/HAND"});
    EXPECT_TRUE(beside.free("ARM", kHere, kThere)) << "nothing of the arm is there: " << type;
  }
}

TEST(DrawnWay, WhatTheObjectCarriesGoesWithItWhereAnInterestNamesThatAlone) {
  Drawing d(arm() + wall_at(20) + interest("HAND", "\"WALL\""), {"ARM", "ARM/HAND"});
  EXPECT_FALSE(d.free("ARM", kHere, kThere));
  EXPECT_FALSE(d.free("HAND", {20, 0, -3}, {20, 0, 3})) << "the way of the hand is in the world, too";
  EXPECT_TRUE(d.free("HAND", {0, 0, -3}, {0, 0, 3}));
}

TEST(DrawnWay, WhatTheObjectMeetsHasFarPartsToo) {
  Drawing d(box("BALL", "1 1 1", "0 0 0") + arm() + interest("BALL", "\"ARM\""), {"BALL", "ARM", "ARM/HAND"});
  EXPECT_FALSE(d.free("BALL", {20, 0, -3}, {20, 0, 3}));
  EXPECT_TRUE(d.free("BALL", kHere, kThere));
}

// The hand goes from z = -5 to z = 5 in the 100 ms, as its owner, this peer, has it.
TEST(DrawnWay, APartOfAnOwnObjectIsWhereThisPeerShowsIt) {
  Drawing d(box("BALL", "1 1 1", "0 0 0") + arm() + interest("BALL", "\"ARM\""), {"BALL", "ARM", "ARM/HAND"}, {"ARM"});
  d.replica->truth().set_base(d.world["ARM"], sim(0s), moving({0, 0, -95}, {0, 0, 100}));
  EXPECT_FALSE(d.free("BALL", {20, 0, 0}, {20, 0, 0.1}));
  EXPECT_TRUE(d.free("BALL", {20, 9, 0}, {20, 9, 0.1}));
}

TEST(DrawnWay, AFlexibleShapeIsMetWhereItIs) {
  // At 1 s the half width of GROWS is 1.25 m.
  for (const int type : {0, 1}) {
    Drawing d(
        box("BALL", "1 1 1", "0 9 0") + box("GROWS", "1 1 1", "0 0 0") + interest("BALL", "\"GROWS\"", type) + kGrows,
        {"BALL"});
    ASSERT_EQ(d.world.model->flexible.size(), 1u);
    EXPECT_FALSE(d.free("BALL", {1.7, 0, -3}, {1.7, 0, 3})) << type;
    EXPECT_TRUE(d.free("BALL", {1.8, 0, -3}, {1.8, 0, 3})) << type;
  }
}

// The box of both parts of an end holds the middle between them.
TEST(DrawnWay, BoxesAreThoseOfWholeEnds) {
  const std::string pair =
      "DEF PAIR Transform { children [ DEF LEFT Transform { translation -5 0 0 children Shape { "
      "geometry Box { size 1 1 1 } } } DEF RIGHT Transform { translation 5 0 0 children Shape { "
      "geometry Box { size 1 1 1 } } } ] }\n";
  const auto way = [&](int type) {
    Drawing d(pair + box("WALL", "1 9 0.2", "0 0 0") + interest("PAIR", "\"WALL\"", type),
              {"PAIR", "PAIR/LEFT", "PAIR/RIGHT"});
    return d.free("PAIR", kHere, kThere);
  };
  EXPECT_FALSE(way(0));
  EXPECT_TRUE(way(1));
}

TEST(DrawnWay, WhatIsNotReceivedAndWhatMeetsNothingIsInNobodysWay) {
  Drawing d(arm() + wall_at(20) + box("OTHER", "1 1 1", "20 0 0") + interest("ARM", "\"WALL\""), {"ARM", "ARM/HAND"});
  d.replica->set_received(d.world["WALL"], false);
  EXPECT_TRUE(d.free("ARM", kHere, kThere));
  Drawing none(box("LONE", "1 1 1", "0 0 0") + wall_at(0), {});
  EXPECT_TRUE(
      is_free({none.world["LONE"], sim(0s), sim(1s), kHere, kThere}, *none.world.model, *none.own, *none.replica));
}

}  // namespace peerd::replication::drawn_way_test
