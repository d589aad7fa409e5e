#include "core/scene/pose_store.hpp"

#include <gtest/gtest.h>

namespace peerd::pose_store_test {

bool same(const TransformFields& a, const TransformFields& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs() && a.scale == b.scale &&
         a.scale_orientation.coeffs() == b.scale_orientation.coeffs() && a.center == b.center;
}

TransformFields stretched() {
  TransformFields t;
  t.translation = {1, 2, 3};
  t.rotation = Quat(Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  t.scale = {2, 3, 4};
  t.center = {5, 6, 7};
  t.scale_orientation = Quat(Eigen::AngleAxisd(0.25, Vec3::UnitZ()));
  return t;
}

TEST(PoseStore, GivesBackTheFieldsToTheBit) {
  PoseStore poses;
  const std::uint32_t plain = poses.add(0, {}), full = poses.add(0, stretched());
  EXPECT_TRUE(same(poses.read(plain), {}));
  EXPECT_TRUE(same(poses.read(full), stretched()));
  TransformFields negative_zero;
  negative_zero.center = {-0.0, 0, 0};
  poses.write(plain, negative_zero);
  EXPECT_TRUE(std::signbit(poses.read(plain).center.x()));
}

TEST(PoseStore, KeepsAStretchOnlyWhereThereIsOne) {
  PoseStore poses;
  const std::uint32_t pose = poses.add(0, {});
  EXPECT_EQ(poses[pose].stretch, kNoSlot);
  poses.write(pose, stretched());
  EXPECT_NE(poses[pose].stretch, kNoSlot);
  poses.write(pose, {});
  EXPECT_EQ(poses[pose].stretch, kNoSlot);
  const std::size_t bytes = poses.memory_bytes();
  poses.write(pose, stretched());  // takes the same place again
  EXPECT_EQ(poses.memory_bytes(), bytes);
}

TEST(PoseStore, MultipliesWithTheWorldPoseOfTheParent) {
  PoseStore poses;
  const std::uint32_t parent = poses.add(0, stretched());
  const std::uint32_t child = poses.add(parent, stretched());
  poses.update_world(parent);
  poses.update_world(child);
  const Affine once = parent_from_local(stretched());
  const Affine twice = multiply(multiply(Affine{}, once), once);
  EXPECT_EQ(poses.world(child).linear, twice.linear);
  EXPECT_EQ(poses.world(child).offset, twice.offset);
}

TEST(PoseStore, UsesThePlacesOfRemovedPosesAgain) {
  PoseStore poses;
  const std::uint32_t pose = poses.add(0, stretched());
  poses.remove(pose);
  EXPECT_EQ(poses.add(0, {}), pose);
  EXPECT_TRUE(same(poses.read(pose), {}));
}

}  // namespace peerd::pose_store_test
