#include "replication/peer/peer_parts.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::peer_parts_test {

using namespace test;

TEST(PeerParts, OwnsWhatItsConfigurationSays) {
  const World world(field(3));
  const PeerParts p(config(4, {{world["O2"]}, {world["O0"], true}}), *world.model);
  EXPECT_EQ(p.owners.of(world["O0"]), PeerId{4});
  EXPECT_EQ(p.owners.of(world["O1"]), kNobody);
  EXPECT_EQ(p.owners.of(world["O2"]), PeerId{4});
  EXPECT_EQ(p.ticks.hz(), p.config.tick_hz);
  EXPECT_FALSE(p.replica.begun());
}

// OWNED is another peer's by a configuration that this peer knows, and CUP the founder's by the file.
TEST(PeerParts, SceneObjectsAreNobodysByAConfigurationOrTheFile) {
  const World world(box("BALL", "1 1 1", "0 0 0", kBounces) + box("OWNED", "1 1 1", "3 0 0", kBounces) +
                        box("CUP", "1 1 1", "6 0 0", std::string(kBounces) + "enslaved TRUE") +
                        box("WALL", "1 1 1", "9 0 0") + interest("BALL", "\"WALL\"") + interest("OWNED", "\"WALL\"") +
                        interest("CUP", "\"WALL\""),
                    {"OWNED"});
  PeerParts p(config(4), *world.model);
  EXPECT_TRUE(p.scene.contains(world["BALL"]));
  for (const char* name : {"OWNED", "CUP"}) EXPECT_FALSE(p.scene.contains(world[name])) << name;
  EXPECT_TRUE(p.follow_scene_objects(sim(1s)).empty());
  for (const char* name : {"OWNED", "CUP"}) EXPECT_FALSE(p.scene.contains(world[name])) << name;
}

TEST(PeerParts, CountsDropsInAllAndByMember) {
  const World world(field(1));
  PeerParts p(config(4), *world.model);
  add_member(p.members, 7);
  p.drop(PeerId{7}, "reason");
  p.drop(PeerId{8}, "reason");
  EXPECT_EQ(p.counters.drops["reason"], 2u);
  EXPECT_EQ(p.members.find(PeerId{7})->drops["reason"], 1u);
  EXPECT_FALSE(p.members.contains(PeerId{8}));
}

// The samples that models are chosen by are in the frame of the carrier.
TEST(PeerParts, ModelsAreChosenAnewInAnotherFrame) {
  const World w(car_and_wheel() + box("BALL", "1 1 1", "0 9 0"), {"CAR/WHEEL", "BALL"});
  const ObjectId car = w["CAR"], wheel = w["CAR/WHEEL"], ball = w["BALL"];
  PeerParts p(config(4, {{wheel, true}, {ball, true}}), *w.model);
  p.replica.begin(sim(0s));
  for (const ObjectId object : {wheel, ball}) p.own.at(object).models.emplace(ModelPolicy{});
  p.owners.set(car, PeerId{9});
  const std::vector<ObjectId> moved{car};
  ASSERT_TRUE(p.let_move(moved));
  EXPECT_FALSE(p.own.at(wheel).models.has_value());
  EXPECT_TRUE(p.own.at(ball).models.has_value());
  EXPECT_FALSE(p.let_move(moved)) << "it is a carrier now";
}

}  // namespace peerd::replication::peer_parts_test
