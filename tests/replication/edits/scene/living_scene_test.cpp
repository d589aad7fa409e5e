#include "replication/edits/scene/living_scene.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/scene/reader.hpp"
#include "core/vrml/document.hpp"
#include "core/writer/scene_difference.hpp"
#include "core/writer/writer.hpp"

namespace peerd::replication {
namespace {

const std::string kHead = "#VRML V2.0 utf8\n";
const std::string kWall = "DEF WALL Transform { translation 9 0 0 children Shape { geometry Box { size 1 4 9 } } }\n";
const std::string kFloor = "DEF FLOOR Transform { children Shape { geometry Box { size 9 1 9 } } }\n";
constexpr AuthorId kAda{7}, kBob{9};

Scene read(const std::string& text) {
  ReadResult result = read_world(text);
  EXPECT_TRUE(result.scene) << text;
  return std::move(result.scene).value_or(Scene{});
}

SimTime at_ms(int ms) { return SimTime{} + std::chrono::milliseconds(ms); }

std::string text_of(const LivingScene& living) {
  const auto written = write_world(*living.scene());
  EXPECT_TRUE(written);
  return written ? written->text : "";
}

// Everything that is due until then, each change at its own instant.
std::vector<LivingScene::Change> apply_all(LivingScene& living, SimTime until, SimTime known = SimTime::min()) {
  std::vector<LivingScene::Change> changes;
  while (auto change = living.apply(until, known)) changes.push_back(*std::move(change));
  return changes;
}

AddNodes adding(const std::string& text, std::uint32_t first = 0) { return {{}, {}, kHead + text, first, first, {}}; }

SetField placing(NodeId node, int x) { return {node, "translation", std::to_string(x) + " 0 0", 0}; }

TEST(LivingScene, ChangesAtTheStampOfAnOperation) {
  const Scene file = read(kHead + kWall);
  LivingScene living(file);
  EXPECT_TRUE(living.add({{kAda, 1}, at_ms(100), adding(kFloor)}));
  EXPECT_FALSE(living.add({{kAda, 1}, at_ms(100), adding(kFloor)}));
  EXPECT_FALSE(living.apply(at_ms(99), SimTime::min()));
  const auto change = living.apply(at_ms(200), SimTime::min());
  ASSERT_TRUE(change && change->scene);
  EXPECT_EQ(change->at, at_ms(100));
  EXPECT_EQ(difference(read(kHead + kWall + kFloor), *change->scene), "");
  EXPECT_EQ(change->scene->path_of(ObjectId(0, kAda.value)), "FLOOR");
  EXPECT_FALSE(living.apply(at_ms(200), SimTime::min()));
}

TEST(LivingScene, TakesOneInstantAfterTheOtherButWhatIsPastAtOnce) {
  const Scene file = read(kHead + kWall);
  LivingScene in_time(file), late(file);
  const NodeId wall = file.document->ids.id_of(file.at(*file.find("WALL")).node);
  for (LivingScene* living : {&in_time, &late}) {
    for (int k = 1; k <= 4; ++k) {
      living->add({{kAda, static_cast<std::uint32_t>(k)}, at_ms(100 * k), placing(wall, k)});
    }
  }
  EXPECT_EQ(apply_all(in_time, at_ms(400)).size(), 4u);
  EXPECT_EQ(apply_all(late, at_ms(400), at_ms(300)).size(), 2u);
  EXPECT_EQ(text_of(in_time), text_of(late));
}

TEST(LivingScene, TheNextIdsOfAnAuthorFollowThoseItHasUsed) {
  const Scene file = read(kHead + kWall);
  LivingScene living(file);
  const auto used = static_cast<std::uint32_t>(read(kHead + kFloor).instances.size());
  ASSERT_GT(used, 1u);
  living.add({{kAda, 1}, at_ms(100), adding(kFloor, 5)});
  EXPECT_EQ(living.next_ids(kAda).object, 5 + used) << "before it is done";
  ASSERT_EQ(apply_all(living, at_ms(300)).size(), 1u);
  EXPECT_EQ(living.next_ids(kAda).object, 5 + used);
  EXPECT_EQ(living.next_ids(kBob).object, LivingScene::NextIds{}.object);
}

TEST(LivingScene, SaysWhatAnOperationCannotDo) {
  const Scene file = read(kHead + kWall);
  LivingScene living(file);
  const ObjectId wall = *file.find("WALL");
  living.add({{kAda, 1}, at_ms(100), RemoveObject{wall}});
  living.add({{kBob, 1}, at_ms(200), placing(file.document->ids.id_of(file.at(wall).node), 3)});
  const auto changes = apply_all(living, at_ms(300));
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].outcomes.at(0).refused, "");
  EXPECT_EQ(changes[1].outcomes.at(0).id, (OperationId{kBob, 1}));
  EXPECT_EQ(changes[1].outcomes.at(0).refused, "it is not in the scene any more");
  EXPECT_EQ(changes[1].scene, nullptr);
}

// One that comes late goes before those that are there, and their outcomes are said anew.
TEST(LivingScene, PutsALateOperationInItsPlace) {
  const Scene file = read(kHead + kWall);
  LivingScene living(file);
  const ObjectId wall = *file.find("WALL");
  living.add({{kBob, 1}, at_ms(200), placing(file.document->ids.id_of(file.at(wall).node), 3)});
  ASSERT_EQ(apply_all(living, at_ms(300)).size(), 1u);
  living.add({{kAda, 1}, at_ms(100), RemoveObject{wall}});
  const auto change = living.apply(at_ms(300), at_ms(300));
  ASSERT_TRUE(change && change->scene);
  EXPECT_EQ(change->at, at_ms(100));
  ASSERT_EQ(change->outcomes.size(), 2u);
  EXPECT_NE(change->outcomes[1].refused, "");
  EXPECT_EQ(change->scene->instances.size(), 0u);
}

TEST(LivingScene, DraftsSayWhatATextMeansByNamesOfTheWorld) {
  const Scene file = read(kHead + kWall);
  LivingScene living(file);
  living.add({{kBob, 1}, at_ms(900), adding(kFloor)});  // to come, and counts all the same
  const auto draft =
      living.draft(adding(kFloor + "CollisionInterest { objectPath \"FLOOR\" interests [ \"WALL\" ] }", 5), kAda);
  ASSERT_TRUE(draft) << draft.error();
  const auto& add = std::get<AddNodes>(draft->body);
  ASSERT_EQ(add.names.size(), 1u);
  EXPECT_EQ(add.names[0], (std::pair<std::string, ObjectId>{"WALL", *file.find("WALL")}));
  EXPECT_EQ(draft->objects, 2u);
  EXPECT_EQ(living.draft(adding("Nonsense {"), kAda).error().substr(0, 9), "operation");
  EXPECT_FALSE(living.draft(RemoveObject{ObjectId(99)}, kAda));
}

using Refused = std::map<OperationId, std::string>;

Refused refused_in(const std::vector<LivingScene::Change>& changes) {
  Refused all;
  for (const LivingScene::Change& change : changes) {
    for (const LivingScene::Outcome& outcome : change.outcomes) all[outcome.id] = outcome.refused;
  }
  return all;
}

TEST(LivingScene, OfTwoThatTakeAnObjectTheEarlierOneHasIt) {
  const Scene file = read(kHead + kWall + kFloor);
  const ObjectId wall = *file.find("WALL");
  const PeerId ada{1}, bob{2};
  LivingScene living(file);
  living.add({{kAda, 1}, at_ms(200), GiveObject{wall, ada, kNobody}});
  auto change = living.apply(at_ms(300), at_ms(300));
  ASSERT_TRUE(change);
  EXPECT_EQ(change->given, (std::vector<std::pair<ObjectId, PeerId>>{{wall, ada}}));
  EXPECT_EQ(change->scene, nullptr) << "who owns what is not in the scene";
  living.add({{kBob, 1}, at_ms(100), GiveObject{wall, bob, kNobody}});  // it comes late
  change = living.apply(at_ms(300), at_ms(300));
  ASSERT_TRUE(change);
  EXPECT_EQ(change->given, (std::vector<std::pair<ObjectId, PeerId>>{{wall, bob}}));
  EXPECT_EQ(refused_in({*change}).at({kAda, 1}), "peer 2 owns it by then");
  living.add({{kBob, 2}, at_ms(400), GiveObject{wall, kNobody, bob}});  // released
  living.add({{kAda, 2}, at_ms(500), GiveObject{wall, ada, kNobody}});
  living.add({{kAda, 3}, at_ms(600), RemoveObject{wall}});
  living.add({{kBob, 3}, at_ms(700), GiveObject{wall, bob, ada}});
  EXPECT_EQ(living.apply(at_ms(450), at_ms(450))->given, (std::vector<std::pair<ObjectId, PeerId>>{{wall, kNobody}}));
  EXPECT_EQ(living.apply(at_ms(550), at_ms(550))->given, (std::vector<std::pair<ObjectId, PeerId>>{{wall, ada}}));
  change = living.apply(at_ms(800), at_ms(800));
  EXPECT_EQ(refused_in({*change}).at({kBob, 3}), "it is not in the scene any more");
  EXPECT_TRUE(living.owners().empty());
}

const std::string kOfAllKinds =
    kHead + kWall + kFloor +
    "DEF CAR Transform { children [ DEF WHEEL Transform { children Shape { geometry Sphere { } } } USE WHEEL ] }\n"
    "DEF PLANE Transform { collisionResponse CollisionResponse { responseType 2 } children Shape {\n"
    "  geometry DEF FACE IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] }\n"
    "  coordIndex [ 0 1 2 -1 ] } } }\n"
    "USE CAR\n"
    "DEF CLOCK TimeSensor { } DEF PATH PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 0 0 ] }\n"
    "DEF KEYS KeySensor { recipient \"CAR\" }\n"
    "CollisionInterest { objectPath \"WALL\" interests [ \"FLOOR\" \"PLANE\" ] }\n"
    "ROUTE CLOCK.fraction_changed TO PATH.set_fraction ROUTE PATH.value_changed TO PLANE.set_translation\n";
const std::vector<std::string> kTexts{
    "DEF NEW Transform { children Shape { geometry Box { } } }",
    "DEF TWICE Group { children [ DEF IN Transform { } USE IN ] } USE TWICE",
    "CollisionInterest { objectPath \"CAR\" interests [ \"WALL\" \"FLOOR\" ] }",
    "KeySensor { recipient \"PLANE\" }",
    "DEF A TimeSensor { } DEF B PositionInterpolator { } ROUTE A.fraction_changed TO B.set_fraction",
};
const std::vector<std::pair<std::string, std::vector<std::string>>> kValues{
    {"translation", {"1 2 3", "0 0 0"}},
    {"coordIndex", {"[ 0 1 2 -1 ]", "[ 0 1 3 -1 ]", "[ ]"}},
    {"point", {"[ 0 0 0, 1 0 0 ]", "[ 0 0 0, 1 0 0, 0 1 0, 0 0 1 ]"}},
    {"coord", {"NULL", "Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] }"}},
    {"geometry", {"NULL", "Box { }", "IndexedFaceSet { coordIndex [ 0 1 2 -1 ] }"}},
    {"restitution", {"0.5", "2"}},
    {"collisionResponse", {"NULL", "CollisionResponse { responseType 2 restitution 3 }"}},
    {"loop", {"TRUE"}},
};

// Operations on all kinds of things, many of which are impossible.
class AnyOperations {
 public:
  AnyOperations(const Scene& file, std::uint32_t seed) : file_(file), random_(seed) {
    for (std::uint32_t i = 0; i < file.instances.size(); ++i) objects_.push_back(file.id_of(i));
    for (std::uint32_t i = 0; i < file.document->nodes.size(); ++i) nodes_.push_back(file.document->ids.id_of(i));
  }
  std::uint32_t below(std::size_t n) { return static_cast<std::uint32_t>(random_() % n); }
  // The k-th one, whose ids are its own.
  OperationBody next(std::uint32_t k) {
    ScenePlace place;
    if (below(2) == 0) place.parent = any(objects_);
    if (below(4) == 0) place.before = any(objects_);
    switch (below(8)) {
      case 0:
        return adding_at(place, k);
      case 1:
        return RemoveObject{any(objects_)};
      case 2:
        return RemoveNode{any(nodes_)};
      case 3:
        return MoveObject{any(objects_), place.parent, place.before};
      case 4:
        return ChangeRoute{any(nodes_), any(nodes_), "fraction_changed", "set_fraction", below(2) == 0};
      case 5: {
        GiveObject give{any(objects_), PeerId{below(4)}, PeerId{below(4)}};
        if (below(2) == 0) give.placement = {{1, 2, 3}, {0, 1, 0, 0.5f}};
        return give;
      }
      default:
        return setting(k);
    }
  }

 private:
  template <class T>
  T any(const std::vector<T>& list) {
    return list[below(list.size())];
  }
  AddNodes adding_at(const ScenePlace& place, std::uint32_t k) {
    AddNodes add{place.parent, place.before, kHead + any(kTexts), 10 * k, 10 * k, {}};
    for (const char* const name : {"CAR", "FLOOR", "PLANE", "WALL"}) add.names.emplace_back(name, *file_.find(name));
    for (std::uint32_t i = 0; i < 4; ++i) {
      objects_.emplace_back(10 * k + i, kAda.value);
      nodes_.emplace_back(10 * k + i, kAda.value);
    }
    return add;
  }
  // The node has the field, more often than chance finds one.
  SetField setting(std::uint32_t k) {
    const auto& [field, choices] = any(kValues);
    NodeId node = any(nodes_);
    for (int tries = 0; tries < 20; ++tries) {
      const auto known = file_.document->ids.find(node, file_.document->nodes.size());
      if (!known || vrml::find_field(*file_.document->nodes[*known].type, field) != nullptr) break;
      node = any(nodes_);
    }
    return {node, field, any(choices), 10 * k + 5};
  }

  const Scene& file_;
  std::mt19937 random_;
  std::vector<ObjectId> objects_;
  std::vector<NodeId> nodes_;
};

// A list of corners needs its points when it comes: points that come later do not allow it after all.
TEST(LivingScene, TogetherDoesWhatOneAfterTheOtherDoes) {
  const Scene file = read(kOfAllKinds);
  std::size_t refused = 0, done = 0;
  for (std::uint32_t seed = 1; seed <= 400; ++seed) {
    AnyOperations operations(file, seed);
    LivingScene single(file), together(file);
    const std::uint32_t count = 2 + operations.below(20);
    for (std::uint32_t k = 1; k <= count; ++k) {
      const Operation operation{{kAda, k}, at_ms(static_cast<int>(k)), operations.next(k)};
      single.add(operation);
      together.add(operation);
    }
    const auto by_one = apply_all(single, at_ms(100));
    const auto at_once = apply_all(together, at_ms(100), at_ms(100));
    EXPECT_EQ(by_one.size(), count);
    EXPECT_EQ(at_once.size(), 1u);
    const Refused all = refused_in(by_one);
    EXPECT_EQ(all, refused_in(at_once)) << "seed " << seed;
    EXPECT_EQ(text_of(single), text_of(together)) << "seed " << seed;
    EXPECT_EQ(single.owners(), together.owners()) << "seed " << seed;
    for (const auto& [id, why] : all) ++(why.empty() ? done : refused);
  }
  EXPECT_GT(done, 1000u);
  EXPECT_GT(refused, 1000u);
}

}  // namespace
}  // namespace peerd::replication
