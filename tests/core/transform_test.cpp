#include "core/transform.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace peerd::transform_test {

class Random {
 public:
  double number(double most) { return std::uniform_real_distribution<double>(-most, most)(random_); }
  Vec3 vector(double most) { return {number(most), number(most), number(most)}; }
  Quat rotation() { return Quat(number(1), number(1), number(1), number(1)).normalized(); }
  TransformFields fields(bool scaled) {
    TransformFields t{vector(10), rotation(), Vec3::Ones(), rotation(), vector(3)};
    if (scaled) t.scale = vector(1) + Vec3::Constant(2);
    return t;
  }

 private:
  std::mt19937 random_{11};
};

// Computes the product of VRML97 6.52 by Eigen.
Eigen::Affine3d expected(const TransformFields& t) {
  using Eigen::Translation3d;
  return Translation3d(t.translation) * Translation3d(t.center) * t.rotation * t.scale_orientation *
         Eigen::Scaling(t.scale) * t.scale_orientation.inverse() * Translation3d(-t.center);
}

TEST(ParentFromLocal, IsTheProductOfClause652) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const TransformFields t = random.fields(i % 2 == 0);
    const Affine m = parent_from_local(t);
    const Vec3 p = random.vector(5);
    EXPECT_LT((multiply(m.linear, p) + m.offset - expected(t) * p).norm(), 1e-12);
  }
}

TEST(ParentFromLocal, OfTheDefaultsIsTheIdentity) {
  const Affine m = parent_from_local({});
  EXPECT_EQ(m.linear, Mat3::Identity());
  EXPECT_EQ(m.offset, Vec3::Zero());
}

TEST(ParentFromLocal, TakesNoNoteOfTheScaleOrientationWithoutScale) {
  TransformFields t;
  t.rotation = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  const Affine plain = parent_from_local(t);
  t.scale_orientation = Quat(Eigen::AngleAxisd(1.1, Vec3::UnitY()));
  EXPECT_EQ(parent_from_local(t).linear, plain.linear);
}

TEST(Affine, ProductsApplyTheRightFactorFirst) {
  Random random;
  const Affine a = parent_from_local(random.fields(true)), b = parent_from_local(random.fields(true));
  const Vec3 p = random.vector(5);
  const Affine ab = multiply(a, b);
  const Vec3 once = multiply(ab.linear, p) + ab.offset;
  const Vec3 twice = multiply(a.linear, Vec3(multiply(b.linear, p) + b.offset)) + a.offset;
  EXPECT_LT((once - twice).norm(), 1e-12);
}

// The linear part of the whole path is rotation * stretch, and the pose is where the path takes the origin.
TEST(StretchedPose, SplitsThePathIntoAPoseAndAStretch) {
  Random random;
  for (int round = 0; round < 100; ++round) {
    std::vector<TransformFields> path;
    Eigen::Affine3d product = Eigen::Affine3d::Identity();
    for (int i = 0; i < 4; ++i) {
      path.push_back(random.fields((round >> i & 1) != 0));
      product = product * expected(path.back());
    }
    const StretchedPose s = stretched_pose(path);
    EXPECT_LT((s.pose.orientation.toRotationMatrix() * s.stretch - product.linear()).norm(), 1e-10);
    EXPECT_LT((s.pose.position - product.translation()).norm(), 1e-10);
    const Pose rigid = rigid_pose(path);
    EXPECT_EQ(rigid.position, s.pose.position);
    EXPECT_EQ(rigid.orientation.coeffs(), s.pose.orientation.coeffs());
  }
}

TEST(StretchedPose, IsNotRoundedWhereOnlyTheLastTransformScales) {
  Random random;
  TransformFields stretch;
  stretch.scale = {2, 0.5, 3};
  EXPECT_EQ(stretched_pose(std::array{random.fields(false), stretch}).stretch, Mat3(stretch.scale.asDiagonal()));
}

TEST(StretchedPose, IsExactlyTheIdentityWithoutScale) {
  Random random;
  const std::vector<TransformFields> path = {random.fields(false), random.fields(false), random.fields(false)};
  EXPECT_EQ(stretched_pose(path).stretch, Mat3::Identity());
}

}  // namespace peerd::transform_test
