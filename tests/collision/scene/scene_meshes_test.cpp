#include "collision/scene/scene_meshes.hpp"

#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd::collision::scene_meshes_test {

TEST(SceneMeshes, BuildsEachMeshOnce) {
  const Scene scene = scene_of("Shape { geometry Box { size 2 4 6 } } Shape { geometry Sphere {} }");
  SceneMeshes meshes(scene);
  EXPECT_EQ(meshes.meshes_built(), 0u);
  EXPECT_EQ(meshes.local_box(0).hi, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(meshes.mesh(0).polygon_count(), 6u);
  EXPECT_EQ(meshes.meshes_built(), 1u);
  (void)meshes.mesh(1);
  EXPECT_EQ(meshes.meshes_built(), 2u);
}

TEST(SceneMeshes, ReshapingReplacesMeshAndBox) {
  const Scene scene = scene_of("Shape { geometry Box {} } Shape { geometry Box { size 8 8 8 } }");
  SceneMeshes meshes(scene);
  (void)meshes.local_box(0);
  meshes.reshape(0, scene.geometries[1]);
  EXPECT_EQ(meshes.meshes_built(), 2u);
  EXPECT_EQ(meshes.local_box(0).hi, Eigen::Vector3f(4, 4, 4));
}

}  // namespace peerd::collision::scene_meshes_test
