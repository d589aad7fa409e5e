#include "replication/motion/world_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "replication/motion/motion_world.hpp"
#include "tests/replication/worlds.hpp"

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
  const auto pairs_of = [&](const char* path) {
    const auto found = w.model->pairs_of(w[path]);
    return std::vector<std::uint32_t>(found.begin(), found.end());
  };
  ASSERT_EQ(w.model->pairs.size(), 3u);
  EXPECT_THAT(pairs_of("A"), ElementsAre(0, 1, 2));
  EXPECT_THAT(pairs_of("B"), ElementsAre(1, 2));  // of two types
  EXPECT_THAT(pairs_of("C"), ElementsAre(0));
  EXPECT_THAT(pairs_of("ALONE"), IsEmpty());
  EXPECT_THAT(w.model->partners_of_node[0], ElementsAre(1, 2));
  EXPECT_THAT(w.model->partners_of_node[1], ElementsAre(0));
}

}  // namespace peerd::replication::world_model_test
