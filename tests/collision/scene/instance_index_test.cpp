#include "collision/scene/instance_index.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd::collision::instance_index_test {

using ::testing::ElementsAre;

TEST(InstanceIndex, ListsTheInstancesOfEachTransformAndGeometryInOrder) {
  const Scene scene = scene_of(R"(
    DEF A Transform { children DEF BALL Shape { geometry Sphere {} } }
    USE A
    Transform { children [ Shape { geometry Box {} } USE BALL ] })");
  const InstanceIndex by_transform(scene, &Instance::transform, scene.transforms.size());
  const InstanceIndex by_geometry(scene, &Instance::geometry, scene.geometries.size());
  for (std::uint32_t t = 0; t < scene.transforms.size(); ++t) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
      if (scene.instances[i].transform == t) expected.push_back(i);
    }
    EXPECT_THAT(by_transform.of(t), ::testing::ElementsAreArray(expected));
  }
  std::size_t listed = 0;
  for (std::uint32_t g = 0; g < scene.geometries.size(); ++g) {
    EXPECT_TRUE(std::ranges::is_sorted(by_geometry.of(g)));
    for (const std::uint32_t i : by_geometry.of(g)) EXPECT_EQ(scene.instances[i].geometry, g);
    listed += by_geometry.of(g).size();
  }
  EXPECT_EQ(listed, 4u);  // three balls and a box
}

TEST(InstanceIndex, WhatNothingHasIsEmpty) {
  const Scene scene = scene_of("Transform { children Shape { geometry Box {} } }");
  const InstanceIndex index(scene, &Instance::transform, scene.transforms.size() + 1);
  EXPECT_TRUE(index.of(static_cast<std::uint32_t>(scene.transforms.size())).empty());
  EXPECT_THAT(index.of(0), ElementsAre(0u));
}

}  // namespace peerd::collision::instance_index_test
