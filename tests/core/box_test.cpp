#include "core/box.hpp"

#include <gtest/gtest.h>

#include <random>

namespace peerd::box_test {

TEST(AxisBox, EmptyIsInsideEveryBoxAndMergesAsNothing) {
  const WorldBox empty;
  WorldBox box{Vec3(0, 0, 0), Vec3(1, 2, 3)};
  EXPECT_TRUE(empty.is_empty());
  EXPECT_TRUE(box.contains(empty));
  EXPECT_TRUE(empty.contains(empty));
  EXPECT_FALSE(empty.contains(box));
  const WorldBox before = box;
  box.merge(empty);
  EXPECT_EQ(box, before);
}

TEST(AxisBox, ContainsItsBoundary) {
  const WorldBox box{Vec3(0, 0, 0), Vec3(1, 1, 1)};
  EXPECT_TRUE(box.contains(Vec3(1, 0, 1)));
  EXPECT_FALSE(box.contains(Vec3(1, 0, std::nextafter(1.0, 2.0))));
  EXPECT_FALSE(box.contains(Vec3(-0x1p-1070, 0, 0)));
}

TEST(TransformedBox, OfAnEmptyBoxIsEmpty) { EXPECT_TRUE(transformed(Affine{}, LocalBox{}).is_empty()); }

TEST(TransformedBox, OverflowingAxisIsUnbounded) {
  Affine m;
  m.linear(1, 1) = 1e300;
  const WorldBox box = transformed(m, {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 1e30f, 1)});
  EXPECT_EQ(box.hi[1], std::numeric_limits<double>::infinity());
  EXPECT_EQ(box.lo[1], -std::numeric_limits<double>::infinity());
  EXPECT_LT(box.hi[0], 1.001);
}

// The corners of a box, and points inside, lie within the transformed box; it is wider than the tight box by no more
// than the documented bound.
TEST(TransformedBox, HoldsAllPointsAndIsTight) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-100.0, 100.0);
  for (int round = 0; round < 2000; ++round) {
    Affine m;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) m.linear(i, j) = number(random);
      m.offset[i] = number(random);
    }
    LocalBox box;
    for (int i = 0; i < 2; ++i) {
      box.merge(Eigen::Vector3d(number(random), number(random), number(random)).cast<float>().eval());
    }
    const WorldBox world = transformed(m, box);
    WorldBox tight;
    double size = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 p;
      for (int i = 0; i < 3; ++i) p[i] = static_cast<double>(corner >> i & 1 ? box.hi[i] : box.lo[i]);
      const Vec3 q = multiply(m.linear, p) + m.offset;
      EXPECT_TRUE(world.contains(q));
      tight.merge(q);
      size = std::max(size, (m.linear.cwiseAbs() * p.cwiseAbs() + m.offset.cwiseAbs()).maxCoeff());
    }
    EXPECT_LE((tight.lo - world.lo).maxCoeff(), 0x1p-48 * size);
    EXPECT_LE((world.hi - tight.hi).maxCoeff(), 0x1p-48 * size);
  }
}

}  // namespace peerd::box_test
