#include "collision/scene/shape_placement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/core/read_text.hpp"

namespace peerd::collision::shape_placement_test {

using ::testing::ElementsAre;
using Subtrees = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

TransformFields at(double x) {
  TransformFields t;
  t.translation = {x, 0, 0};
  return t;
}

// Instances: 0 A, 1 B, 2 its Shape, 3 the other Shape; 4 C, 5 its Shape.
Scene scene() {
  return scene_of(R"(
    DEF A Transform { translation 1 0 0 children [
      DEF B Transform { translation 10 0 0 children Shape { geometry Box {} } } Shape { geometry Box {} } ] }
    DEF C Transform { children Shape { geometry Box {} } })");
}

Subtrees apply(ShapePlacement& placement) {
  Subtrees subtrees;
  placement.apply_moves([&](std::uint32_t begin, std::uint32_t end) { subtrees.emplace_back(begin, end); });
  return subtrees;
}

TEST(ShapePlacement, PosesFollowTheWholePath) {
  const Scene world = scene();
  ShapePlacement placement(world, {});
  EXPECT_EQ(placement.placed(2).pose.pose.position, Vec3(11, 0, 0));
  EXPECT_TRUE(placement.move(world.instances[0].transform, at(3)));
  EXPECT_FALSE(placement.move(world.instances[0].transform, at(3)));
  EXPECT_THAT(apply(placement), ElementsAre(std::pair(0u, 4u)));
  EXPECT_EQ(placement.placed(2).pose.pose.position, Vec3(13, 0, 0));
  EXPECT_TRUE(apply(placement).empty());
}

TEST(ShapePlacement, SubtreesWithinOthersArePassedOver) {
  const Scene world = scene();
  ShapePlacement placement(world, {});
  placement.move(world.instances[4].transform, at(5));
  placement.move(world.instances[1].transform, at(5));
  placement.move(world.instances[0].transform, at(5));
  EXPECT_THAT(apply(placement), ElementsAre(std::pair(0u, 4u), std::pair(4u, 6u)));
}

TEST(ShapePlacement, DisplacementIsThatOfTheLastBatch) {
  const Scene world = scene();
  ShapePlacement placement(world, {});
  EXPECT_EQ(placement.displacement_m(2), 0.0);
  (void)placement.placed(5);
  placement.move(world.instances[1].transform, at(12));
  (void)apply(placement);
  EXPECT_GE(placement.displacement_m(2), 2.0);
  EXPECT_LT(placement.displacement_m(2), 2.0 + 1e-9);
  EXPECT_EQ(placement.displacement_m(5), 0.0);
  placement.move(world.instances[4].transform, at(1));
  (void)apply(placement);
  EXPECT_EQ(placement.displacement_m(2), 0.0);
}

TEST(ShapePlacement, ScalingReleasesTheGeometryThatWasHeld) {
  const Scene world = scene();
  ShapePlacement placement(world, {});
  ASSERT_TRUE(placement.scaled_geometry(5).has_value());
  TransformFields wide;
  wide.scale = {2, 1, 1};
  placement.move(world.instances[4].transform, wide);
  (void)apply(placement);
  EXPECT_EQ(placement.placed(5).scaled_geometry, nullptr);
  EXPECT_EQ(placement.geometries().size(), 0u);
  const auto scaled = placement.scaled_geometry(5);
  ASSERT_TRUE(scaled.has_value());
  EXPECT_EQ((*scaled)->soup.box.hi, Vec3(2, 1, 1));
}

}  // namespace peerd::collision::shape_placement_test
