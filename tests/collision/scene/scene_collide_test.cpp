#include "collision/scene/scene_collide.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/core/read_text.hpp"

namespace peerd::collision::scene_collide_test {

struct World {
  Scene scene;
  ShapePlacement placement{scene, {}};
  ShapeBoxes boxes{scene, placement};
  SceneCollide collide{scene, placement, boxes};

  explicit World(const std::string& body) : scene(scene_of(body)) {}
  [[nodiscard]] ObjectId id(std::string_view path) const { return scene.find(path).value(); }
};

constexpr const char* kRow = R"(
  DEF A Group { children [ Shape { geometry Box {} }
                           Transform { translation 20 0 0 children Shape { geometry Box {} } } ] }
  DEF B Transform { translation 1.5 0 0 children Shape { geometry Box {} } }
  DEF C Transform { translation 5 0 0 children Shape { geometry Box {} } })";

TEST(SceneCollide, VisitsTheShapesWhoseBoxesOverlap) {
  World world(kRow);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> visited;
  const auto visit = [&](const ClosePair& close) {
    visited.emplace_back(close.a, close.b);
    EXPECT_TRUE(close.collider_first);
    return false;
  };
  ASSERT_TRUE(world.collide.visit_close_pairs(world.id("A"), world.id("B"), visit).has_value());
  ASSERT_EQ(visited.size(), 1u);
  EXPECT_EQ(visited[0].first, 1u);
  EXPECT_EQ(world.placement.geometries().counters().soups_built, 2u);  // the box that is far is not triangulated
}

TEST(SceneCollide, GapsAreCertain) {
  World world(kRow);
  EXPECT_TRUE(world.collide.separated_by(world.id("B"), world.id("C"), 1.0));
  EXPECT_FALSE(world.collide.separated_by(world.id("B"), world.id("C"), 1.75));
  EXPECT_FALSE(world.collide.separated_by(world.id("A"), world.id("B"), 0.0));
}

TEST(SceneCollide, AShapeDoesNotCollideWithItself) {
  World world("DEF A Transform { children DEF S Shape { geometry Box {} } }");
  const auto found = world.collide.collide(world.id("A"), world.id("A/S"), CollisionType::kAllPairs);
  ASSERT_TRUE(found.has_value());
  EXPECT_FALSE(found->colliding);
}

}  // namespace peerd::collision::scene_collide_test
