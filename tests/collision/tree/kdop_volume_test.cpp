#include "collision/tree/kdop_volume.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace peerd::collision::kdop_volume_test {

// A cube's k-DOP is the cube; an octahedron's 14-DOP, and 26-DOP, is the octahedron.
TEST(KdopVolume, OfSolidsThatAKdopFits) {
  WideKdop<18> cube;
  for (std::size_t i = 0; i < cube.kSlabs; ++i) {
    const auto& d = cube.kDirections[i];
    const double reach = std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]);
    cube.hi[i] = 7.0 * along(d, {1, 1, 1}) + reach;
    cube.lo[i] = 7.0 * along(d, {1, 1, 1}) - reach;
  }
  EXPECT_NEAR(volume(cube), 8.0, 1e-12);
  WideKdop<26> octahedron;
  octahedron.lo.fill(-1.0);
  octahedron.hi.fill(1.0);
  EXPECT_NEAR(volume(octahedron), 4.0 / 3.0, 1e-12);
  octahedron.lo[4] = 2.0;
  EXPECT_EQ(volume(octahedron), 0.0);
}

// Each face of a box is a rectangle, and its corners are the box's.
TEST(KdopVolume, BoundaryOfABoxIsItsSixSides) {
  WideKdop<6> box;
  box.lo = {-1.0, 2.0, 5.0};
  box.hi = {3.0, 4.0, 6.0};
  const auto faces = boundary(box);
  ASSERT_EQ(faces.size(), 6u);
  for (const auto& face : faces) {
    ASSERT_EQ(face.size(), 4u);
    for (const Vec3& p : face) {
      for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        EXPECT_LT(std::min(std::abs(p[k] - box.lo[i]), std::abs(p[k] - box.hi[i])), 1e-12);
      }
    }
  }
  EXPECT_EQ(volume(box), 8.0);
}

TEST(KdopVolume, OfNothingIsNothing) {
  EXPECT_TRUE(boundary(WideKdop<18>::empty()).empty());
  WideKdop<14> flat;
  flat.lo.fill(-1.0);
  flat.hi.fill(1.0);
  flat.lo[2] = flat.hi[2] = 0.0;
  EXPECT_NEAR(volume(flat), 0.0, 1e-15);
}

}  // namespace peerd::collision::kdop_volume_test
