#include "core/scene/scene.hpp"

#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd::scene_test {

constexpr const char* kCar = R"(
  Viewpoint { }
  DEF CAR Transform {
    translation 10 0 0
    children [
      DEF WHEEL Transform { translation 1 0 0 children DEF RIM Shape { } }
      WorldInfo { }
      Group { children USE WHEEL }
      USE WHEEL
    ]
  }
  USE WHEEL
)";

TEST(SceneIds, CountInstancesDepthFirstInFileOrder) {
  const Scene scene = scene_of(kCar);
  const std::vector<std::string> paths = {
      "CAR",       "CAR/WHEEL", "CAR/WHEEL/RIM", "CAR/2", "CAR/2/WHEEL", "CAR/2/WHEEL/RIM", "CAR/3",
      "CAR/3/RIM", "2",         "2/RIM"};
  ASSERT_EQ(scene.instances.size(), paths.size());
  for (std::uint32_t i = 0; i < paths.size(); ++i) EXPECT_EQ(scene.path_of(ObjectId{i}), paths[i]);
}

TEST(SceneIds, SubtreesAreRanges) {
  const Scene scene = scene_of(kCar);
  const std::vector<std::uint32_t> ends = {8, 3, 3, 6, 6, 6, 8, 8, 10, 10};
  for (std::uint32_t i = 0; i < ends.size(); ++i) EXPECT_EQ(scene.instances[i].subtree_end, ends[i]) << i;
}

TEST(SceneFind, IsTheInverseOfPathOf) {
  const Scene scene = scene_of(kCar);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    EXPECT_EQ(scene.find(scene.path_of(ObjectId{i})), ObjectId{i}) << scene.path_of(ObjectId{i});
  }
}

TEST(SceneFind, TakesNamesIndicesAndLoneNames) {
  const Scene scene = scene_of(kCar);
  EXPECT_EQ(scene.find("RIM"), ObjectId{2});
  EXPECT_EQ(scene.find("1/0/0"), ObjectId{2});
  EXPECT_EQ(scene.find("CAR/WHEEL/0"), ObjectId{2});
  for (const char* none : {"", "/", "CAR/", "/CAR", "CAR/1", "CAR/RIM", "0", "wheel", "CAR/WHEEL/RIM/0"}) {
    EXPECT_EQ(scene.find(none), std::nullopt) << none;
  }
}

TEST(SceneFind, CopesWithASlashInAName) {
  const Scene scene = scene_of("Group { children [ DEF A/B Group { } DEF C Group { } ] }");
  EXPECT_EQ(scene.path_of(ObjectId{1}), "0/0");
  EXPECT_EQ(scene.find("A/B"), ObjectId{1});
}

// VRML97 6.52 by hand. Scale (2, 1, 1) along axes turned by 90 degrees about z scales y; then a turn of 90 degrees
// about z, all about (1, 1, 0); then (10, 20, 30).
//   (3, 2, 5) - C = (2, 1, 5) -> scaled (2, 2, 5) -> turned (-2, 2, 5) -> + C = (-1, 3, 5) -> (9, 23, 35)
TEST(SceneTransform, FollowsTheStandardsOrder) {
  const Scene scene = scene_of(R"(Transform {
    translation 10 20 30  center 1 1 0  rotation 0 0 1 1.5707963  scaleOrientation 0 0 1 1.5707963  scale 2 1 1 })");
  const Eigen::Affine3d m = scene.world_from_local(ObjectId{0});
  // The angles are binary32: 1.5707963 is off by 4.4e-8.
  EXPECT_LT((m * Vec3(3, 2, 5) - Vec3(9, 23, 35)).norm(), 1e-6);
  Eigen::Matrix4d by_hand;
  by_hand << 0, -2, 0, 13,  //
      1, 0, 0, 20,          //
      0, 0, 1, 30,          //
      0, 0, 0, 1;
  EXPECT_LT((m.matrix() - by_hand).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(SceneTransform, PathsMultiplyFromTheTop) {
  const Scene scene = scene_of(R"(
    Transform { translation 1 0 0 scale 2 2 2 children Group { children
      Transform { translation 1 0 0 rotation 0 0 1 3.1415927 children Shape { } } } })");
  const Eigen::Affine3d m = scene.world_from_local(ObjectId{3});
  EXPECT_LT((m * Vec3(1, 0, 0) - Vec3(1, 0, 0)).norm(), 1e-6);
  EXPECT_EQ(m.matrix(), scene.world_from_local(ObjectId{2}).matrix());
}

TEST(SceneRigidPose, IsTheOriginAndTheRotations) {
  const Scene scene = scene_of(R"(
    Transform { translation 5 0 0 scale 3 1 1 rotation 0 1 0 0.5 children
      DEF A Transform { translation 1 0 0 center 0 0 2 rotation 1 0 0 0.25 scale 1 2 1 children Shape { } } })");
  const ObjectId a = scene.find("A").value();
  const Pose pose = scene.rigid_pose(a);
  EXPECT_EQ(pose.position, scene.world_from_local(a) * Vec3::Zero());
  const Quat expected = quat_exp({0, 0.5, 0}) * quat_exp({0.25, 0, 0});
  EXPECT_LT(angle_between(pose.orientation, expected), 1e-15);
}

TEST(SceneObjectFromShape, TakesShapeToWorldThroughThePose) {
  const Scene scene = scene_of(R"(
    Transform { translation 5 1 0 scale 3 1 1 rotation 0 1 0 0.5 children
      DEF A Transform { translation 1 0 0 rotation 1 0 0 0.25 children
        DEF S Transform { translation 0 7 0 scale 1 2 1 children Shape { } } } })");
  const ObjectId a = scene.find("A").value();
  const ObjectId shape = scene.find("0/A/S/0").value();
  const Pose pose = scene.rigid_pose(a);
  const Eigen::Affine3d object_from_shape = scene.object_from_shape(a, shape);
  const Eigen::Affine3d world_from_shape = scene.world_from_local(shape);
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 2, 3), Vec3(-4, 5, 6)}) {
    EXPECT_LT((pose * (object_from_shape * p) - world_from_shape * p).norm(), 1e-14);
  }
}

TEST(SceneObjectFromShape, IsExactWithoutScale) {
  const Scene scene = scene_of(R"(
    Transform { translation 5.1 1 0.3 rotation 1 2 3 0.5 children
      DEF A Transform { translation 0.1 0.2 0.3 center 9 8 7 rotation 1 0 0 0.25 children [
        Shape { } Transform { translation 0.1 0.7 -3 children Shape { } } ] } })");
  const ObjectId a = scene.find("A").value();
  EXPECT_EQ(scene.object_from_shape(a, scene.find("0/A/0").value()).matrix(), Eigen::Matrix4d::Identity());
  const Eigen::Affine3d moved = scene.object_from_shape(a, scene.find("0/A/1/0").value());
  EXPECT_EQ(moved.linear(), Mat3::Identity());
  EXPECT_EQ(moved.translation(), Vec3(0.1f, 0.7f, -3.0f));
}

}  // namespace peerd::scene_test
