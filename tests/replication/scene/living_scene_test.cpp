#include "replication/scene/living_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

// Whatever the order in which they come, and whenever they are applied: peers that know the same have the same scene.
TEST(LivingScene, DependsOnWhatIsKnownAlone) {
  const Scene file = read(kHead + kWall + kFloor);
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    std::mt19937 random(seed);
    const auto draw = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
    std::vector<Operation> all;
    std::vector<ObjectId> objects{*file.find("WALL"), *file.find("FLOOR")};
    std::vector<NodeId> nodes;
    for (const ObjectId id : objects) nodes.push_back(file.document->ids.id_of(file.at(id).node));
    std::map<AuthorId, std::uint32_t> numbers;
    for (std::uint32_t k = 0; k < 12; ++k) {
      const AuthorId author = draw(2) == 0 ? kAda : kBob;
      OperationBody body = placing(nodes[draw(static_cast<std::uint32_t>(nodes.size()))], static_cast<int>(k));
      const auto any = [&] { return objects[draw(static_cast<std::uint32_t>(objects.size()))]; };
      switch (draw(4)) {
        case 0:
          body = RemoveObject{any()};
          break;
        case 1:
          body = MoveObject{any(), any(), {}};
          break;
        case 2:
          body = adding("DEF N" + std::to_string(k) + " Transform { }", 10 * k);
          objects.emplace_back(10 * k, author.value);
          nodes.emplace_back(10 * k, author.value);
          break;
        default:
          break;
      }
      all.push_back({{author, ++numbers[author]}, at_ms(static_cast<int>(draw(20))), std::move(body)});
    }
    LivingScene in_order(file);
    for (const Operation& operation : all) in_order.add(operation);
    (void)apply_all(in_order, at_ms(100));
    LivingScene any_order(file);
    std::ranges::shuffle(all, random);
    for (const Operation& operation : all) {
      any_order.add(operation);
      if (draw(2) == 0) (void)any_order.draft(placing(nodes[0], 1), kAda);
      if (draw(2) == 0)
        (void)apply_all(any_order, at_ms(static_cast<int>(draw(30))), at_ms(static_cast<int>(draw(30))));
    }
    (void)apply_all(any_order, at_ms(100), at_ms(100));
    EXPECT_EQ(text_of(in_order), text_of(any_order)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace peerd::replication
