#include "peerd/view/picks/node_place.hpp"

#include <gtest/gtest.h>

#include <random>

namespace peerd::view::node_place_test {

TEST(NodePlace, IsTheMap) {
  std::mt19937_64 random(7);
  const auto number = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0; };
  int sheared = 0;
  for (int i = 0; i < 2000; ++i) {
    Eigen::Affine3d map = Eigen::Affine3d::Identity();
    for (int k = 0; k < 9; ++k) map.linear()(k / 3, k % 3) = number();
    if (i % 4 == 0) map.linear().col(2).setZero();
    if (i % 3 == 0) {
      const Quat turned = Quat(number(), number(), number(), number()).normalized();
      map.linear() = turned.toRotationMatrix() * Vec3(number(), number(), number()).asDiagonal();
    }
    map.translation() = Vec3(number(), number(), number());
    const NodePlace place = place_of(map);
    EXPECT_TRUE(place.map().isApprox(map, 1e-9)) << i;
    EXPECT_NEAR(place.rotation.norm(), 1.0, 1e-12);
    sheared += place.inner ? 1 : 0;
    const bool is_plain = i % 3 == 0 && i % 4 != 0;
    EXPECT_FALSE(is_plain && place.inner) << "a rotation and a scale need no second node";
  }
  EXPECT_GT(sheared, 1000);
}

TEST(NodePlace, OfNothingIsNothing) {
  const NodePlace place = place_of(Eigen::Affine3d::Identity());
  EXPECT_EQ(place.translation, Vec3(0, 0, 0));
  EXPECT_EQ(place.rotation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(place.scale, Vec3(1, 1, 1));
  EXPECT_FALSE(place.inner);
}

}  // namespace peerd::view::node_place_test
