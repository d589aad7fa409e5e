#include "replication/physics/world/world_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "replication/physics/world/motion_world.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::world_model_test {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(WorldModel, PairsAreUnorderedAndMutualWhereBothAreNamed) {
  const World w(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "3 0 0") + box("C", "1 1 1", "6 0 0") +
                interest("A", "\"B\" \"C\"") + interest("B", "\"A\"") + interest("A", "\"B\""));
  ASSERT_EQ(w.model->pairs.size(), 2u);
  EXPECT_EQ(w.model->pairs[0].collider, w["A"]);
  EXPECT_EQ(w.model->pairs[0].collidee, w["B"]);
  EXPECT_TRUE(w.model->pairs[0].mutual);
  EXPECT_FALSE(w.model->pairs[1].mutual);
  EXPECT_EQ(w.model->bodies.size(), 3u);
  EXPECT_NE(w.model->body(w["C"]), nullptr);
  EXPECT_THAT(w.model->unsupported, IsEmpty());
}

// Each pair is listed twice, so each is searched for among the earlier ones.
TEST(WorldModel, ManyPairsAreFoundInLinearTime) {
  constexpr int kObjects = 500;
  std::string text, all;
  for (int i = 0; i < kObjects; ++i) all += " \"G" + std::to_string(i) + '"';
  for (int i = 0; i < kObjects; ++i) text += "DEF G" + std::to_string(i) + " Transform { }\n";
  for (int i = 0; i < kObjects; ++i) {
    const std::string name = "G" + std::to_string(i);
    std::string others = all;
    others.erase(others.find(" \"" + name + '"'), name.size() + 3);
    text += interest(name, others);
  }
  const World w(text);
  EXPECT_EQ(w.model->pairs.size(), std::size_t{kObjects} * (kObjects - 1) / 2);
  EXPECT_TRUE(std::ranges::all_of(w.model->pairs, &CollisionPair::mutual));
}

TEST(WorldModel, APatternPairsAsListsDo) {
  const std::string boxes = box("G0", "1 1 1", "0 0 0") + box("G1", "1 1 1", "3 0 0") + box("G2", "1 1 1", "6 0 0");
  const World listed(boxes + interest("G0", "\"G1\" \"G2\"") + interest("G1", "\"G0\" \"G2\"") +
                     interest("G2", "\"G0\" \"G1\""));
  const World found(boxes + interest("G*", "\"G*\""));
  ASSERT_EQ(found.model->pairs.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(key_of(found.model->pairs[i]), key_of(listed.model->pairs[i]));
    EXPECT_TRUE(found.model->pairs[i].mutual);
  }
}

// ---- groups, whose pairs are no list ----

// One collider, and all that it is registered for, in order.
struct Listed {
  std::string collider;
  std::vector<std::string> collidees;
};

std::string interests_of(const std::vector<Listed>& listed, int type = 1) {
  std::string text;
  for (const auto& [collider, collidees] : listed) {
    std::string all;
    for (const std::string& name : collidees) {
      if (name != collider) all += " \"" + name + '"';
    }
    text += "CollisionInterest { objectPath \"" + collider + "\" interests [" + all + "] collisionType " +
            std::to_string(type) + " }\n";
  }
  return text;
}

// Boxes of those names, 3 m apart.
std::string row_of(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) text += box(names[i], "1 1 1", std::to_string(3 * i) + " 0 0");
  return text;
}

std::vector<std::string> names_of(const std::string& prefix, int count) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.push_back(prefix + std::to_string(i));
  return names;
}

std::vector<Listed> each_with(const std::vector<std::string>& colliders, const std::vector<std::string>& collidees) {
  std::vector<Listed> listed;
  for (const std::string& collider : colliders) listed.push_back({collider, collidees});
  return listed;
}

// Everything that a model says of pairs, of two worlds of the same objects.
void expect_same_pairs(const WorldModel& a, const WorldModel& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  ASSERT_EQ(a.pairs.size(), b.pairs.size());
  ASSERT_EQ(a.part_pairs.size(), b.part_pairs.size());
  for (std::uint32_t i = 0; i < a.pairs.size(); ++i) {
    ASSERT_EQ(key_of(a.pairs[i]), key_of(b.pairs[i])) << i;
    ASSERT_EQ(a.pairs[i].mutual, b.pairs[i].mutual) << i;
    const auto [first, end] = a.part_pairs_of_pair(i);
    ASSERT_EQ(first, b.part_pairs_of_pair(i).first) << i;
    ASSERT_EQ(end, b.part_pairs_of_pair(i).end) << i;
  }
  for (std::uint32_t k = 0; k < a.part_pairs.size(); ++k) {
    const PartPair one = a.part_pairs[k], another = b.part_pairs[k];
    ASSERT_EQ(std::tie(one.pair, one.a, one.b, one.common, one.fixed),
              std::tie(another.pair, another.a, another.b, another.common, another.fixed))
        << k;
  }
  for (std::size_t node = 0; node < a.nodes.size(); ++node) {
    EXPECT_EQ(a.pairs_of_node(node).all(), b.pairs_of_node(node).all()) << node;
    EXPECT_EQ(a.part_pairs_of(node).all(), b.part_pairs_of(node).all()) << node;
    EXPECT_EQ(a.part_pairs_moved_by(node).all(), b.part_pairs_moved_by(node).all()) << node;
    EXPECT_EQ(a.all_pairs_move[node], b.all_pairs_move[node]) << node;
    for (std::uint32_t other = 0; other < a.nodes.size(); ++other) {
      std::vector<std::uint32_t> between, expected;
      a.for_each_part_pair_between(static_cast<std::uint32_t>(node), other,
                                   [&](std::uint32_t number) { between.push_back(number); });
      for (std::uint32_t k = 0; k < a.part_pairs.size() && other != node; ++k) {
        const PartPair parts = a.part_pairs[k];
        if ((parts.a == node && parts.b == other) || (parts.a == other && parts.b == node)) expected.push_back(k);
      }
      std::ranges::sort(between);
      EXPECT_EQ(between, expected) << node << ' ' << other;
    }
    for (const ModelNode& other : a.nodes) {
      EXPECT_EQ(a.pairs_between(a.nodes[node].object, other.object),
                b.pairs_between(b.nodes[node].object, other.object));
    }
  }
}

TEST(WorldModel, AGroupIsNumberedAsItsListIs) {
  const std::vector<std::string> crates = names_of("C", 10), walls = names_of("W", 9);
  std::vector<std::string> all = walls;
  all.insert(all.end(), crates.begin(), crates.end());
  const std::string boxes = row_of({"W0", "C0", "C1", "W1", "W2", "C2", "C3", "C4", "C5", "W3", "C6", "C7", "C8", "W4",
                                    "W5", "C9", "W6", "W7", "W8"});
  const std::vector<std::string> in_order{"W0", "C0", "C1", "W1", "W2", "C2", "C3", "C4", "C5", "W3",
                                          "C6", "C7", "C8", "W4", "W5", "C9", "W6", "W7", "W8"};
  struct Case {
    std::string group;
    std::vector<Listed> listed;
  };
  for (const Case& c : {Case{interest("C*", "\"C*\""), each_with(crates, crates)},
                        Case{interest("C*", "\"C*\" \"W*\""), each_with(crates, in_order)},
                        Case{interest("C*", "\"W*\""), each_with(crates, walls)}}) {
    SCOPED_TRACE(c.group);
    const World grouped(boxes + c.group), listed(boxes + interests_of(c.listed));
    EXPECT_EQ(grouped.model->groups.size(), 1u);
    EXPECT_TRUE(listed.model->groups.empty());
    expect_same_pairs(*grouped.model, *listed.model);
    // Among others, of another type and of the same one.
    const std::string before = interests_of({{"W0", {"C3", "C4"}}}, 2), after = interests_of({{"W0", {"W1", "W2"}}});
    const World amid(boxes + before + c.group + after), amid_listed(boxes + before + interests_of(c.listed) + after);
    EXPECT_EQ(amid.model->groups.size(), 1u);
    expect_same_pairs(*amid.model, *amid_listed.model);
  }
  const World two(boxes + interest("C*", "\"C*\"") + interest("C*", "\"W*\""));
  const World two_listed(boxes + interests_of(each_with(crates, crates)) + interests_of(each_with(crates, walls)));
  EXPECT_EQ(two.model->groups.size(), 2u) << "they share ends, and no pair";
  expect_same_pairs(*two.model, *two_listed.model);
}

TEST(WorldModel, WhatIsNotAllOfOneKindIsAList) {
  const std::string crates = row_of(names_of("C", 12));
  const auto groups = [](const std::string& text) { return World(text).model->groups.size(); };
  const std::string all = interest("C*", "\"C*\"");
  EXPECT_EQ(groups(crates + all), 1u);
  EXPECT_EQ(groups(row_of(names_of("C", 4)) + all), 0u) << "few";
  EXPECT_EQ(groups(crates + all + interest("C3", "\"C4\"")), 0u) << "another interest has one of the pairs";
  EXPECT_EQ(groups(crates + box("B", "1 1 1", "0 9 0") + all + interest("B", "\"C4\"")), 1u);
  EXPECT_EQ(groups(crates + "DEF CAR Transform { children [ " + box("WHEEL", "1 1 1", "0 0 0") + " " +
                   box("DOOR", "1 1 1", "2 0 0") + " ] }" + interest("C*", "\"C*\" \"CAR/WHEEL\"")),
            0u)
      << "one is inside another";
  EXPECT_EQ(groups(crates + "DEF C99 Transform { collisionLayers 2 children Shape { geometry Box { } } }" +
                   "DEF C98 Transform { collisionLayers 1 children Shape { geometry Box { } } }" + all),
            0u)
      << "two share no layer";
}

TEST(WorldModel, NamesWhatItCannotAnswer) {
  const World w("DEF GROUP Transform { children " + box("INNER", "1 1 1", "0 0 0") + "}" +
                "DEF EGG Transform { children Shape { geometry Sphere { radius 1e18 } } }" +
                interest("GROUP", "\"INNER\"") + interest("INNER", "\"EGG\""));
  ASSERT_EQ(w.model->unsupported.size(), 1u) << "what is inside of something meets it";
  EXPECT_THAT(w.model->unsupported[0], testing::HasSubstr("EGG"));
}

// Bodies that the scene does not need are not built.
TEST(WorldModel, BuildsNothingThatNoInterestNames) {
  const std::string things =
      box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "0.5 0 0") + "Shape { geometry Sphere { } }\n";
  const World idle(things);
  EXPECT_TRUE(idle.model->bodies.empty());
  EXPECT_TRUE(idle.model->pairs.empty());
  MotionWorld world(*idle.model, sim(0s));
  world.advance(sim(10s));
  EXPECT_EQ(world.counters().contact_searches, 0u);
  const World asked(things + interest("A", "\"B\""));
  ASSERT_EQ(asked.model->bodies.size(), 2u);
  for (const collision::Body& body : asked.model->bodies) EXPECT_EQ(body.meshes_built, 1u);
}

TEST(WorldModel, FindsAnObjectsPairsAndPartners) {
  const World w(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "3 0 0") + box("C", "1 1 1", "6 0 0") +
                box("ALONE", "1 1 1", "9 0 0") + interest("C", "\"A\"") + interest("A", "\"B\" \"C\"") +
                "CollisionInterest { objectPath \"B\" interests [\"A\"] collisionType 0 }\n");
  const auto pairs_of = [&](const char* path) { return w.model->pairs_of(w[path]).all(); };
  ASSERT_EQ(w.model->pairs.size(), 3u);
  EXPECT_THAT(pairs_of("A"), ElementsAre(0, 1, 2));
  EXPECT_THAT(pairs_of("B"), ElementsAre(1, 2));  // of two types
  EXPECT_THAT(pairs_of("C"), ElementsAre(0));
  EXPECT_THAT(pairs_of("ALONE"), IsEmpty());
  EXPECT_THAT(w.model->pairs_between(w["B"], w["A"]), ElementsAre(1, 2));
  EXPECT_TRUE(w.model->are_paired(w["A"], w["C"]));
  EXPECT_FALSE(w.model->are_paired(w["B"], w["C"]));
}

// ---- nodes, carriers and parts ----

constexpr std::uint32_t kNone = ModelNode::kNone;

std::uint32_t index_of(const World& w, const char* path) {
  const ModelNode* const node = w.model->node(w[path]);
  return node == nullptr ? kNone : static_cast<std::uint32_t>(node - w.model->nodes.data());
}
std::uint32_t carrier_of(const World& w, const char* path) { return w.model->node(w[path])->carrier; }

// The part pairs of a pair as the names of their parts; "-" stands for all parts of an end.
struct Named {
  std::string a, b, common;
  bool fixed = false;
  bool operator==(const Named&) const = default;
  friend void PrintTo(const Named& n, std::ostream* out) {
    *out << n.a << " against " << n.b << " in " << n.common << (n.fixed ? ", fixed" : "");
  }
};
std::vector<Named> part_pairs_of(const World& w, std::uint32_t pair) {
  const auto name = [&](std::uint32_t part, const char* none) {
    return part == kNone ? std::string(none) : w.scene.path_of(w.model->nodes.at(part).object);
  };
  std::vector<Named> named;
  const auto [first, end] = w.model->part_pairs_of_pair(pair);
  for (std::uint32_t k = first; k < end; ++k) {
    const PartPair& parts = w.model->part_pairs[k];
    EXPECT_EQ(parts.pair, pair);
    named.push_back({name(parts.a, "-"), name(parts.b, "-"), name(parts.common, "the world"), parts.fixed});
  }
  return named;
}

std::string car_and_curb() { return car_and_wheel() + box("CURB", "0.5 0.6 4", "8 0.5 0"); }

TEST(WorldModel, WhatStandsBelowAnEndIsAPartOfIt) {
  const World w(car_and_curb() + interest("CAR", "\"CURB\"") + interest("WHEEL", "\"CURB\""));
  ASSERT_EQ(w.model->nodes.size(), 3u);
  EXPECT_EQ(carrier_of(w, "CAR"), kNone);
  EXPECT_EQ(carrier_of(w, "WHEEL"), index_of(w, "CAR"));
  EXPECT_EQ(w.model->node(w["WHEEL"])->depth, 1u);
  EXPECT_THAT(w.model->parts_of_node[index_of(w, "CAR")], ElementsAre(index_of(w, "CAR"), index_of(w, "WHEEL")));
  EXPECT_THAT(w.model->parts_of_node[index_of(w, "WHEEL")], ElementsAre(index_of(w, "WHEEL")));
  EXPECT_THAT(w.model->carried_by[index_of(w, "CAR")], ElementsAre(index_of(w, "WHEEL")));
  EXPECT_EQ(w.model->body(w["CAR"])->vertices().size(), 8u) << "its wheel is a body of its own";
  EXPECT_THAT(part_pairs_of(w, 0),
              ElementsAre(Named{"CAR", "CURB", "the world"}, Named{"CAR/WHEEL", "CURB", "the world"}));
  EXPECT_THAT(part_pairs_of(w, 1), ElementsAre(Named{"CAR/WHEEL", "CURB", "the world"}));
}

// An end that contains the other one meets it with what it is besides; a part never meets itself.
TEST(WorldModel, AnEndMayContainTheOther) {
  const World w(car_and_curb() + interest("CAR", "\"CAR/WHEEL\""));
  EXPECT_THAT(w.model->unsupported, IsEmpty());
  EXPECT_THAT(part_pairs_of(w, 0),
              ElementsAre(Named{"CAR", "CAR/WHEEL", "CAR"}, Named{"CAR/WHEEL", "CAR/WHEEL", "CAR/WHEEL", true}));
}

std::string bus_and_lamp(const std::string& bus_fields) {
  return "DEF BUS Transform { " + bus_fields + " children [ " + box("DOOR", "1 2 0.1", "0 1 1.5") +
         box("POST", "0.1 2 0.1", "2 1 1.5") + "DEF SEAT Group { children Shape { geometry Box { } } }\n" +
         "DEF RAIL Group { children Shape { geometry Box { } } }\n] }\n" + box("LAMP", "0.2 5 0.2", "12 1 1.6");
}

TEST(WorldModel, TwoPartsMeetInTheFrameOfTheirNearestCommonCarrier) {
  const World w(bus_and_lamp("velocityVector 5 0 0") + interest("DOOR", "\"POST\" \"LAMP\" \"SEAT\"") +
                interest("SEAT", "\"RAIL\" \"LAMP\""));
  EXPECT_THAT(w.model->moving, ElementsAre(w["BUS"]));
  EXPECT_THAT(part_pairs_of(w, 0), ElementsAre(Named{"BUS/DOOR", "BUS/POST", "BUS"}));
  EXPECT_THAT(part_pairs_of(w, 1), ElementsAre(Named{"BUS/DOOR", "LAMP", "the world"}));
  EXPECT_THAT(part_pairs_of(w, 2), ElementsAre(Named{"BUS/DOOR", "BUS/SEAT", "BUS"}));
  EXPECT_THAT(part_pairs_of(w, 3), ElementsAre(Named{"BUS/SEAT", "BUS/RAIL", "BUS", true})) << "both go with the bus";
  EXPECT_THAT(part_pairs_of(w, 4), ElementsAre(Named{"BUS/SEAT", "LAMP", "the world"}));
  const std::uint32_t bus = index_of(w, "BUS"), door = index_of(w, "DOOR"), seat = index_of(w, "SEAT");
  EXPECT_THAT(w.model->chain_of(door), ElementsAre(bus, door));
  EXPECT_THAT(w.model->chain_of(door, bus), ElementsAre(door));
  EXPECT_THAT(w.model->chain_of(seat, bus), ElementsAre(seat));
  EXPECT_THAT(w.model->chain_of(bus), ElementsAre(bus));
  // What the bus itself may change: what is outside of it.
  EXPECT_THAT(w.model->part_pairs_moved_by(bus).all(), ElementsAre(1, 4));
  EXPECT_THAT(w.model->part_pairs_moved_by(door).all(), ElementsAre(0, 1, 2));
  EXPECT_THAT(w.model->part_pairs_of(bus), IsEmpty()) << "it is no end";
}

TEST(WorldModel, WhatNothingMovesIsNoCarrier) {
  const World w(bus_and_lamp("") + interest("DOOR", "\"POST\"") + interest("SEAT", "\"RAIL\""));
  EXPECT_EQ(w.model->node(w["BUS"]), nullptr);
  EXPECT_EQ(carrier_of(w, "DOOR"), kNone);
  EXPECT_THAT(part_pairs_of(w, 0), ElementsAre(Named{"BUS/DOOR", "BUS/POST", "the world"}));
  EXPECT_THAT(part_pairs_of(w, 1), ElementsAre(Named{"BUS/SEAT", "BUS/RAIL", "the world", true}));
}

// The box of an end is that of all that it consists of, and it changes as a carrier turns.
TEST(WorldModel, BoxesAreThoseOfWholeEndsInTheWorld) {
  const World w(bus_and_lamp("velocityVector 5 0 0") + car_and_curb() + interest("CAR", "\"CURB\"", 0) +
                interest("DOOR", "\"POST\"", 0) + interest("SEAT", "\"RAIL\"", 0));
  EXPECT_THAT(part_pairs_of(w, 0), ElementsAre(Named{"CAR", "CURB", "the world"}))
      << "no interest names the wheel, and nothing moves it: it is of the car's body";
  EXPECT_THAT(part_pairs_of(w, 1), ElementsAre(Named{"BUS/DOOR", "BUS/POST", "the world"}));
  EXPECT_THAT(part_pairs_of(w, 2), ElementsAre(Named{"BUS/SEAT", "BUS/RAIL", "the world"}));
  EXPECT_THAT(w.model->part_pairs_moved_by(index_of(w, "BUS")).all(), ElementsAre(1, 2));
  const World turns(car_and_curb() + interest("CAR", "\"CURB\"", 0), {"WHEEL"});
  EXPECT_THAT(part_pairs_of(turns, 0), ElementsAre(Named{"-", "-", "the world"}));
  EXPECT_THAT(turns.model->part_pairs_moved_by(index_of(turns, "WHEEL")).all(), ElementsAre(0));
  EXPECT_THAT(turns.model->part_pairs_moved_by(index_of(turns, "CAR")).all(), ElementsAre(0));
  EXPECT_THAT(turns.model->part_pairs_moved_by(index_of(turns, "CURB")).all(), ElementsAre(0));
}

// What moves the wheel does not move the car's own body; it does move a part of the car's box.
TEST(WorldModel, APartIsMovedByItsOwnChainAndAWholeEndByThatOfAnyPart) {
  const World parts(car_and_curb() + interest("CAR", "\"CURB\""), {"WHEEL"}),
      boxes(car_and_curb() + interest("CAR", "\"CURB\"", 0), {"WHEEL"});
  const auto moved = [](const World& w, const PartPair& pair, const char* by) {
    return w.model->any_mover(pair, true, [&](std::uint32_t i) { return i == w.model->index_of(w[by]); });
  };
  int of_car = 0, of_wheel = 0;
  for (const PartPair& pair : parts.model->part_pairs) {
    const bool wheel = pair.a == parts.model->index_of(parts["WHEEL"]);
    ++(wheel ? of_wheel : of_car);
    EXPECT_EQ(moved(parts, pair, "WHEEL"), wheel);
    EXPECT_TRUE(moved(parts, pair, "CAR"));
  }
  EXPECT_EQ(of_car, 1);
  EXPECT_EQ(of_wheel, 1);
  EXPECT_TRUE(moved(boxes, boxes.model->part_pairs[0], "WHEEL"));
}

TEST(WorldModel, WhatPeersOwnCarries) {
  const std::string text = car_and_curb() + box("ALONE", "1 1 1", "0 9 0") + interest("WHEEL", "\"CURB\"");
  const World nobodys(text);
  EXPECT_EQ(nobodys.model->node(nobodys["CAR"]), nullptr);
  EXPECT_EQ(carrier_of(nobodys, "WHEEL"), kNone);
  const World owned(text, {"CAR", "ALONE"});
  EXPECT_EQ(carrier_of(owned, "WHEEL"), index_of(owned, "CAR"));
  EXPECT_EQ(owned.model->node(owned["ALONE"]), nullptr) << "it meets nothing and carries nothing";
  EXPECT_TRUE(owned.model->body(owned["CAR"])->vertices().empty()) << "only its motion is needed";
  EXPECT_EQ(owned.model->body(owned["CAR"])->meshes_built, 0u);
  EXPECT_THAT(owned.model->part_pairs_moved_by(index_of(owned, "CAR")).all(), ElementsAre(0));
  EXPECT_THAT(part_pairs_of(owned, 0), ElementsAre(Named{"CAR/WHEEL", "CURB", "the world"}));
}

// What the file moves inside of an end is a part of its own, and what stands in between goes with what is above it.
TEST(WorldModel, PartsNest) {
  const World w("DEF CRANE Transform { velocityVector 1 0 0 children [ " +
                    box_with("ARM", "4 1 1", "0 5 0", "",
                             "DEF JOINT Transform { children " + box("HOOK", "1 1 1", "4 0 0") + "}\n") +
                    "] }\n" + box("LOAD", "1 1 1", "9 0 0") + interest("CRANE", "\"LOAD\""),
                {"CRANE/ARM", "CRANE/ARM/JOINT/HOOK"});
  const std::uint32_t crane = index_of(w, "CRANE"), arm = index_of(w, "ARM"), hook = index_of(w, "HOOK");
  EXPECT_THAT(w.model->chain_of(hook), ElementsAre(crane, arm, hook));
  EXPECT_EQ(w.model->node(w["JOINT"]), nullptr);
  EXPECT_EQ(w.model->node(w["HOOK"])->depth, 2u);
  EXPECT_THAT(w.model->parts_of_node[crane], ElementsAre(arm, hook)) << "the crane itself has no Shape of its own";
  EXPECT_THAT(w.model->carried_by[crane], ElementsAre(arm, hook));
  EXPECT_THAT(w.model->part_pairs_moved_by(arm).all(), ElementsAre(0, 1));
  EXPECT_THAT(w.model->part_pairs_moved_by(hook).all(), ElementsAre(1));
}

TEST(WorldModel, AContactIsAnsweredWhereAColliderResponds) {
  const World w(box("A", "1 1 1", "0 0 0", kBounces) + box("B", "1 1 1", "3 0 0", kBounces) +
                box("C", "1 1 1", "6 0 0") + interest("A", "\"C\"") + interest("C", "\"B\""));
  EXPECT_TRUE(w.model->is_answered(w["A"], w["C"]));
  EXPECT_TRUE(w.model->is_answered(w["C"], w["A"]));
  EXPECT_FALSE(w.model->is_answered(w["C"], w["B"])) << "a collidee does not respond";
  EXPECT_FALSE(w.model->is_answered(w["A"], w["B"])) << "no interest";
}

const std::string kCarInALot = "DEF LOT Transform { children [ " + car_and_wheel() + "] }\n" +
                               box("CURB", "0.5 0.6 4", "8 0.5 0") + box("BIRD", "1 1 1", "0 9 0") +
                               interest("LOT", "\"CURB\"");

const IsOwned kNoneIsOwned = [](ObjectId) { return false; };

TEST(Extended, AddsTheCarriersThatSomebodyMoves) {
  const World w(kCarInALot);
  ASSERT_EQ(w.model->parts_of_node[0].size(), 1u) << "LOT is one body";
  const auto next = extended(*w.model, std::vector{w["WHEEL"]});
  EXPECT_TRUE(next->is_carrier(w["WHEEL"]));
  EXPECT_EQ(next->carrier_of(w["WHEEL"]), w["LOT"]);
  EXPECT_EQ(next->parts_of_node[0].size(), 2u);
  EXPECT_EQ(next->pairs.size(), w.model->pairs.size());
  EXPECT_EQ(next->part_pairs.size(), 2u);
  EXPECT_EQ(next->body(w["CURB"])->surface, w.model->body(w["CURB"])->surface) << "shared";
  EXPECT_NE(next->body(w["LOT"])->surface, w.model->body(w["LOT"])->surface) << "without the wheel";
  const auto more = extended(*next, std::vector{w["CAR"]});
  EXPECT_EQ(more->carrier_of(w["WHEEL"]), w["CAR"]);
  EXPECT_EQ(more->body(w["WHEEL"])->surface, next->body(w["WHEEL"])->surface);
}

TEST(NeedsCarrier, WhereSomethingElseMovesAboveOrBelow) {
  const World w(kCarInALot);
  EXPECT_TRUE(needs_carrier(*w.model, w["CAR"], kNoneIsOwned)) << "it is part of an end";
  EXPECT_TRUE(needs_carrier(*w.model, w["WHEEL"], kNoneIsOwned));
  for (const char* path : {"LOT", "CURB", "BIRD", "LOT/CAR/0"}) {
    EXPECT_FALSE(needs_carrier(*w.model, w[path], kNoneIsOwned)) << path;
  }
  const auto next = extended(*w.model, std::vector{w["CAR"]});
  EXPECT_FALSE(needs_carrier(*next, w["CAR"], kNoneIsOwned));
}

TEST(NeedsCarrier, WhereWhatMeetsNothingIsOwned) {
  const World w(car_and_wheel());
  const ObjectId car = w["CAR"], wheel = w["WHEEL"];
  for (const auto& [id, owned] : {std::pair{car, wheel}, std::pair{wheel, car}}) {
    EXPECT_FALSE(needs_carrier(*w.model, id, kNoneIsOwned));
    EXPECT_TRUE(needs_carrier(*w.model, id, [other = owned](ObjectId each) { return each == other; }));
  }
  EXPECT_EQ(extended(*w.model, std::vector{car, wheel})->node(wheel)->depth, 1u);
}

}  // namespace peerd::replication::world_model_test
