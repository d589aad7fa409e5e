#include "collision/scene/shape_boxes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd::collision::shape_boxes_test {

using ::testing::HasSubstr;

struct World {
  Scene scene;
  ShapePlacement placement{scene, {}};
  ShapeBoxes boxes{scene, placement};

  explicit World(const std::string& body) : scene(scene_of(body)) {}
  void move(std::uint32_t instance, const TransformFields& fields) {
    placement.move(scene.instances[instance].transform, fields);
    placement.apply_moves([&](std::uint32_t begin, std::uint32_t end) { boxes.invalidate_subtree(begin, end); });
  }
};

// Instances: 0 A, 1 B, 2 its Shape, 3 C, 4 its Shape.
constexpr const char* kTwo = R"(
  DEF A Transform { children [ DEF B Transform { children Shape { geometry Box {} } }
                               DEF C Transform { translation 5 0 0 children Shape { geometry Box {} } } ] })";

TEST(ShapeBoxes, HoldTheirSubtrees) {
  World world(kTwo);
  const WorldBox of_a = world.boxes.box(0, Surfaces::kColliding);
  EXPECT_TRUE(of_a.contains(world.boxes.box(2, Surfaces::kColliding)));
  EXPECT_TRUE(of_a.contains(world.boxes.box(3, Surfaces::kColliding)));
  EXPECT_NEAR(of_a.lo[0], -1.0, 1e-9);
  EXPECT_NEAR(of_a.hi[0], 6.0, 1e-9);
  EXPECT_LT(of_a.lo[0], -1.0);  // room for rounding
  EXPECT_EQ(world.boxes.boxes_placed(), 2u);
}

TEST(ShapeBoxes, BothSetsShareABoxThatIsTheSame) {
  World world(R"(Collision { children Shape { geometry Box {} } proxy Shape { geometry Box { size 8 8 8 } } }
                 Shape { geometry Box {} })");
  EXPECT_GT(world.boxes.box(0, Surfaces::kColliding).hi[0], 3.9);
  EXPECT_LT(world.boxes.box(0, Surfaces::kDrawn).hi[0], 1.1);
  const std::uint64_t placed = world.boxes.boxes_placed();
  const auto last = static_cast<std::uint32_t>(world.scene.instances.size() - 1);
  EXPECT_EQ(world.boxes.box(last, Surfaces::kColliding), world.boxes.box(last, Surfaces::kDrawn));
  EXPECT_EQ(world.boxes.boxes_placed(), placed + 1);
}

TEST(ShapeBoxes, TightBoxesAreThoseOfUsedVerticesOnly) {
  World world(R"(DEF A Transform { translation 1 0 0 children Shape { geometry IndexedFaceSet {
    coord Coordinate { point [ 0 0 0, 2 0 0, 0 2 0, 50 50 50 ] } coordIndex [ 0 1 2 ] } } })");
  const auto box = world.boxes.tight_box(ObjectId{0});
  ASSERT_TRUE(box.has_value());
  EXPECT_EQ(box->lo, Vec3(1, 0, 0));
  EXPECT_EQ(box->hi, Vec3(3, 2, 0));
  EXPECT_EQ(world.boxes.vertices_placed(), 3u);
  (void)world.boxes.tight_box(ObjectId{0});
  EXPECT_EQ(world.boxes.vertices_placed(), 3u);
}

// A translation of 3e38 m under eight scales of 1e38 overflows binary64.
TEST(ShapeBoxes, RefuseShapesWithoutAFinitePlace) {
  std::string body = "Transform { translation 3e38 0 0 children Shape { geometry Box {} } }";
  for (int i = 0; i < 8; ++i) body = "Transform { scale 1e38 1 1 children " + body + " }";
  World world(body);
  const auto box = world.boxes.tight_box(ObjectId{0});
  ASSERT_FALSE(box.has_value());
  EXPECT_THAT(box.error(), HasSubstr("no finite place"));
}

}  // namespace peerd::collision::shape_boxes_test
